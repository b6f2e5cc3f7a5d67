// Slots: what may be added, updated and removed. Nothing here is felt before the next evaluate.

#include <cmath>
#include <cstring>
#include <utility>

#include <knurl/reps/check.hpp>

#include "ranges.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

using Code = Verdict::Code;

SceneCore::SceneCore(Scene::Capacity capacity, const Limits& limits)
    : capacity_(capacity),
      limits_(sane_limits(limits)),
      shares_(shares_of(limits_)),
      reach_(std::max(1u, capacity.representations)),
      effect_reach_(std::max(1u, capacity.representations), Reach::Moves::never) {
    capacity_.representations = std::max(1u, capacity.representations);
    capacity_.probes = std::clamp(capacity.probes, 1u, Scene::max_probes);
    const std::size_t n = capacity_.representations;
    slots_.resize(n);
    raw_.resize(n * max_parameter_bytes);
    records_.resize(2 * n);
    rough_.resize(2 * n);
    changed_.resize(n);
    groups_.resize(capacity_.probes);
    surfaces_.resize(n);
    always_.resize(n);
    endless_.resize(n);
    near_.resize(n);
    told_.probe.resize(n);
    told_.touched.resize(n);
    fading_olds_.resize(n);
    for (Group& group : groups_) group.near.slots.resize(n);
    effects_.resize(n);
    fading_.resize(n);
    by_kind_.resize(n);
    // A slot is at most in three sets: the old record in one probe's fading set, the new one in both of
    // another's. Each set is aligned to four.
    const std::size_t members = 3 * n * max_contacts + Scene::max_probes + 2 * 4 * Scene::max_probes;
    planes_.resize(6 * members);
    balls_.resize(3 * n);
    for (Arena& arena : arenas_) {
        std::span<double> rest(planes_);
        for (std::span<double>* array : {&arena.nx, &arena.ny, &arena.nz, &arena.c, &arena.s, &arena.b}) {
            *array = rest.first(members);
            rest = rest.subspan(members);
        }
        arena.owner.resize(members);
        arena.moving.resize(3 * n);
        arena.balls = &balls_;
    }
    scratch_.resize(2 * n + 1);
    reshaped_.resize(n);
    level_.resize(2 * n + 1);
}

Verdict SceneCore::check_add(Handle handle, Kind kind, const void* params, std::size_t bytes,
                             const Use& use) const noexcept {
    const Verdict verdict = check_vacant(handle, slots_);
    return verdict ? check_added(kind, params, bytes, use, capacity_.probes) : verdict;
}

Verdict SceneCore::check_update(Handle handle, Kind kind, const void* params, std::size_t bytes) noexcept {
    if (kind >= Representations::size)
        return {Code::unknown_kind, Verdict::no_field, static_cast<double>(kind)};
    if (!names_one(handle, slots_) || slots_[handle.slot].kind != kind) {
        return {Code::no_such_slot, Verdict::no_field, static_cast<double>(handle.slot)};
    }
    const KindOps& ops = kind_ops()[kind];
    const std::size_t shape = ops.shape_bytes;
    const bool shape_alone = bytes == shape && shape != 0;
    if (bytes != ops.params_size && !shape_alone)
        return {Code::wrong_size, Verdict::no_field, static_cast<double>(bytes)};
    // What stands in the slot is legal: where only the shape differs from it, only that is looked at.
    const std::byte* raw = &raw_[handle.slot * max_parameter_bytes];
    const auto* sent = static_cast<const std::byte*>(params);
    const bool rest_stays = shape_alone || std::memcmp(raw + shape, sent + shape, bytes - shape) == 0;
    slots_[handle.slot].differ = rest_stays ? ops.compare_shape(raw, sent) : Differ::anywhere;
    return slots_[handle.slot].differ != Differ::anywhere ? Verdict{} : validate(kind, raw, sent, bytes);
}

// So many bytes of them, over those that are there.
Verdict SceneCore::validate(Kind kind, const std::byte* raw, const std::byte* sent,
                            std::size_t bytes) noexcept {
    if (bytes == kind_ops()[kind].params_size) return kinds()[kind].validate(sent);
    std::memcpy(prepared_.data(), raw, kind_ops()[kind].params_size);
    std::memcpy(prepared_.data(), sent, bytes);
    return kinds()[kind].validate(prepared_.data());
}

void SceneCore::mark(std::uint32_t slot) noexcept {
    if (slots_[slot].changed) return;
    slots_[slot].changed = true;
    changed_[changed_size_++] = slot;
}

