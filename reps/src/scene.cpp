#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <knurl/reps/check.hpp>
#include <knurl/reps/scene.hpp>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl {
namespace detail {

// A limit that is no number or negative allows nothing: the safe reading.
Limits sane_limits(Limits limits) noexcept {
    for (double* limit : {&limits.max_stiffness, &limits.max_force, &limits.max_torque}) {
        if (!(*limit > 0)) *limit = 0;
    }
    for (double* unit : {&limits.metre, &limits.newton}) {
        if (!(*unit > 0) || !std::isfinite(*unit)) *unit = 1;
    }
    return limits;
}

Shares shares_of(const Limits& limits) noexcept {
    if (!std::isfinite(limits.max_stiffness) || !(limits.max_stiffness > 0)) return {};
    const bool turns = std::isfinite(limits.max_torsion) && limits.max_torsion > 0;
    return {.stiffness = 1 / limits.max_stiffness,
            .damping = 1 / largest_damping(limits),
            .turning = turns ? limits.max_stiffness / limits.max_torsion : 0};
}

void SceneCore::place_probes(const Probe& hand) noexcept {
    for (std::uint32_t rest = probes_used_; rest != 0; rest &= rest - 1) {
        Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        if (last_timed_ + 1 == cycle_) group.before = group.probe.position;
        group.probe = hand;
        group.probe.radius = group.placement.radius;
        if (group.placement.offset == Vec3{}) {
            group.arm.setZero();
            continue;
        }
        group.arm = hand.orientation * to_eigen(group.placement.offset);
        const Eigen::Vector3d turning = hand.angular_velocity.cross(group.arm);
        group.probe.position += group.arm;
        group.probe.velocity += turning;
        group.probe.smooth_velocity += turning;
    }
}

namespace {

// Whatever set_silence is told, what it changes moves by these rates only, so nothing jumps.
constexpr double fade_out = 0.1, fade_in = 0.05;  // s

double weight_after(double from, bool out, double dt) noexcept {
    const double to = out ? std::max(0.0, from - dt / fade_out) : std::min(1.0, from + dt / fade_in);
    return to < 1e-12 ? 0 : to > 1 - 1e-12 ? 1 : to;
}

}  // namespace

// What holds stays where it is at once. With what velocity it rubs, damps and carries its texture is a force,
// which must not step.
void SceneCore::advance_pace(double dt) noexcept {
    pace_ = weight_after(pace_, silence_ > 0, dt);
}

void SceneCore::advance_weights(double dt) noexcept {
    bool changed = false, arrived = true;
    const auto advance = [&](Record& r) {
        if (r.use.on_silence == OnSilence::hold) return;
        const double delay = r.use.on_silence == OnSilence::move ? r.use.silence_time : 0;
        const bool fades = silence_ > delay, will_fade = silence_ > 0 && !fades;
        const double before = r.weight;
        r.weight = weight_after(r.weight, fades, dt);
        changed = changed || r.weight != before;
        arrived = arrived && !will_fade && r.weight == (fades ? 0 : 1);
    };
    bool surfaces = false;
    for (const auto& [list, size] :
         {std::pair{&surfaces_, surfaces_size_}, std::pair{&effects_, effects_size_}}) {
        for (std::uint32_t e = 0; e < size; ++e) advance(felt((*list)[e]));
        if (list == &surfaces_) surfaces = changed;
    }
    // Old records are few: those of surfaces in a fading set, those of fading effects.
    for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1) {
        const Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        for (std::uint32_t i = group.old.begin; i < group.old.begin + group.old.count; ++i) {
            const Owner owner = arenas_[arena_].owner[i];
            if (owner == bridge_owner || !fades_out(owner)) continue;
            advance(record(owner));
            surfaces = surfaces || changed;
        }
    }
    for (std::uint32_t f = 0; f < fading_size_; ++f) {
        if (slots_[fading_[f]].from == Slot::From::record) advance(faded(fading_[f]));
    }
    if (surfaces) rebuild_sets();
    told_.edited = true;
    effects_edited_ = true;    // springs whose weight moves do not collapse
    weights_move_ = !arrived;  // who holds, or has faded, costs nothing more however long it is silent
}

}  // namespace detail

Scene::Scene(Capacity capacity, const Limits& limits) : impl_(std::make_unique<Impl>(capacity, limits)) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

