#pragma once

/// @file
/// A cylinder with flat ends, or the room in one. Outside its height is the distance, so a probe with a
/// radius feels its edges rounded; inside it is that of the nearest face.

#include <cstddef>
#include <optional>
#include <span>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

/// A cylinder with flat ends, or the room in one.
struct Cylinder {
    /// Its middle (m), world frame.
    Vec3 center = {};
    /// Direction of the axis, of any length but 0; the servo normalises it.
    Vec3 axis = {0, 0, 1};
    /// Radius of the wall (m).
    double radius = 0.01;
    /// From the middle to an end (m); 0: a disc; infinity: endless.
    double half_length = 0.02;
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
    /// Most tangent planes at once (concepts.hpp).
    static constexpr std::uint32_t max_contacts = 2;
};

template <>
struct Describe<Cylinder> {
    static constexpr std::string_view name = "cylinder";
    static constexpr Field half_length = [] {
        Field row = number_row("half_length", offsetof(Cylinder, half_length), "m",
                               "from the middle to an end; infinity: endless");
        row.infinity_allowed = true;
        return row;
    }();
    static constexpr auto fields =
        join_rows(std::array{center_row<Cylinder>(), axis_row<Cylinder>(),
                             number_row("radius", offsetof(Cylinder, radius), "m", "of the wall"),
                             half_length, side_row<Cylinder>()},
                  surface_rows<Cylinder>());
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Cylinder prepared(Cylinder params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Cylinder& params, const Cylinder* previous, Cylinder::State& state,
           const Probe& probe) noexcept;
/// Returns the tangent plane at the probe's foot, and advances `state` by `dt` (s).
Contact contact(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt) noexcept;
/// Of a hollow cylinder the wall and the nearer end, which hold both in its corner; else one contact.
std::uint32_t contacts(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept;
/// Fills in the surface near `there` with its curvature, and returns how many (concepts.hpp).
std::uint32_t curved(const Cylinder& params, const Cylinder::State& state, const Probe& probe,
                     const Probe& there, std::span<CurvedContact> out) noexcept;
/// Keeps the plane by which a deep probe is held where this solid meets others (concepts.hpp).
void lean(const Cylinder& params, Cylinder::State& state, const Probe& there, double below) noexcept;
/// Gives the plane by which it holds the probe in a layer of that stiffness (N/m), where that differs from
/// `contact`.
bool plane_alone(const Cylinder& params, const Cylinder::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Cylinder& params, const Cylinder::State& state) noexcept;
/// The representation was not evaluated for a while: its path is forgotten.
void out_of_reach(const Cylinder& params, Cylinder::State& state) noexcept;

}  // namespace knurl
