#pragma once
// A flat convex polygon: a plate, a facet, a button. piece.hpp says how it is touched.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/piece.hpp>

namespace knurl {

inline constexpr std::uint32_t max_vertices = 8;

struct Vertices {
    Vec3 at[max_vertices] = {};
    std::uint32_t count = 0;
    std::uint32_t reserved = 0;
};

struct Polygon {
    // m, in order; seen from the front they run counter-clockwise. At first a square of 0.1 m that faces +z.
    Vertices vertices = {.at = {{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0.05, 0.05, 0}, {-0.05, 0.05, 0}},
                         .count = 4,
                         .reserved = 0};
    Vec3 velocity = {};           // m/s, with which it moves on between updates
    double stiffness = 0;         // N/m; infinity: as stiff as the device allows
    double damping = 0;           // N s/m
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

/// How far vertices may lie off their common plane or beyond an edge, and how near to each other: this share
/// of the polygon's size, and what rounding of the coordinates makes of it. Single precision is good enough.
inline constexpr double polygon_tolerance = 1e-6;

template <>
struct Describe<Polygon> {
    static constexpr std::string_view name = "polygon";
    static constexpr auto fields = join_rows(
        std::array{
            Field{.name = "vertices",
                  .type = Field::Type::points,
                  .offset = offsetof(Polygon, vertices),
                  .unit = "m",
                  .meaning = "corners in order, counter-clockwise seen from the front",
                  .minimum = -1e9,
                  .maximum = 1e9,
                  .count = max_vertices,
                  .least = 3},
            choice_row("sides", offsetof(Polygon, sides), "from where it can be touched",
                       detail::piece_sides),
        },
        surface_rows<Polygon>());
    static constexpr std::string_view contradictions[] = {
        static_below_dynamic,
        "between two of them: repeated; give each corner once",
        "of width: no area; give corners that do not lie on one line",
        "off their common plane: not planar; move the corners into one plane",
        "beyond an edge: not convex, or not in order; give convex pieces, corners in order",
    };
    static Verdict check(const Polygon& polygon) noexcept;
};

Polygon prepared(Polygon params, const Limits& limits) noexcept;
void adopt(const Polygon& params, const Polygon* previous, PieceState& state, const Probe& probe) noexcept;
/// The height is infinite where it cannot be touched: seen from behind with `sides = front`.
Contact contact(const Polygon& params, PieceState& state, const Probe& probe, double dt) noexcept;

/// None while it is touched: it holds the probe from however deep.
std::optional<Bound> bound(const Polygon& params, const PieceState& state) noexcept;
/// The path so far is forgotten: the next cycle sees it for the first time.
void out_of_reach(const Polygon& params, PieceState& state) noexcept;

}  // namespace knurl
