#pragma once
// What all stages of a scene read: the limits, the time, the probes, the records. What one stage alone remembers is in
// that stage.

#include <array>
#include <cstdint>
#include <vector>

#include <knurl/reps/hand_budget.hpp>
#include <knurl/reps/scene.hpp>

#include "scene/scene_records.hpp"

namespace knurl::detail {

/// By number less one; null: there is none.
using Assets = std::array<const Asset*, max_assets>;

/// By which loads become shares of what the device stands; 0: of what is not known.
struct Shares {
    double stiffness = 0, damping = 0;  // m/N, m/(N s)
    double turning = 0;  // 1/m^2: an arm's square makes this share of rotation of one of translation
};
Shares shares_of(const Limits& limits) noexcept;
Limits sane_limits(Limits limits) noexcept;

struct Clock {
    std::uint64_t cycle = 0;
    std::uint64_t last_timed = 0;  // the last cycle in which time passed
    SceneTime now, before;         // at the end of this cycle, of the one before
    double step = 0;               // s, of this cycle
};

struct Silence {
    double seconds = 0;               // for how long the application has been silent; 0: it is not
    bool moves = false;               // not all weights are where the silence, or its end, takes them
    double held_velocity_weight = 1;  // of what holds: 1 it moves, 0 the silence has brought it to rest

    /// How much of its velocity counts: what holds in a silence stands still, by and by.
    double velocity_weight(const Record& r) const noexcept {
        return r.options.on_silence == OnSilence::hold ? held_velocity_weight : 1;
    }
    Eigen::Vector3d velocity_of(const Record& r) const noexcept { return velocity_weight(r) * r.velocity; }
    bool holds(const Record& r) const noexcept {
        return r.options.on_silence == OnSilence::hold && seconds > 0;
    }
};

/// Of a slot, as it is felt.
struct SlotState {
    bool active = false;
    bool twins = false;  // its records differ in nothing but geometry, of a surface that stands: see reshape
    bool renewed = false;  // while changes are taken: this slot's is one of them
    std::uint32_t generation = 0;
};

struct ProbeState {
    ProbePlacement placement;
    Probe probe;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();  // m, where it was in the last cycle that took time
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
    bool settles = false;  // the changes of this cycle are there from the start
    Records records;
    std::vector<SlotState> slots;
    std::vector<ProbeState> probes;
    std::uint32_t probes_used = 1;  // bit mask
    bool any_follows = false;       // a surface that the proxy enters and leaves has been felt: see ProxyPath
    SceneWork work;                 // of this cycle

    // What feedback has to write anew.
    bool feedback_edited = true;    // what is felt, its order, or what follows from its parameters alone
    bool feedback_relisted = true;  // other effects are evaluated than were
};

/// Calls visit(index) for each bit that is set, the lowest first.
template <class Visit>
void for_each_bit(std::uint32_t mask, Visit visit) {
    for (; mask != 0; mask &= mask - 1) visit(static_cast<std::uint32_t>(__builtin_ctz(mask)));
}

using SlotList = std::vector<std::uint32_t>;

/// Puts `slot` at the end of a list that has room for all slots, and notes where.
inline void join(SlotList& list, std::uint32_t slot, std::uint32_t& place) noexcept {
    place = static_cast<std::uint32_t>(list.size());
    list.push_back(slot);
}
/// Takes it out; the last one moves to its place. place_of(slot): what `join` noted.
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
