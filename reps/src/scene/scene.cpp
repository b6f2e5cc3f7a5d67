#include <algorithm>

#include <knurl/reps/scene.hpp>

#include "scene/scene_core.hpp"

namespace knurl {

struct Scene::Impl : detail::SceneCore {
    using detail::SceneCore::SceneCore;
};

namespace {

Scene::Capacity possible(Scene::Capacity capacity) {
    return {.representations = std::max(1u, capacity.representations),
            .probes = std::clamp(capacity.probes, 1u, Scene::max_probes)};
}

}  // namespace

Scene::Scene(Capacity capacity, const Limits& limits)
    : impl_(std::make_unique<Impl>(possible(capacity), limits)) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

Verdict Scene::check_add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                         const AddOptions& options) const noexcept {
    return impl_->model().check_add(id, kind, params, bytes, options);
}
Verdict Scene::add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                   const AddOptions& options) noexcept {
    return impl_->model().add(id, kind, params, bytes, options);
}
Verdict Scene::check_update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) noexcept {
    return impl_->model().check_update(id, kind, params, bytes);
}
Verdict Scene::update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) noexcept {
    const Verdict verdict = check_update(id, kind, params, bytes);
    if (verdict) update_checked(id, params, bytes);
    return verdict;
}
void Scene::update_checked(RepresentationId id, const void* params, std::size_t bytes) noexcept {
    impl_->model().update_checked(id.slot, params, bytes);
}
Verdict Scene::remove(RepresentationId id) noexcept {
    return impl_->model().remove(id);
}
Verdict Scene::place_probe(std::uint32_t probe, const ProbePlacement& placement) noexcept {
    return impl_->model().place_probe(probe, placement);
}

void Scene::clear() noexcept {
    impl_->clear();
}
void Scene::settle() noexcept {
    impl_->settle();
}
void Scene::set_limits(const Limits& limits) noexcept {
    impl_->set_limits(limits);
}
void Scene::set_fade(const FadePolicy& policy) noexcept {
    impl_->set_fade(policy);
}
void Scene::set_asset(std::uint32_t number, const Asset* asset) noexcept {
    impl_->set_asset(number, asset);
}
bool Scene::refers_to(const Asset& asset) const noexcept {
    return impl_->refers_to(asset);
}
void Scene::index() {
    impl_->index();
}
void Scene::set_scales(const HandScales& scales) noexcept {
    impl_->set_scales(scales);
}
void Scene::set_silence(double seconds) noexcept {
    impl_->set_silence(seconds);
}

Wrench Scene::evaluate(const Probe& hand, double dt) noexcept {
    return impl_->evaluate(hand, dt);
}

double Scene::sleep_radius() const noexcept {
    return impl_->sleep_radius();
}
bool Scene::changed() const noexcept {
    return impl_->changed();
}
SceneTime Scene::time() const noexcept {
    return impl_->time();
}
void Scene::pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept {
    impl_->pass(cycles, time, hand);
}

Eigen::Vector3d Scene::contact_point() const noexcept {
    return impl_->feedback().contact_point(0);
}
Scene::Shown Scene::shown(std::uint32_t slot) const noexcept {
    const detail::SceneModel& model = std::as_const(*impl_).model();
    if (slot >= model.slots() || !model[slot].present) return {};
    const detail::SceneModel::ModelSlot& held = model[slot];
    return {.id = {.slot = slot, .generation = held.generation},
            .kind = held.kind,
            .options = held.options,
            .params = {model.params(slot), kinds()[held.kind].size}};
}
ProbePlacement Scene::placement(std::uint32_t probe) const noexcept {
    return std::as_const(*impl_).model().placement(probe);
}
std::uint32_t Scene::size() const noexcept {
    return impl_->model().size();
}
std::uint32_t Scene::count(Kind kind) const noexcept {
    return kind < Representations::size ? impl_->model().count(kind) : 0;
}
const SceneWork& Scene::work() const noexcept {
    return impl_->work();
}
SceneLoad Scene::load() const noexcept {
    return impl_->load().load();
}
LoadBound Scene::load_bound() const noexcept {
    return impl_->load().bound();
}
std::size_t Scene::feedback(std::span<Feedback> out) const noexcept {
    return std::as_const(*impl_).feedback().write(out);
}
std::size_t Scene::feedback(std::span<Feedback> kept, const Rewritten& rewritten) noexcept {
    return impl_->feedback().write_changes(kept, rewritten);
}

}  // namespace knurl
