#pragma once

/// @file
/// A spring between a point of the application's and a point on the probe. Source: Mark et al. 96,
/// section 2.1.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// A spring between a point of the application and a point on the probe. Mark et al. 96, section 2.1.
struct Spring {
    /// The application's end (m), world frame.
    Vec3 anchor = {};
    /// The end on the probe (m), in the probe's frame.
    Vec3 attach = {};
    /// Length without force (m).
    double rest_length = 0;
    /// Stiffness (N/m), typically 50 to 500; infinity: as stiff as the device allows.
    double stiffness = 0;
    /// Damping along the spring (N s/m).
    double damping = 0;
    /// Time in which anchor and rest length move linearly to new values (s), 0 to 1000.
    double duration = 0.2;
    /// Set by the servo in `prepared`: stiffness as a share of the largest allowed (1).
    double share = 0;
    /// Set by the servo in `prepared`: a millimetre of the hand (m).
    double rounding = 1e-3;

    /// The servo's memory of one such representation.
    struct State {
        /// Where the application's end is now (m).
        Vec3 anchor;
        /// Rest length now (m).
        double rest_length = 0;
        /// Time until both have arrived (s).
        double remaining = 0;
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

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Spring prepared(Spring params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Spring& params, const Spring* previous, Spring::State& state, const Probe& probe) noexcept;
/// About the probe's position. The force is k (1 - L0 / sqrt(l^2 + e^2)) d - b (v.u) u, d from the attached
/// point to the anchor, u = d / l, v the attached point's velocity; e = max(min(1 mm, L0 / 20), L0 k / k_max)
/// takes away the jump of 2 k L0 at l = 0. The torque's own stiffness grows with the stretch: about an axis
/// it is k r.(a - p) across that axis, with r = R attach. Where k |r| |a - p| exceeds what the device stands,
/// the torque is scaled down by as much.
Wrench evaluate(const Spring& params, Spring::State& state, const Probe& probe, double dt) noexcept;
/// Returns how stiff and how damped the hand feels this effect at the probe, for the budget.
HandLoad load(const Spring& params, const Spring::State& state, const Probe& probe) noexcept;

/// What moves by itself at an update (anchor, rest length) taken over from `next`; the rest is cross-faded.
Spring carried(const Spring& old, const Spring& next) noexcept;
/// Arrives at once.
void settle(const Spring& params, Spring::State& state) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Spring& params) noexcept;
/// True: nothing moves any more.
bool arrived(const Spring& params, const Spring::State& state) noexcept;

}  // namespace knurl
