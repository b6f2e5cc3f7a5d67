// Points nearer than `touch` are merged, in this order: vertex at vertex, vertex at edge, edge at edge,
// vertex at face, edge through face. So each test depends on lengths far larger than rounding.

#include "meeting.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace knurl::build {
namespace {

using Eigen::Vector3d;
using Kind = Meeting::Kind;

/// All corners are in front of the other's plane, or all behind it.
bool clear(const double (&height)[3], double touch) {
    return (height[0] > touch && height[1] > touch && height[2] > touch) ||
           (height[0] < -touch && height[1] < -touch && height[2] < -touch);
}
/// All corners lie in the other's plane.
bool level(const double (&height)[3], double touch) {
    return std::max({std::abs(height[0]), std::abs(height[1]), std::abs(height[2])}) <= 2 * touch;
}
Meeting vertex_at_vertex(const Triangle& s, const Vector3d (&p)[3], const Triangle& t, const Vector3d (&q)[3],
                         double touch) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (has(t, s[i])) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            if (!has(s, t[k]) && (p[i] - q[k]).squaredNorm() <= touch * touch / 16)
                return {.kind = Kind::vertices, .a = s[i], .b = t[k]};
        }
    }
    return {};
}
Meeting vertex_on_edge(const Triangle& s, const Vector3d (&p)[3], const Triangle& t, const Vector3d (&q)[3],
                       double touch, const Splits& splits) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (has(t, s[i])) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t k2 = (k + 1) % 3;
            const Vector3d side = q[k2] - q[k], from = p[i] - q[k];
            const double length = side.squaredNorm(), along = side.dot(from);
            if (!(along > 0 && along < length)) continue;
            if ((from - side * (along / length)).squaredNorm() <= touch * touch &&
                !splits.contains(split_of(s[i], t[k], t[k2])))
                return {.kind = Kind::vertex_edge, .a = s[i], .b = t[k], .c = t[k2]};
        }
    }
    return {};
}
bool edges_meet(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d, double touch,
                Vector3d& x) {
    const Vector3d u = b - a, v = d - c, w = c - a;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
    const double sine = uu * vv - uv * uv;
    if (!(sine > 1e-14 * uu * vv)) return false;  // parallel: their ends decide
    const double i = (u.dot(w) * vv - v.dot(w) * uv) / sine, k = (u.dot(w) * uv - v.dot(w) * uu) / sine;
    if (!(i > 0 && i < 1 && k > 0 && k < 1)) return false;
    const Vector3d on = a + u * i, other = c + v * k;
    x = (on + other) / 2;
    return (on - other).squaredNorm() <= touch * touch;
}
/// `may_cross(i, k)`: whether edge i of s and edge k of t do count.
template <class MayCross>
Meeting edge_at_edge(const Triangle& s, const Vector3d (&p)[3], const Triangle& t, const Vector3d (&q)[3],
                     double touch, MayCross&& may_cross) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i2 = (i + 1) % 3, k2 = (k + 1) % 3;
            if (s[i] == t[k] || s[i] == t[k2] || s[i2] == t[k] || s[i2] == t[k2]) continue;
            if (!may_cross(i, k)) continue;
            Vector3d x;
            if (!edges_meet(p[i], p[i2], q[k], q[k2], touch, x)) continue;
            return {.kind = Kind::edges, .a = s[i], .b = s[i2], .c = t[k], .d = t[k2], .at = x};
        }
    }
    return {};
}
bool within(const Vector3d& x, const Vector3d (&q)[3], const Vector3d& normal) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(normal.dot((q[(i + 1) % 3] - q[i]).cross(x - q[i])) > 0)) return false;
    }
    return true;
}
Meeting pierced(const Triangle& s, const Vector3d (&p)[3], const double (&height)[3], const Triangle& t,
                const Vector3d (&q)[3], const Vector3d& normal, int whose, double touch) {
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = (i + 1) % 3;
        if (has(t, s[i]) || has(t, s[k])) continue;
        const double low = std::min(height[i], height[k]), high = std::max(height[i], height[k]);
        if (!(low < -touch && high > touch)) continue;
        const Vector3d x = p[i] + (p[k] - p[i]) * (height[i] / (height[i] - height[k]));
        if (within(x, q, normal))
            return {.kind = Kind::edge_face, .a = s[i], .b = s[k], .whose = whose, .at = x};
    }
    return {};
}

}  // namespace

Meeting meet(const Triangle& s, const Vector3d (&p)[3], std::uint32_t s_flat, const Triangle& t,
             const Vector3d (&q)[3], std::uint32_t t_flat, double touch, const Splits& splits) {
    const Vector3d p_normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized(),
                   q_normal = (q[1] - q[0]).cross(q[2] - q[0]).normalized();
    double p_height[3], q_height[3];
    for (int i = 0; i < 3; ++i) {
        p_height[i] = q_normal.dot(p[i] - q[0]);
        q_height[i] = p_normal.dot(q[i] - p[0]);
    }
    // Corners that stay separate are farther apart than the distance at which they lie on an edge. So they
    // are in order there.
    const double on = touch / 2;
    if (clear(p_height, touch) || clear(q_height, touch)) return {};
    if (const Meeting m = vertex_at_vertex(s, p, t, q, touch); m.kind != Kind::none) return m;
    if (const Meeting m = vertex_on_edge(s, p, t, q, on, splits); m.kind != Kind::none) return m;
    if (const Meeting m = vertex_on_edge(t, q, s, p, on, splits); m.kind != Kind::none) return m;
    const bool one_plane = level(p_height, touch) || level(q_height, touch);
    const auto may_cross = [&](std::size_t i, std::size_t k) {
        return !(one_plane && (s_flat >> i & 1) != 0 && (t_flat >> k & 1) != 0);
    };
    if (const Meeting m = edge_at_edge(s, p, t, q, on, may_cross); m.kind != Kind::none) return m;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!has(t, s[i]) && std::abs(p_height[i]) <= on && within(p[i], q, q_normal))
            return {.kind = Kind::vertex_face, .a = s[i], .whose = 1};
        if (!has(s, t[i]) && std::abs(q_height[i]) <= on && within(q[i], p, p_normal))
            return {.kind = Kind::vertex_face, .a = t[i], .whose = 0};
    }
    if (const Meeting m = pierced(s, p, p_height, t, q, q_normal, 1, on); m.kind != Kind::none) return m;
    return pierced(t, q, q_height, s, p, p_normal, 0, on);
}

bool meet(const Faces& faces, std::uint32_t f, std::uint32_t g, bool across, double touch) {
    const auto at = [&](std::uint32_t v) { return Vector3d(faces.at[v].data()); };
    const Triangle &s = faces.corners[f], &t = faces.corners[g];
    const Meeting m =
        meet(s, {at(s[0]), at(s[1]), at(s[2])}, 0, t, {at(t[0]), at(t[1]), at(t[2])}, 0, touch, {});
    return across ? m.kind == Kind::edges || m.kind == Kind::edge_face : m.kind != Kind::none;
}

}  // namespace knurl::build
