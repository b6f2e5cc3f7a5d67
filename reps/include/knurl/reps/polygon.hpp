#pragma once

/// @file
/// A flat convex polygon: a plate, a facet, a button. piece.hpp says how it is touched.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/piece.hpp>

namespace knurl {

/// Most corners of a polygon.
inline constexpr std::uint32_t max_vertices = 8;

/// Corners of a polygon.
struct Vertices {
    /// The corners (m); the first `count` are in use.
    Vec3 at[max_vertices] = {};
    /// How many corners there are, 3 to max_vertices.
    std::uint32_t count = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

/// A flat convex polygon: a plate, a facet, a button.
struct Polygon {
    /// Corners in order (m), world frame; seen from the front they run counter-clockwise. By default a square
    /// of 0.1 m that faces +z.
    Vertices vertices = {.at = {{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0.05, 0.05, 0}, {-0.05, 0.05, 0}},
                         .count = 4,
                         .reserved = 0};
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

/// How far vertices may lie off their common plane or beyond an edge, and how near to each other they may be:
/// this share of the polygon's size (1), and what rounding of the coordinates adds. Single precision is good
/// enough.
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

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Polygon prepared(Polygon params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Polygon& params, const Polygon* previous, PieceState& state, const Probe& probe) noexcept;
/// The tangent plane at the probe's foot. The height is infinite where it cannot be touched: seen from behind
/// with `sides = front`.
Contact contact(const Polygon& params, PieceState& state, const Probe& probe, double dt) noexcept;

/// The ball outside of which the polygon is out of reach. None while it is touched: it holds the probe from
/// however deep.
std::optional<Bound> bound(const Polygon& params, const PieceState& state) noexcept;
/// The path so far is forgotten: the next cycle sees it for the first time.
void out_of_reach(const Polygon& params, PieceState& state) noexcept;

}  // namespace knurl
