#pragma once
// Feedback to the application and the servo after a cycle.

#include <cstdint>
#include <span>
#include <vector>

#include "contact/contact_sets.hpp"
#include "effects/effect_stage.hpp"

namespace knurl::detail {

class FeedbackStage {
  public:
    FeedbackStage(SceneState& state, const SurfaceCandidates& candidates, const ContactSets& sets,
                  const EffectStage& effects);
    void reset() noexcept;

    /// Feedback of all representations that request it; returns how many.
    std::size_t write(std::span<Feedback> out) const noexcept;
    /// The same, where `kept` holds what the previous call left there.
    std::size_t write_changes(std::span<Feedback> kept, const Rewritten& rewritten) noexcept;
    Eigen::Vector3d contact_point(std::uint32_t probe) const noexcept;
    bool touches() const noexcept { return !touched_.empty(); }

  private:
    Feedback feedback_of(std::uint32_t slot, bool surface) const noexcept;
    void write_surface(std::uint32_t slot, const Record& r, Feedback& out) const noexcept;
    void write_touch(std::uint32_t slot, const Record& r, Feedback& out) const noexcept;
    void write_effect(std::uint32_t slot, Feedback& out) const noexcept;
    bool rewrite_flags(std::span<Feedback> kept, std::span<std::uint64_t> written) noexcept;
    template <class Put>
    void write_surfaces(std::uint32_t room, Put put) noexcept;
    template <class Put>
    void write_touched(Put put) noexcept;
    template <class Put>
    void write_effects(std::uint32_t room, bool all, Put put) noexcept;

    static constexpr std::uint32_t no_entry = 0xffffffff;
    SceneState& state_;
    const SurfaceCandidates& candidates_;
    const ContactSets& sets_;
    const EffectStage& effects_;
    // The state from which the kept feedback of surfaces was made. While it stays the same, surfaces that are
    // not touched need no new feedback.
    std::uint32_t silent_ = 0, fading_ = 0, infeasible_ = 0;  // bit masks: probes
    std::uint32_t surface_entries_ = 0, effect_entries_ = 0;  // effects lie behind the surfaces
    std::vector<std::uint32_t> entry_;                        // by slot: index in kept feedback, or no_entry
    std::vector<std::uint8_t> probe_;                         // by entry
    SlotList touched_;
};

}  // namespace knurl::detail
