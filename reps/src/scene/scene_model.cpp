#include "scene/scene_model.hpp"

#include <cstring>

#include <knurl/reps/check.hpp>

namespace knurl::detail {

using Code = Verdict::Code;

SceneModel::SceneModel(Scene::Capacity capacity)
    : slots_(capacity.representations),
      raw_(capacity.representations * max_parameter_bytes),
      changed_(empty_list(capacity.representations)),
      placements_(capacity.probes) {}

Verdict SceneModel::check_add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                              const AddOptions& options) const noexcept {
    const Verdict verdict = check_vacant(id, slots_);
    const auto probes = static_cast<std::uint32_t>(placements_.size());
    return verdict ? check_added(kind, params, bytes, options, probes) : verdict;
}

Verdict SceneModel::add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                        const AddOptions& options) noexcept {
    if (const Verdict verdict = check_add(id, kind, params, bytes, options); !verdict) return verdict;
    ModelSlot& slot = slots_[id.slot];
    slot.present = true;
    slot.generation = id.generation;
    slot.kind = kind;
    slot.options = options;
    slot.geometry_alone = false;
    std::memcpy(&raw_[id.slot * max_parameter_bytes], params, bytes);
    mark(id.slot);
    probes_used_ |= 1u << options.probe;
    ++size_;
    ++counts_[kind];
    return {};
}

Verdict SceneModel::check_update(RepresentationId id, Kind kind, const void* params,
                                 std::size_t bytes) noexcept {
    if (kind >= Representations::size)
        return {Code::unknown_kind, Verdict::no_field, static_cast<double>(kind)};
    if (!names_one(id, slots_) || slots_[id.slot].kind != kind)
        return {Code::no_such_slot, Verdict::no_field, static_cast<double>(id.slot)};
    const KindOps& ops = kind_ops()[kind];
    const std::size_t geometry = ops.geometry_bytes;
    if (bytes != ops.params_size && bytes != geometry)
        return {Code::wrong_size, Verdict::no_field, static_cast<double>(bytes)};
    // The slot holds legal parameters. Where only the geometry differs from them, only the geometry is
    // checked.
    const std::byte* raw = &raw_[id.slot * max_parameter_bytes];
    const auto* sent = static_cast<const std::byte*>(params);
    const bool rest_stays = std::memcmp(raw + geometry, sent + geometry, bytes - geometry) == 0;
    slots_[id.slot].differ = rest_stays ? ops.compare_geometry(raw, sent) : Differ::anywhere;
    return slots_[id.slot].differ != Differ::anywhere ? Verdict{} : validate(kind, raw, sent, bytes);
}

// Puts the first bytes of the new parameters over those that are there.
Verdict SceneModel::validate(Kind kind, const std::byte* raw, const std::byte* sent,
                             std::size_t bytes) noexcept {
    if (bytes == kind_ops()[kind].params_size) return kinds()[kind].validate(sent);
    std::memcpy(merged_.data(), raw, kind_ops()[kind].params_size);
    std::memcpy(merged_.data(), sent, bytes);
    return kinds()[kind].validate(merged_.data());
}

// Uses the result of the last check. A batch may name a slot twice: then the result is of the last entry,
// which is also the one that remains.
void SceneModel::update_checked(std::uint32_t i, const void* params, std::size_t bytes) noexcept {
    ModelSlot& slot = slots_[i];
    if (slot.differ == Differ::nowhere) return;  // no difference from the last requested value
    const bool geometry = slot.differ == Differ::in_geometry;
    slot.geometry_alone = slot.geometry_alone && geometry;
    std::memcpy(&raw_[i * max_parameter_bytes], params,
                geometry ? kind_ops()[slot.kind].geometry_bytes : bytes);
    mark(i);
}

Verdict SceneModel::remove(RepresentationId id) noexcept {
    if (const Verdict verdict = check_named(id, slots_); !verdict) return verdict;
    ModelSlot& slot = slots_[id.slot];
    slot.present = false;
    mark(id.slot);
    --size_;
    --counts_[slot.kind];
    return {};
}

Verdict SceneModel::place_probe(std::uint32_t probe, const ProbePlacement& placement) noexcept {
    const auto probes = static_cast<std::uint32_t>(placements_.size());
    if (const Verdict verdict = check_placement(probe, placement, probes); !verdict) return verdict;
    Placement& present = placements_[probe];
    if (present.placement.offset == placement.offset && present.placement.radius == placement.radius)
        return {};
    present = {.placement = placement, .changed = true};
    placements_changed_ = true;
    return {};
}

void SceneModel::mark(std::uint32_t slot) noexcept {
    if (slots_[slot].changed) return;
    slots_[slot].changed = true;
    changed_.push_back(slot);
}

void SceneModel::touch_all() noexcept {
    for (std::uint32_t i = 0; i < slots_.size(); ++i) {
        if (!slots_[i].present) continue;
        slots_[i].geometry_alone = false;
        mark(i);
    }
}

void SceneModel::clear() noexcept {
    std::fill(slots_.begin(), slots_.end(), ModelSlot{});
    changed_.clear();
    probes_used_ = 1;
    size_ = 0;
    counts_ = {};
}

}  // namespace knurl::detail
