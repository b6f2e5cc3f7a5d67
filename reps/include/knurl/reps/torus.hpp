#pragma once

/// @file
/// A ring, or the room in its tube: a sphere about the nearest point of the circle within. A probe too large
/// for the hole plugs it: there it comes no farther than to one point of the axis on either side.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

/// A ring, or the room in its tube.
struct Torus {
    /// Its middle (m), world frame.
    Vec3 center = {};
    /// Axis about which the ring goes, of any length but 0.
    Vec3 axis = {0, 0, 1};
    /// Radius of the circle within the tube (m).
    double radius = 0.02;
    /// Radius of the tube (m), less than `radius`; 0: a wire.
    double tube = 0.005;
    /// Where free space is: around the solid, or in the hollow.
    Side side = Side::outside;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Velocity with which the surface moves on between two updates (m/s).
    Vec3 velocity = {};
    /// Stiffness (N/m), typically 200 to 2000. Infinity: the largest that the device allows. Larger values
    /// are clamped.
    double stiffness = 0;
    /// Damping along the normal (N s/m), while touched; typically 0 to 5. Clamped to what the device stands.
    double damping = 0;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;
    /// Share of the hand's momentum that a pulse takes away at entry (1); Salcudean and Vlaar. 0: no pulse.
    double braking = 0;
    /// Friction along the surface; by default none.
    Friction friction = {};
    /// Snags along the surface; by default none.
    Snag snag = {};
    /// Relief on the surface; by default none.
    Texture texture = {};

    /// The servo's memory of one such representation.
    using State = SolidState;
};

template <>
struct Describe<Torus> {
    static constexpr std::string_view name = "torus";
    static constexpr auto fields = join_rows(
        std::array{center_row<Torus>(), axis_row<Torus>(),
                   number_row("radius", offsetof(Torus, radius), "m", "of the circle within the tube"),
                   number_row("tube", offsetof(Torus, tube), "m", "0: a wire"), side_row<Torus>()},
        surface_rows<Torus>());
    static constexpr std::string_view contradictions[] = {
        static_below_dynamic, "leaves no hole in the ring; give less than radius"};
    static Verdict check(const Torus& torus) noexcept;
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Torus prepared(Torus params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Torus& params, const Torus* previous, Torus::State& state, const Probe& probe) noexcept;
/// Returns the tangent plane at the probe's foot, and advances `state` by `dt` (s).
Contact contact(const Torus& params, Torus::State& state, const Probe& probe, double dt) noexcept;
/// Fills in the surface near `there` with its curvature, and returns how many (concepts.hpp).
std::uint32_t curved(const Torus& params, const Torus::State& state, const Probe& probe, const Probe& there,
                     std::span<CurvedContact> out) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Torus& params, const Torus::State& state) noexcept;
/// The representation was not evaluated for a while: its path is forgotten.
void out_of_reach(const Torus& params, Torus::State& state) noexcept;

}  // namespace knurl
