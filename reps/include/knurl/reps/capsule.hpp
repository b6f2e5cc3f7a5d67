#pragma once

/// @file
/// A rod with round ends, or the room in one: a sphere about the nearest point of its axis.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

/// A rod with round ends, or the room in one.
struct Capsule {
    /// Its middle (m), world frame.
    Vec3 center = {};
    /// Direction of the axis, of any length but 0; the servo normalises it.
    Vec3 axis = {0, 0, 1};
    /// From the middle to where the round ends begin (m); 0: a sphere.
    double half_length = 0.02;
    /// Radius of rod and ends (m); 0: a needle.
    double radius = 0.01;
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
struct Describe<Capsule> {
    static constexpr std::string_view name = "capsule";
    static constexpr auto fields = join_rows(
        std::array{center_row<Capsule>(), axis_row<Capsule>(),
                   number_row("half_length", offsetof(Capsule, half_length), "m",
                              "from the middle to where the round ends begin"),
                   number_row("radius", offsetof(Capsule, radius), "m", "0: a needle"), side_row<Capsule>()},
        surface_rows<Capsule>());
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Capsule prepared(Capsule params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Capsule& params, const Capsule* previous, Capsule::State& state,
           const Probe& probe) noexcept;
/// Returns the tangent plane at the probe's foot, and advances `state` by `dt` (s).
Contact contact(const Capsule& params, Capsule::State& state, const Probe& probe, double dt) noexcept;
/// Fills in the surface near `there` with its curvature, and returns how many (concepts.hpp).
std::uint32_t curved(const Capsule& params, const Capsule::State& state, const Probe& probe,
                     const Probe& there, std::span<CurvedContact> out) noexcept;
/// Keeps the plane by which a deep probe is held where this solid meets others (concepts.hpp).
void lean(const Capsule& params, Capsule::State& state, const Probe& there, double below) noexcept;
/// Gives the plane by which it holds the probe in a layer of that stiffness (N/m), where that differs from
/// `contact`.
bool plane_alone(const Capsule& params, const Capsule::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Capsule& params, const Capsule::State& state) noexcept;
/// The representation was not evaluated for a while: its path is forgotten.
void out_of_reach(const Capsule& params, Capsule::State& state) noexcept;

}  // namespace knurl
