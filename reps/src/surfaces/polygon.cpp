#include <algorithm>

#include <knurl/reps/polygon.hpp>

#include "surfaces/piece.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

constexpr double no_length = 1e-30;  // m: the square of such an area is still a number

std::uint32_t next(const Vertices& vertices, std::uint32_t i) noexcept {
    return i + 1 < vertices.count ? i + 1 : 0;
}

// Twice the area times the normal, seen from the first vertex (Newell's method: all vertices count).
Vector3d area_vector(const Vertices& vertices) noexcept {
    const Vector3d first = to_eigen(vertices.at[0]);
    Vector3d sum = Vector3d::Zero(), edge = to_eigen(vertices.at[1]) - first;
    for (std::uint32_t i = 2; i < vertices.count; ++i) {
        const Vector3d following = to_eigen(vertices.at[i]) - first;
        sum += edge.cross(following);
        edge = following;
    }
    return sum;
}

Vector3d centre(const Vertices& vertices) noexcept {
    const Vector3d first = to_eigen(vertices.at[0]);
    Vector3d sum = Vector3d::Zero();
    for (std::uint32_t i = 1; i < vertices.count; ++i) sum += to_eigen(vertices.at[i]) - first;
    return first + sum / vertices.count;
}

Bound ball_around(const Vertices& vertices) noexcept {
    Bound ball{.center = centre(vertices)};
    double square = 0;
    for (std::uint32_t i = 0; i < vertices.count; ++i) {
        square = std::max(square, (to_eigen(vertices.at[i]) - ball.center).squaredNorm());
    }
    ball.radius = std::sqrt(square);
    return ball;
}

class PolygonOutline {
  public:
    explicit PolygonOutline(const Polygon& polygon) noexcept
        : vertices_(polygon.vertices), normal_(Distance(area_vector(vertices_)).direction) {}

    const Vector3d& normal() const noexcept { return normal_; }
    double height(const Vector3d& q) const noexcept { return normal_.dot(q - to_eigen(vertices_.at[0])); }

    bool reaches(const Vector3d& q, double radius) const noexcept {
        const Bound ball = ball_around(vertices_);
        return (q - ball.center).norm() <= ball.radius + radius;
    }

    double seam(const ProxyPath&) const noexcept { return seam_of_size * 2 * ball_around(vertices_).radius; }

    bool holds(const Vector3d& q, double reach, double by) const noexcept {
        for (std::uint32_t i = 0; i < vertices_.count; ++i) {
            const Vector3d start = to_eigen(vertices_.at[i]);
            const Vector3d edge = to_eigen(vertices_.at[next(vertices_, i)]) - start;
            const double beyond = edge.cross(normal_).dot(q - start);  // multiplied by the edge's length
            if (!(beyond > 0)) continue;
            const double slack = by + piece::rounding * (reach + start.lpNorm<1>());
            if (beyond * beyond > slack * slack * edge.squaredNorm()) return false;
        }
        return true;
    }

    // If the foot lies beyond an edge, the nearest point is on such an edge.
    Vector3d away(const Vector3d& q) const noexcept {
        Vector3d nearest = Vector3d::Zero();
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t i = 0; i < vertices_.count; ++i) {
            const Vector3d start = to_eigen(vertices_.at[i]);
            const Vector3d edge = to_eigen(vertices_.at[next(vertices_, i)]) - start;
            const Vector3d there = q - start;
            if (!(edge.cross(normal_).dot(there) > 0)) continue;
            const Vector3d from = there - std::clamp(edge.dot(there) / edge.squaredNorm(), 0.0, 1.0) * edge;
            const double square = from.squaredNorm();
            if (square < least) {
                least = square;
                nearest = from;
            }
        }
        return nearest;
    }

  private:
    const Vertices& vertices_;
    Vector3d normal_;
};

bool same_place(const Polygon& a, const Polygon& b) noexcept {
    return a.vertices.count == b.vertices.count && a.velocity == b.velocity &&
           std::equal(a.vertices.at, a.vertices.at + a.vertices.count, b.vertices.at);
}

Verdict contradiction(double value, std::uint32_t reason) noexcept {
    constexpr std::uint32_t row = row_of<Polygon>("vertices");
    return {Verdict::Code::contradiction, row, value, reason};
}

}  // namespace

Verdict Describe<Polygon>::check(const Polygon& polygon) noexcept {
    const Vertices& v = polygon.vertices;
    double size = 0, coordinate = 0, nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < v.count; ++i) {
        coordinate = std::max(coordinate, to_eigen(v.at[i]).lpNorm<Eigen::Infinity>());
        for (std::uint32_t j = 0; j < i; ++j) {
            const double apart = (to_eigen(v.at[i]) - to_eigen(v.at[j])).norm();
            size = std::max(size, apart);
            nearest = std::min(nearest, apart);
        }
    }
    const double tolerance = polygon_tolerance * size + piece::rounding * coordinate + no_length;
    if (!(nearest > tolerance)) return contradiction(nearest, 1);
    const Vector3d area = area_vector(v);
    if (const double width = area.norm() / size; !(width > tolerance)) return contradiction(width, 2);
    const Vector3d normal = Distance(area).direction, middle = centre(v);
    double off = 0, beyond = 0;
    for (std::uint32_t i = 0; i < v.count; ++i) {
        const Vector3d start = to_eigen(v.at[i]);
        off = std::max(off, std::abs(normal.dot(start - middle)));
        const Vector3d outwards = (to_eigen(v.at[next(v, i)]) - start).cross(normal).normalized();
        for (std::uint32_t j = 0; j < v.count; ++j) {
            beyond = std::max(beyond, outwards.dot(to_eigen(v.at[j]) - start));
        }
    }
    if (off > tolerance) return contradiction(off, 3);
    if (beyond > tolerance) return contradiction(beyond, 4);
    return {};
}

Polygon prepared(Polygon params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    Vertices& v = params.vertices;
    v.reserved = params.reserved = 0;
    std::fill(v.at + v.count, v.at + max_vertices, Vec3{});
    // Vertices may deviate from the plane within the tolerance. Projecting them makes face and edges meet.
    const Vector3d normal = Distance(area_vector(v)).direction, middle = centre(v);
    for (std::uint32_t i = 0; i < v.count && v.count > 3; ++i) {
        const Vector3d at = to_eigen(v.at[i]);
        v.at[i] = to_plain(at - normal.dot(at - middle) * normal);
    }
    return params;
}

void adopt(const Polygon& params, const Polygon* previous, PieceState& state, const Probe&) noexcept {
    if (!previous) {
        state = {};
        place(state.motion);
    } else if (!same_place(params, *previous)) {
        piece::adopt(params, PolygonOutline(params), *previous, PolygonOutline(*previous), state);
    }
}

Contact contact(const Polygon& params, PieceState& state, const Probe& probe, double dt) noexcept {
    return piece::contact(params, PolygonOutline(params), state, probe, dt);
}

std::optional<Bound> bound(const Polygon& params, const PieceState& state) noexcept {
    if (state.touched != 0 && state.out == 0) return std::nullopt;
    Bound ball = ball_around(params.vertices);
    ball.center += state.motion.time * to_eigen(params.velocity);
    return ball;
}

void out_of_reach(const Polygon&, PieceState& state) noexcept {
    piece::forget(state);
}

}  // namespace knurl
