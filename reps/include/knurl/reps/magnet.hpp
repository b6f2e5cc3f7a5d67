#pragma once

/// @file
/// Draws the probe to a sphere's surface, or with no radius to a point, from either side: k x at the distance
/// x from it up to max_force, from there linearly down to nothing at max_distance.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// Draws the probe to a sphere's surface, or with no radius to a point, from either side.
struct Magnet {
    /// Centre of the sphere (m), world frame.
    Vec3 position = {};
    /// Radius of the sphere (m); 0: a point.
    double radius = 0;
    /// Stiffness near the surface (N/m); infinity: as stiff as the device allows.
    double stiffness = 0;
    /// Largest pull (N), reached at the distance max_force / stiffness; typically 1.
    double max_force = 1;
    /// Distance from the surface at which the pull ends (m); more than max_force / stiffness.
    double max_distance = 0.02;
    /// Damping against all motion (N s/m); it fades out where the pull does.
    double damping = 0;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;
    /// Set by the servo in `prepared`: radius about the centre within which the direction is rounded off (m).
    double rounding = 0;

    /// The servo's memory of one such representation.
    struct State {
        /// Nothing is remembered.
        std::uint64_t unused = 0;
    };
};

template <>
struct Describe<Magnet> {
    static constexpr std::string_view name = "magnet";
    static constexpr Field fields[] = {
        vector_row("position", offsetof(Magnet, position), "m", "the sphere's centre"),
        number_row("radius", offsetof(Magnet, radius), "m", "of the sphere to whose surface it draws"),
        stiffness_row(offsetof(Magnet, stiffness), "force per distance near the surface"),
        number_row("max_force", offsetof(Magnet, max_force), "N", "the strongest pull"),
        number_row("max_distance", offsetof(Magnet, max_distance), "m",
                   "from the surface, where the pull ends"),
        number_row("damping", offsetof(Magnet, damping), "N s/m", "against motion within its reach"),
        recovery_row(offsetof(Magnet, recovery)),
    };
    static constexpr std::string_view contradictions[] = {
        "is not beyond max_force / stiffness = {}, where it pulls most; give more, or less max_force"};
    static Verdict check(const Magnet& magnet) noexcept;
};

/// A device's largest stiffness k_max bounds the pull's falling side too, which pushes away: max_force is at
/// most max_distance k k_max / (k + k_max).
Magnet prepared(Magnet params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Magnet& params, const Magnet* previous, Magnet::State& state, const Probe& probe) noexcept;
/// -+f(x) q / sqrt(|q|^2 + e^2) with q from the centre to the probe, x = ||q| - radius|, and e = max(min(1
/// mm, radius / 20), f(radius) / k_max), which takes away the jump of 2 f(radius) at the centre of a sphere
/// that reaches there. Without a radius e is 0.
Wrench evaluate(const Magnet& params, Magnet::State& state, const Probe& probe, double dt) noexcept;
/// Returns how stiff and how damped the hand feels this effect at the probe, for the budget.
HandLoad load(const Magnet& params, const Magnet::State& state, const Probe& probe) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Magnet& params) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Magnet& params) noexcept;

}  // namespace knurl
