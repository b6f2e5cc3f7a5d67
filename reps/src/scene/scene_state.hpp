#pragma once
// What all stages of a scene read: limits, time, probes, records. State that only one stage needs is in that
// stage.

#include <array>
#include <cstdint>
#include <vector>

#include <knurl/reps/hand_budget.hpp>
#include <knurl/reps/scene.hpp>

#include "scene/scene_records.hpp"

namespace knurl::detail {

/// By asset number minus one; null: no asset.
using Assets = std::array<const Asset*, max_assets>;

/// Factors that turn loads into shares of the device's limits; 0: limit unknown.
struct Shares {
    double stiffness = 0, damping = 0;  // m/N, m/(N s)
    double turning = 0;  // 1/m^2: times an arm squared, the factor from a share of translation to one of
                         // rotation
};
Shares shares_of(const Limits& limits) noexcept;
Limits sane_limits(Limits limits) noexcept;

struct Clock {
    std::uint64_t cycle = 0;
    std::uint64_t last_timed = 0;  // the last cycle in which time passed
    SceneTime now, before;         // at the end of this cycle and of the one before
    double step = 0;               // s, of this cycle
};

struct Silence {
    double seconds = 0;               // duration of the application's silence; 0: none
    bool moves = false;               // some weights have not arrived at their final values
    double held_velocity_weight = 1;  // of surfaces that hold in silence: 1 they move, 0 they have stopped

    /// The share of its velocity that counts: a surface that holds in silence stops gradually.
    double velocity_weight(const Record& r) const noexcept {
        return r.options.on_silence == OnSilence::hold ? held_velocity_weight : 1;
    }
    Eigen::Vector3d velocity_of(const Record& r) const noexcept { return velocity_weight(r) * r.velocity; }
    bool holds(const Record& r) const noexcept {
        return r.options.on_silence == OnSilence::hold && seconds > 0;
    }
};

/// The state of a slot in the evaluation.
struct SlotState {
    bool active = false;
    bool twins = false;  // its two records differ only in geometry, and its surface stands still: see reshape
    bool renewed = false;  // while changes are taken: this slot has changed
    std::uint32_t generation = 0;
};

struct ProbeState {
    ProbePlacement placement;
    Probe probe;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();  // m, its place in the last cycle that took time
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();     // m, from the hand's position, world
};

struct SceneState {
    SceneState(std::size_t slots, std::size_t probe_count, const Limits& given)
        : limits(sane_limits(given)),
          shares(shares_of(limits)),
          records(slots),
          slots(slots),
          probes(probe_count) {}

    Limits limits;
    Shares shares;
    FadePolicy policy;
    Assets assets{};
    HandScales scales;

    Clock clock;
    Silence silence;
    bool settles = false;  // this cycle's changes act at once
    Records records;
    std::vector<SlotState> slots;
    std::vector<ProbeState> probes;
    std::uint32_t probes_used = 1;  // bit mask
    bool any_follows = false;       // an active surface is entered and left by the proxy: see ProxyPath
    SceneWork work;                 // of this cycle

    // Which feedback must be written anew.
    bool feedback_edited = true;    // the active representations, their order, or what follows from
                                    // parameters alone
    bool feedback_relisted = true;  // the list of evaluated effects
};

/// Calls visit(index) for each bit that is set, the lowest first.
template <class Visit>
void for_each_bit(std::uint32_t mask, Visit visit) {
    for (; mask != 0; mask &= mask - 1) visit(static_cast<std::uint32_t>(__builtin_ctz(mask)));
}

using SlotList = std::vector<std::uint32_t>;

/// Appends `slot` to a list with room for all slots, and notes its place.
inline void join(SlotList& list, std::uint32_t slot, std::uint32_t& place) noexcept {
    place = static_cast<std::uint32_t>(list.size());
    list.push_back(slot);
}
/// Removes the slot; the last one moves to its place. place_of(slot): what `join` noted.
template <class PlaceOf>
void leave(SlotList& list, std::uint32_t slot, PlaceOf place_of) noexcept {
    const std::uint32_t last = list.back();
    list[place_of(slot)] = last;
    place_of(last) = place_of(slot);
    list.pop_back();
}

inline SlotList empty_list(std::size_t capacity) {
    SlotList list;
    list.reserve(capacity);
    return list;
}

}  // namespace knurl::detail
