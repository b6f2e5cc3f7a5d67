#pragma once

/// @file
/// One half of a plane: the edge of a table, a step, a shelf that goes on and on. piece.hpp says how it is
/// touched.

#include <cstddef>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/piece.hpp>

namespace knurl {

/// The points with normal.x = offset and edge.x <= edge_offset.
struct HalfPlane {
    /// Normal, towards the front. A length other than 1 divides `offset` too.
    Vec3 normal = {0, 0, 1};
    /// The face lies in normal.x = offset (m).
    double offset = 0;
    /// Direction out of the face across its edge. A length other than 1 divides `edge_offset` too.
    Vec3 edge = {1, 0, 0};
    /// Points of the face have edge.x <= edge_offset (m).
    double edge_offset = 0;
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
    /// From which side the piece can be touched.
    Sides sides = Sides::front;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Share of the hand's momentum that a pulse takes away at entry (1); Salcudean and Vlaar. 0: no pulse.
    double braking = 0;
    /// Friction along the surface; by default none.
    Friction friction = {};
    /// Snags along the surface; by default none.
    Snag snag = {};
    /// Relief on the surface; by default none.
    Texture texture = {};

    /// The servo's memory of one such representation.
    using State = PieceState;
    /// The proxy enters and leaves this surface (concepts.hpp).
    static constexpr bool follows = true;
};

template <>
struct Describe<HalfPlane> {
    static constexpr std::string_view name = "half_plane";
    static constexpr auto fields = join_rows(
        std::array{
            direction_row("normal", offsetof(HalfPlane, normal), "towards the front"),
            number_row("offset", offsetof(HalfPlane, offset), "m", "the face lies in n.x = offset", -1e9,
                       1e9),
            direction_row("edge", offsetof(HalfPlane, edge), "out of the face, across its edge"),
            number_row("edge_offset", offsetof(HalfPlane, edge_offset), "m",
                       "points of the face have edge.x <= edge_offset", -1e9, 1e9),
            choice_row("sides", offsetof(HalfPlane, sides), "from where it can be touched",
                       detail::piece_sides),
        },
        surface_rows<HalfPlane>());
    static constexpr std::string_view contradictions[] = {
        static_below_dynamic,
        "of its length in the face: parallel to the normal; give a direction across the edge",
    };
    static Verdict check(const HalfPlane& half) noexcept;
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
HalfPlane prepared(HalfPlane params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const HalfPlane& params, const HalfPlane* previous, PieceState& state,
           const Probe& probe) noexcept;
/// The tangent plane at the probe's foot. The height is infinite where it cannot be touched: seen from behind
/// with `sides = front`.
Contact contact(const HalfPlane& params, PieceState& state, const Probe& probe, double dt) noexcept;
/// Returns how far the probe may move before it touches (m); 0: it is touched.
double clearance(const HalfPlane& params, const PieceState& state, const Probe& probe) noexcept;
/// The representation was not evaluated for a while: its path is forgotten.
void out_of_reach(const HalfPlane& params, PieceState& state) noexcept;

}  // namespace knurl
