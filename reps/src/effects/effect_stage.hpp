#pragma once
// Effects are summed; each fades separately. Effects whose force is zero at the probe, or with their
// parameters, are not evaluated. Their force would be zero, so the sum is the same to the bit.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <knurl/reps/all.hpp>
#include <knurl/reps/collapsed_springs.hpp>
#include <knurl/reps/wrench.hpp>

#include "broad_phase/broad_phase.hpp"
#include "scene/clamped.hpp"
#include "scene/scene_state.hpp"

namespace knurl::detail {

/// What the effect fades from.
enum class FadeFrom : std::uint8_t { none, nothing, record, frozen };

struct EffectState {
    FadeFrom from = FadeFrom::none;
    bool evaluated = false;        // it is evaluated in each cycle
    bool collapsed = false;        // a spring that is part of its probe's CollapsedSprings
    bool carries = false;          // the old record belongs to the same effect: it moves along
    std::uint32_t place = 0;       // index in effects_
    double elapsed = 0, time = 0;  // s
    double gain = 1;               // of the new record
    Wrench frozen;                 // about the hand
    Wrench remnant;                // the old record's share in this cycle
    Wrench last;                   // contribution to the hand in the last cycle
};

class EffectStage {
  public:
    explicit EffectStage(SceneState& state);
    void reset() noexcept;
    void index() { candidates_.index(); }

    // While changes are taken: the current record no longer acts.
    void forget(std::uint32_t slot) noexcept { candidates_.forget(slot, state_.records.current(slot)); }
    /// The current record acts in its place, if `is`. `previous`: the record that acted before, if any;
    /// `same`: it is the same effect with other parameters. True: its old record is what fades out now.
    bool change(std::uint32_t slot, Record* previous, bool is, bool same) noexcept;
    /// These probes (bit mask) move to another place on the hand: their present forces fade out.
    void replace_probes(std::uint32_t probes) noexcept;
    /// The old record is about to be overwritten.
    void release_old(std::uint32_t slot) noexcept;
    /// The list of evaluated effects may change.
    void edit() noexcept { edited_ = true; }
    bool edited() const noexcept { return edited_; }
    bool probes_left() noexcept { return candidates_.probes() != 0 && candidates_.left(state_); }
    void update() noexcept;

    /// Adds the wrench of all effects, about the hand's position.
    void evaluate(double dt, Wrench& sum) noexcept;
    bool idle() const noexcept { return active_kinds_.empty() && collapsed_ == 0 && fading_.empty(); }

    // For the stages that follow.
    const EffectState& operator[](std::uint32_t slot) const noexcept { return effects_state_[slot]; }
    std::span<const std::uint32_t> effects() const noexcept { return effects_; }  // the active ones
    std::span<const std::uint32_t> evaluated() const noexcept {
        return by_kind_;
    }  // except collapsed springs
    std::span<const std::uint32_t> fading() const noexcept { return fading_; }
    std::uint32_t collapsed_probes() const noexcept { return collapsed_; }  // bit mask
    Wrench collapsed_wrench(std::uint32_t probe) const noexcept {
        return springs_[probe].evaluate(state_.probes[probe].probe);
    }
    /// Upper bound at the hand over all evaluated effects, in shares of the device's limits.
    const Demand& bound() const noexcept { return bound_; }
    Demand bound_of(const Record& effect) const noexcept;
    double sleep_radius() const noexcept { return candidates_.sleep_radius(state_); }

    /// One call per kind in the scene: unused kinds cost no call. Called from KindOps::evaluate_all.
    template <class Evaluate, class Arrived>
    void evaluate_each(std::span<const std::uint32_t> slots, double dt, Wrench& sum, Evaluate evaluate,
                       Arrived arrived) noexcept {
        for (const std::uint32_t i : slots) {
            Record& r = state_.records.current(i);
            EffectState& effect = effects_state_[i];
            const ProbeState& probe = state_.probes[r.probe];
            const bool under_way = !arrived(r);
            const double step = own_step(r, !under_way, dt);
            effect.last = (effect.gain * r.weight) * at_hand(evaluate(r, probe.probe, step), probe);
            sum += effect.last;
            if (effect.from != FadeFrom::none) effect.last += effect.remnant;
            // From now on it may be collapsed with others, or cost nothing.
            if (under_way && arrived(r)) edited_ = true;
        }
    }

  private:
    bool fade_in(std::uint32_t slot, Record* previous, bool is, bool same) noexcept;
    void start_fade(std::uint32_t slot, FadeFrom from, double time) noexcept;
    void advance_fades(double dt, Wrench& sum) noexcept;
    bool is_needed(std::uint32_t slot) const noexcept;
    bool may_collapse(std::uint32_t slot) const noexcept;
    void list() noexcept;
    void bound_all() noexcept;
    void evaluate_at_probes(double dt, Wrench& sum) noexcept;  // at the velocity that the probes report
    Wrench at_hand(const Wrench& at_probe, const ProbeState& probe) const noexcept {
        const Limits& limits = state_.limits;
        Wrench w{clamped(at_probe.force, limits.max_force), clamped(at_probe.torque, limits.max_torque)};
        if (probe.placement.offset != Vec3{}) w.torque += probe.arm.cross(w.force);
        return w;
    }
    double own_step(const Record& r, bool arrived, double dt) const noexcept {
        return (state_.silence.holds(r) || r.weight == 0) && arrived ? 0 : dt;
    }

    SceneState& state_;
    EffectCandidates candidates_;
    std::vector<EffectState> effects_state_;  // by slot
    SlotList effects_;                        // active ones
    SlotList fading_;                         // slots whose effect fades
    bool edited_ = false;
    bool bound_stale_ = false;
    Demand bound_;
    std::vector<CollapsedSprings> springs_;  // by probe
    std::uint32_t collapsed_ = 0;            // bit mask: probes with collapsed springs
    SlotList by_kind_;                       // evaluated ones, except collapsed springs
    std::array<std::uint32_t, Representations::size + 1> kind_begin_{};
    std::vector<Kind> active_kinds_;
};

}  // namespace knurl::detail
