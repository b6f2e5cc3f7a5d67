#pragma once
// Random curved and flat surfaces about one place, and the point nearest to the hand that satisfies all of
// them. Computed in long double, from separate signed distances, by trying every set of up to three surfaces.
// Shares only the parameters with reps/.

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <knurl/reps/all.hpp>

#include "../reference/parameters.hpp"
#include "shape_tools.hpp"

namespace knurl::test {

/// A signed distance and its gradient.
struct Distances {
    std::function<exact::Foot(const exact::V&)> foot;
    Real height(const RealVector& x) const { return foot({x.x(), x.y(), x.z()}).height; }
    RealVector normal(const RealVector& x) const {
        const exact::V n = foot({x.x(), x.y(), x.z()}).normal;
        return {n.x, n.y, n.z};
    }
};

inline Distances distances_of(const Plane& s) {
    const exact::V n = exact::unit(exact::real(s.normal));
    const Real offset = s.offset / exact::length(exact::real(s.normal));
    return {[=](const exact::V& x) { return exact::Foot{n, exact::dot(n, x) - offset}; }};
}
inline Distances distances_of(const Cap& s) {
    const exact::Cap cap{exact::real(s.foot), exact::real(s.normal), s.curvature, s.curvature, {}, s.rim};
    return {[=](const exact::V& x) { return exact::cap(cap, x, 0); }};
}
template <class R>
Distances distances_of(const R& s) {
    return {[=, solid = exact::solid_of(s)](const exact::V& x) {
        return exact::SolidTouch().step(solid, x, 0)[0];
    }};
}

struct Met {
    RealVector x;
    int active = 0;
};

/// Newton's method on the conditions of Karush, Kuhn and Tucker, with all of `set` active, starting from the
/// result of successive projections. Nothing where it converges elsewhere, or a surface would pull.
inline std::optional<RealVector> held_by(const std::vector<Distances>& all,
                                         const std::vector<std::size_t>& set, const RealVector& p,
                                         Real size) {
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
    using Column = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
    RealVector x = p;
    for (int i = 0; i < 60; ++i) {
        const Distances& s = all[set[static_cast<std::size_t>(i) % set.size()]];
        x -= s.height(x) * s.normal(x);
    }
    const auto m = static_cast<Eigen::Index>(set.size());
    Matrix normals(3, m);
    for (Eigen::Index j = 0; j < m; ++j) normals.col(j) = all[set[static_cast<std::size_t>(j)]].normal(x);
    Column u = normals.fullPivLu().solve(Column(x - p));
    Real length = 1;
    for (int i = 0; i < 40 && length > 1e-17L; ++i) {
        Matrix system = Matrix::Zero(3 + m, 3 + m);
        Column wrong(3 + m);
        wrong.head(3) = x - p;
        system.topLeftCorner(3, 3).setIdentity();
        for (Eigen::Index j = 0; j < m; ++j) {
            const Distances& s = all[set[static_cast<std::size_t>(j)]];
            const RealVector n = s.normal(x);
            wrong.head(3) -= u[j] * n;
            wrong[3 + j] = -s.height(x);
            system.block(0, 3 + j, 3, 1) = -n;
            system.block(3 + j, 0, 1, 3) = n.transpose();
            constexpr Real h = 1e-6L;  // m: of the differences, whose error only slows convergence
            for (int axis = 0; axis < 3; ++axis) {
                const RealVector e = h * RealVector::Unit(axis);
                system.block(0, axis, 3, 1) -= u[j] * (s.normal(x + e) - s.normal(x - e)) / (2 * h);
            }
        }
        wrong.head(3) *= -1;
        const Column step = system.fullPivLu().solve(wrong);
        x += step.head(3);
        u += step.tail(m);
        length = step.head(3).norm();
        if (!(length < size)) return std::nullopt;
    }
    if (length > 1e-15L || (m > 0 && u.minCoeff() < -1e-15L)) return std::nullopt;
    for (const Distances& s : all) {
        if (s.height(x) < -1e-14L) return std::nullopt;
    }
    return x;
}

inline std::optional<Met> nearest_of(const std::vector<Distances>& all, const RealVector& p, Real size) {
    bool free = true;
    for (const Distances& s : all) free = free && s.height(p) >= 0;
    if (free) return Met{p, 0};
    std::optional<Met> best;
    const auto consider = [&](std::vector<std::size_t> set) {
        const std::optional<RealVector> x = held_by(all, set, p, size);
        if (x && (!best || (*x - p).norm() < (best->x - p).norm())) best = {*x, static_cast<int>(set.size())};
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
        consider({i});
        for (std::size_t j = i + 1; j < all.size(); ++j) {
            consider({i, j});
            for (std::size_t k = j + 1; k < all.size(); ++k) consider({i, j, k});
        }
    }
    return best;
}

/// Adds a random surface to the scene that passes the origin within `near` (m), with room above it, from
/// `least` to `most` in size. Flat pieces have the same size.
inline Distances add_near_origin(Rng& rng, Scene& scene, std::uint32_t i, double near, double k, double least,
                                 double most) {
    Vector n;
    do n = direction(rng);
    while (n.z() < 0.4);
    const Vector foot = near * uniform(rng, 0, 1) * direction(rng);
    const double r = scale(rng, least, most);
    const Vector along = n.cross(direction(rng)).normalized();
    const bool inside = between(rng, 0, 3) == 0;
    const Side side = inside ? Side::inside : Side::outside;
    const Vec3 center = to_plain(Vector(foot + (inside ? r : -r) * n));
    const auto add = [&](const auto& s) {
        EXPECT_TRUE(scene.add({i, 1}, s));
        return distances_of(s);
    };
    switch (between(rng, 0, 6)) {
        case 0:
            return add(Sphere{.center = center, .radius = r, .side = side, .stiffness = k});
        case 1:
            return add(Capsule{.center = to_plain(Vector(to_eigen(center) + uniform(rng, -1, 1) * r * along)),
                               .axis = to_plain(along),
                               .half_length = r,
                               .radius = r,
                               .side = side,
                               .stiffness = k});
        case 2:
            return add(Cylinder{.center = center,
                                .axis = to_plain(along),
                                .radius = r,
                                .half_length = infinity,
                                .side = side,
                                .stiffness = k});
        case 3: {  // from outside, or from within the hole
            const double ring = r * uniform(rng, 1.5, 3), turn = uniform(rng, -3, 3);
            const Vector third = n.cross(along);
            const Vector radial = std::cos(turn) * n + std::sin(turn) * third;
            const Vector axis = std::sin(turn) * n - std::cos(turn) * third;
            return add(Torus{.center = to_plain(Vector(to_eigen(center) - ring * radial)),
                             .axis = to_plain(axis),
                             .radius = ring,
                             .tube = r,
                             .side = side,
                             .stiffness = k});
        }
        case 4:
            return add(Cap{.foot = to_plain(foot),
                           .normal = to_plain(n),
                           .curvature = (inside ? 1 : -1) / r,
                           .rim = 0.5,
                           .stiffness = k});
        case 5: {  // flat kinds, as a plane
            const Plane plane{.normal = to_plain(n), .offset = n.dot(foot), .stiffness = k};
            const Vector across = n.cross(along);
            const int which = between(rng, 0, 3);
            if (which == 0) return add(plane);
            if (which == 1) {
                Polygon polygon{.stiffness = k};
                polygon.vertices.count = 4;
                for (std::uint32_t c = 0; c < 4; ++c)
                    polygon.vertices.at[c] =
                        to_plain(Vector(foot + (c == 0 || c == 3 ? 1 : -1) * most * along +
                                        (c < 2 ? 1 : -1) * most * across));
                EXPECT_TRUE(scene.add({i, 1}, polygon));
            } else if (which == 2) {
                EXPECT_TRUE(scene.add({i, 1}, HalfPlane{.normal = to_plain(n),
                                                        .offset = n.dot(foot),
                                                        .edge = to_plain(along),
                                                        .edge_offset = along.dot(foot) + most,
                                                        .stiffness = k}));
            } else {
                Eigen::Matrix3d axes;
                axes << along, across, n;
                EXPECT_TRUE(scene.add({i, 1}, Box{.center = to_plain(Vector(foot - most * n)),
                                                  .orientation = to_plain(Eigen::Quaterniond(axes)),
                                                  .half_size = {most, most, most},
                                                  .stiffness = k}));
            }
            return distances_of(plane);
        }
        default:
            return add(Plane{.normal = to_plain(n), .offset = n.dot(foot), .stiffness = k});
    }
}

}  // namespace knurl::test