void Scene::set_limits(const Limits& limits) noexcept {
    const Limits sane = detail::sane_limits(limits);
    if (std::memcmp(&sane, &impl_->limits_, sizeof sane) == 0) return;
    impl_->limits_ = sane;
    impl_->shares_ = detail::shares_of(sane);
    for (std::uint32_t i = 0; i < impl_->slots_.size(); ++i) {
        if (!impl_->slots_[i].present) continue;
        impl_->slots_[i].shape_alone = false;
        impl_->mark(i);  // a changed clamp is a change of the set like any other
    }
}

void Scene::set_asset(std::uint32_t number, const Asset* asset) noexcept {
    if (number > 0 && number <= max_assets) impl_->assets_[number - 1] = asset;
}

bool Scene::refers_to(const Asset& asset) const noexcept {
    const auto made_of = [&](const detail::Record& r) {
        return detail::kind_ops()[r.kind].asset(r) == &asset;
    };
    for (std::uint32_t i = 0; i < impl_->slots_.size(); ++i) {
        const detail::Slot& slot = impl_->slots_[i];
        if (slot.felt && made_of(impl_->felt(i))) return true;
        if (slot.old_surface_of < 0) continue;
        const detail::Group& group = impl_->groups_[static_cast<std::uint32_t>(slot.old_surface_of)];
        const bool fades = group.fading && !group.bridged && group.fade == slot.old_in_fade;
        if ((fades || slot.old_in_fade == 0) && made_of(impl_->faded(i))) return true;
    }
    return false;
}

void Scene::index() {
    impl_->reach_.index();
    impl_->effect_reach_.index();
}

void Scene::set_fade(const FadePolicy& policy) noexcept {
    impl_->policy_ = policy;
}

Verdict Scene::place_probe(std::uint32_t probe, const ProbePlacement& placement) noexcept {
    const Verdict verdict = check_placement(probe, placement, impl_->capacity_.probes);
    if (!verdict) return verdict;
    detail::Group& group = impl_->groups_[probe];
    const ProbePlacement& present = group.moved ? group.next_placement : group.placement;
    if (present.offset == placement.offset && present.radius == placement.radius) return {};
    group.next_placement = placement;
    group.moved = impl_->moved_ = true;
    return {};
}

void Scene::set_silence(double seconds) noexcept {
    const double before = std::exchange(impl_->silence_, seconds > 0 ? seconds : 0);
    // It only ever grows until it ends.
    if (!impl_->weights_move_ && (before > 0 ? impl_->silence_ < before : impl_->silence_ > 0))
        impl_->weights_move_ = impl_->effects_edited_ = true;
}

Wrench Scene::evaluate(const Probe& hand, double dt) noexcept {
    detail::SceneCore& core = *impl_;
    // A probe that is nowhere feels nothing, and leaves no trace in any state.
    constexpr double farthest = 1e12;  // m
    if (!(hand.position.lpNorm<1>() < farthest) || !(hand.velocity.lpNorm<1>() < farthest) ||
        !(hand.angular_velocity.lpNorm<1>() < farthest) || !hand.orientation.coeffs().allFinite()) {
        return {};
    }
    if (!(dt > 0)) dt = 0;
    ++core.cycle_;
    core.step_ = dt;
    core.before_ = core.now_;
    core.now_.all += dt;
    if (!(core.silence_ > 0)) core.now_.held += dt;
    core.advance_pace(dt);
    core.evaluated_ = core.curved_rounds_ = 0;
    if (core.moved_) core.take_placements();
    core.place_probes(hand);
    const bool left = core.bounded_used_ != 0 && core.near_left();
    const bool effects_left = core.bounded_effects_used_ != 0 && core.near_effects_left();
    if (left || effects_left || core.changed_size_ > 0 || core.sets_edited_ || core.effects_edited_) {
        // What comes during a silence begins in full.
        core.weights_move_ =
            core.weights_move_ || (core.silence_ > 0 && (core.changed_size_ > 0 || core.sets_edited_));
        core.take_changes();
    }
    core.settle_ = false;
    if (core.weights_move_ && dt > 0) core.advance_weights(dt);
    Wrench sum;
    if (core.contacts_used_ != 0) core.evaluate_contacts(dt, sum);
    if (core.active_kinds_size_ > 0 || core.collapsed_used_ != 0 || core.fading_size_ > 0)
        core.evaluate_effects(dt, sum);
    if (dt > 0) core.last_timed_ = core.cycle_;
    // The field tables keep every product finite; this is the last word all the same.
    if (!sum.force.allFinite() || !sum.torque.allFinite()) return {};
    return sum;
}

}  // namespace knurl