// By what the last check has found. A batch may name a slot twice: then that was of the last of them, which
// is what remains, whatever is copied of the others.
void SceneCore::write_checked(std::uint32_t i, const void* params, std::size_t bytes) noexcept {
    Slot& slot = slots_[i];
    if (slot.differ == Differ::nowhere) return;  // as it was asked for last
    const bool shape = slot.differ == Differ::in_shape;
    slot.shape_alone = slot.shape_alone && shape;
    std::memcpy(&raw_[i * max_parameter_bytes], params, shape ? kind_ops()[slot.kind].shape_bytes : bytes);
    mark(i);
}

void SceneCore::join(std::vector<std::uint32_t>& list, std::uint32_t& size, std::uint32_t slot,
                     Place place) noexcept {
    slots_[slot].*place = size;
    list[size++] = slot;
}

void SceneCore::leave(std::vector<std::uint32_t>& list, std::uint32_t& size, std::uint32_t slot,
                      Place place) noexcept {
    const std::uint32_t last = list[--size];
    list[slots_[slot].*place] = last;
    slots_[last].*place = slots_[slot].*place;
}

void SceneCore::clear() noexcept {
    for (std::uint32_t i = 0; i < slots_.size(); ++i) slots_[i] = Slot{};
    changed_size_ = surfaces_size_ = always_size_ = endless_size_ = effects_size_ = fading_size_ =
        fading_olds_size_ = size_ = 0;
    counts_ = {};
    reach_.clear();
    effect_reach_.clear();
    now_ = before_ = {};
    pace_ = 1;
    scales_ = {};
    effects_bound_ = {};
    effects_bound_stale_ = false;
    for (Group& group : groups_) {
        // What stays: where the probe sits, and was; and memory.
        Group fresh;
        fresh.placement = group.placement;
        fresh.next_placement = group.next_placement;
        fresh.moved = group.moved;
        fresh.probe = group.probe;
        fresh.before = group.before;
        fresh.arm = group.arm;
        fresh.near.slots = std::move(group.near.slots);
        group = std::move(fresh);
    }
    contacts_used_ = bounded_used_ = bounded_effects_used_ = collapsed_used_ = reshaped_size_ = 0;
    probes_used_ = 1;
    sets_edited_ = effects_edited_ = told_.edited = told_.relisted = true;
    kind_begin_ = {};
    active_kinds_size_ = 0;
}

}  // namespace knurl::detail

namespace knurl {

Verdict Scene::check_add(Handle handle, Kind kind, const void* params, std::size_t bytes,
                         const Use& use) const noexcept {
    return impl_->check_add(handle, kind, params, bytes, use);
}

Verdict Scene::add(Handle handle, Kind kind, const void* params, std::size_t bytes, const Use& use) noexcept {
    if (const Verdict verdict = impl_->check_add(handle, kind, params, bytes, use); !verdict) return verdict;
    detail::Slot& slot = impl_->slots_[handle.slot];
    slot.present = true;
    slot.generation = handle.generation;
    slot.kind = kind;
    slot.use = use;
    slot.shape_alone = false;
    std::memcpy(&impl_->raw_[handle.slot * max_parameter_bytes], params, bytes);
    impl_->mark(handle.slot);
    impl_->probes_used_ |= 1u << use.probe;
    ++impl_->size_;
    ++impl_->counts_[kind];
    return {};
}

Verdict Scene::check_update(Handle handle, Kind kind, const void* params, std::size_t bytes) noexcept {
    return impl_->check_update(handle, kind, params, bytes);
}

Verdict Scene::update(Handle handle, Kind kind, const void* params, std::size_t bytes) noexcept {
    if (const Verdict verdict = impl_->check_update(handle, kind, params, bytes); !verdict) return verdict;
    impl_->write_checked(handle.slot, params, bytes);
    return {};
}

void Scene::update_checked(Handle handle, const void* params, std::size_t bytes) noexcept {
    impl_->write_checked(handle.slot, params, bytes);
}

Verdict Scene::remove(Handle handle) noexcept {
    if (const Verdict verdict = check_named(handle, impl_->slots_); !verdict) return verdict;
    detail::Slot& slot = impl_->slots_[handle.slot];
    slot.present = false;
    impl_->mark(handle.slot);
    --impl_->size_;
    --impl_->counts_[slot.kind];
    return {};
}

void Scene::clear() noexcept {
    impl_->clear();
}
void Scene::settle() noexcept {
    impl_->settle_ = true;
}

}  // namespace knurl
