#pragma once
// What the application has sent: the representations, their parameters, and the places of the probes. A
// change is checked first, then written whole or not at all. Nothing here acts on the hand: the next
// evaluation takes the slots and placements that changed.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <knurl/reps/scene.hpp>

#include "scene/kind_ops.hpp"

namespace knurl::detail {

class SceneModel {
  public:
    struct ModelSlot {
        bool present = false;
        bool changed = false;
        Differ differ = Differ::anywhere;  // result of the last check
        bool geometry_alone = false;       // only its geometry has changed since it was taken
        std::uint32_t generation = 0;
        Kind kind = 0;
        AddOptions options;
    };

    explicit SceneModel(Scene::Capacity capacity);

    Verdict check_add(RepresentationId, Kind, const void* params, std::size_t bytes,
                      const AddOptions&) const noexcept;
    Verdict add(RepresentationId, Kind, const void* params, std::size_t bytes, const AddOptions&) noexcept;
    Verdict check_update(RepresentationId, Kind, const void* params, std::size_t bytes) noexcept;
    void update_checked(std::uint32_t slot, const void* params, std::size_t bytes) noexcept;
    Verdict remove(RepresentationId) noexcept;
    Verdict place_probe(std::uint32_t probe, const ProbePlacement& placement) noexcept;
    void clear() noexcept;  // the probes' placements stay
    /// All slots must be taken anew, since limits or assets have changed.
    void touch_all() noexcept;

    std::uint32_t probes_used() const noexcept {
        return probes_used_;
    }  // bit mask: the first probe, and all that were placed or used
    std::uint32_t slots() const noexcept { return static_cast<std::uint32_t>(slots_.size()); }
    std::uint32_t size() const noexcept { return size_; }
    std::uint32_t count(Kind kind) const noexcept { return counts_[kind]; }
    const ModelSlot& operator[](std::uint32_t slot) const noexcept { return slots_[slot]; }
    const ProbePlacement& placement(std::uint32_t probe) const noexcept {
        return placements_[probe].placement;
    }
    const std::byte* params(std::uint32_t slot) const noexcept { return &raw_[slot * max_parameter_bytes]; }

    bool changed() const noexcept { return !changed_.empty() || placements_changed_; }
    bool slots_changed() const noexcept { return !changed_.empty(); }
    bool placements_changed() const noexcept { return placements_changed_; }
    /// Calls take(slot) for each changed slot, in the order of first change. A slot for which it returns true
    /// is `taken` until it is forgotten.
    template <class Take>
    void take_changed(Take take) noexcept {
        std::size_t kept = 0;
        for (const std::uint32_t i : changed_) {
            if (take(i)) changed_[kept++] = i;
            slots_[i].changed = false;
            slots_[i].geometry_alone = true;
        }
        changed_.resize(kept);
    }
    std::span<const std::uint32_t> taken() const noexcept { return changed_; }
    void forget_taken() noexcept { changed_.clear(); }
    /// Calls take(probe, placement) for each probe with a new place.
    template <class Take>
    void take_placements(Take take) noexcept {
        for (std::uint32_t p = 0; p < placements_.size(); ++p) {
            if (!placements_[p].changed) continue;
            placements_[p].changed = false;
            take(p, placements_[p].placement);
        }
        placements_changed_ = false;
    }

  private:
    Verdict validate(Kind, const std::byte* raw, const std::byte* sent, std::size_t bytes) noexcept;
    void mark(std::uint32_t slot) noexcept;

    struct Placement {
        ProbePlacement placement;
        bool changed = false;
    };
    std::vector<ModelSlot> slots_;
    std::vector<std::byte> raw_;  // max_parameter_bytes each
    alignas(
        16) std::array<std::byte, max_params> merged_{};  // the present parameters with the new bytes, to be
                                                          // checked
    SlotList changed_;
    std::vector<Placement> placements_;  // by probe
    bool placements_changed_ = false;
    std::uint32_t probes_used_ = 1;
    std::uint32_t size_ = 0;
    std::array<std::uint32_t, Representations::size> counts_{};
};

}  // namespace knurl::detail
