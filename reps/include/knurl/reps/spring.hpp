#pragma once
// A spring between a point of the application's and a point on the probe. Source: Mark et al. 96,
// section 2.1.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

struct Spring {
    Vec3 anchor = {};        // m, the application's end
    Vec3 attach = {};        // m, on the probe, in the probe's frame
    double rest_length = 0;  // m
    double stiffness = 0;    // N/m
    double damping = 0;      // N s/m, along the spring
    double duration = 0.2;   // s, in which anchor and rest length move linearly to new values
    // The servo's, filled in by `prepared`:
    double share = 0;        // stiffness as a share of the largest allowed
    double rounding = 1e-3;  // m, a millimetre of the hand

    struct State {
        Vec3 anchor;             // m, where the end is now
        double rest_length = 0;  // m, now
        double remaining = 0;    // s, until both have arrived
    };
};

template <>
struct Describe<Spring> {
    static constexpr std::string_view name = "spring";
    static constexpr Field fields[] = {
        vector_row("anchor", offsetof(Spring, anchor), "m", "the application's end"),
        vector_row("attach", offsetof(Spring, attach), "m", "the end on the probe, in the probe's frame"),
        number_row("rest_length", offsetof(Spring, rest_length), "m", "length without force"),
        stiffness_row(offsetof(Spring, stiffness), "force per stretch"),
        number_row("damping", offsetof(Spring, damping), "N s/m", "along the spring"),
        number_row("duration", offsetof(Spring, duration), "s",
                   "time in which anchor and rest length move to new values", 0, 1000),
    };
};

Spring prepared(Spring params, const Limits& limits) noexcept;
void adopt(const Spring& params, const Spring* previous, Spring::State& state, const Probe& probe) noexcept;
/// About the probe's position. The force is k (1 - L0 / sqrt(l^2 + e^2)) d - b (v.u) u, d from the attached
/// point to the anchor, u = d / l, v the attached point's velocity; e = max(min(1 mm, L0 / 20), L0 k / k_max)
/// takes away the jump of 2 k L0 at l = 0. The torque's own stiffness grows with the stretch: about an axis
/// it is k r.(a - p) across that axis, with r = R attach. Where k |r| |a - p| exceeds what the device stands,
/// the torque is scaled down by as much.
Wrench evaluate(const Spring& params, Spring::State& state, const Probe& probe, double dt) noexcept;
HandLoad load(const Spring& params, const Spring::State& state, const Probe& probe) noexcept;

/// What moves by itself at an update (anchor, rest length) taken over from `next`; the rest is cross-faded.
Spring carried(const Spring& old, const Spring& next) noexcept;
/// Arrives at once.
void settle(const Spring& params, Spring::State& state) noexcept;
bool powerless(const Spring& params) noexcept;
bool arrived(const Spring& params, const Spring::State& state) noexcept;

}  // namespace knurl
