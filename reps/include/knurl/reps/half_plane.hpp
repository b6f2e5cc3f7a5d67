#pragma once
// One half of a plane: the edge of a table, a step, a shelf that goes on and on. piece.hpp says how it is
// touched.

#include <cstddef>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/piece.hpp>

namespace knurl {

/// The points with normal.x = offset and edge.x <= edge_offset.
struct HalfPlane {
    Vec3 normal = {0, 0, 1};  // towards the front; a length other than 1 divides offset too
    double offset = 0;        // m
    Vec3 edge = {1, 0, 0};   // out of the face across its edge; a length other than 1 divides edge_offset too
    double edge_offset = 0;  // m
    Vec3 velocity = {};      // m/s, with which it moves on between updates
    double stiffness = 0;    // N/m; infinity: as stiff as the device allows
    double damping = 0;      // N s/m
    double recovery = automatic;  // s; 0: at once
    Sides sides = Sides::front;
    std::uint32_t reserved = 0;
    double braking = 0;  // 1, share of the hand's momentum taken away at entry
    Friction friction = {};
    Snag snag = {};
    Texture texture = {};

    using State = PieceState;
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

HalfPlane prepared(HalfPlane params, const Limits& limits) noexcept;
void adopt(const HalfPlane& params, const HalfPlane* previous, PieceState& state,
           const Probe& probe) noexcept;
/// The height is infinite where it cannot be touched: seen from behind with `sides = front`.
Contact contact(const HalfPlane& params, PieceState& state, const Probe& probe, double dt) noexcept;
double clearance(const HalfPlane& params, const PieceState& state, const Probe& probe) noexcept;
void out_of_reach(const HalfPlane& params, PieceState& state) noexcept;

}  // namespace knurl
