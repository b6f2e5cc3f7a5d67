#pragma once
// Surfaces as applications have them: nearest points, as from any geometry kernel.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "closed_loop.hpp"

namespace models {

using namespace knurl;
using Eigen::Vector3d;

/// A plate of infinite width, its upper face at z = 0.
inline SurfaceModel plate(double thickness) {
    return [=](const Vec3& q) -> SurfacePoint {
        if (q.z > -thickness / 2) return {.foot = {q.x, q.y, 0}, .normal = {0, 0, 1}};
        return {.foot = {q.x, q.y, -thickness}, .normal = {0, 0, -1}};
    };
}

/// A hollow cylinder along y with a wall of that thickness; outside at z = 0 for x = 0.
inline SurfaceModel shell(double radius, double thickness) {
    return [=](const Vec3& q) -> SurfacePoint {
        const Vector3d centre(0, q.y, -radius);
        const Vector3d out = (to_eigen(q) - centre).normalized();
        const bool inner = (to_eigen(q) - centre).norm() < radius - thickness / 2;
        return {.foot = to_plain(centre + (inner ? radius - thickness : radius) * out),
                .normal = to_plain(inner ? Vector3d(-out) : out),
                .curvature = inner ? 1 / (radius - thickness) : -1 / radius,
                .axis = {out.z(), 0, -out.x()}};
    };
}

/// A table that ends at x = 0: solid where x < 0 and z < 0.
inline SurfacePoint table(const Vec3& q) {
    if (q.x < 0 && q.z < 0)
        return q.z > q.x ? SurfacePoint{.foot = {q.x, q.y, 0}, .normal = {0, 0, 1}}
                         : SurfacePoint{.foot = {0, q.y, q.z}, .normal = {1, 0, 0}};
    const Vector3d foot(std::min(q.x, 0.0), q.y, std::min(q.z, 0.0));
    const Vector3d away = to_eigen(q) - foot;
    return {.foot = to_plain(foot),
            .normal = away.norm() > 1e-9 ? to_plain(away.normalized()) : Vec3{0, 0, 1}};
}

/// z = a sin(2 pi x / wave), its nearest point by Newton from above.
inline SurfaceModel relief(double amplitude, double wave) {
    return [=](const Vec3& q) -> SurfacePoint {
        const double w = 2 * std::numbers::pi / wave;
        double x = q.x;
        for (int i = 0; i < 30; ++i) {
            const double z = amplitude * std::sin(w * x), slope = amplitude * w * std::cos(w * x);
            const double gradient = (x - q.x) + (z - q.z) * slope;
            const double bend = 1 + slope * slope - (z - q.z) * amplitude * w * w * std::sin(w * x);
            x -= gradient / std::max(bend, 0.5);
        }
        const double z = amplitude * std::sin(w * x), slope = amplitude * w * std::cos(w * x);
        return {.foot = {x, q.y, z},
                .normal = {-slope, 0, 1},
                .curvature = -w * w * z / std::pow(1 + slope * slope, 1.5),
                .axis = {1, 0, slope}};
    };
}

inline SurfaceModel without_curvature(SurfaceModel model) {
    return [=](const Vec3& q) {
        const SurfacePoint point = model(q);
        return SurfacePoint{.foot = point.foot, .normal = point.normal};
    };
}

struct Wall {
    Vector3d normal;  // unit
    double offset = 0;
    double height(const Vector3d& p) const { return normal.dot(p) - offset; }
};
using Walls = std::vector<Wall>;

/// The point nearest to p in front of all walls, by trying every set of walls that may hold it.
inline Vector3d nearest_free(const Walls& walls, const Vector3d& p) {
    const auto free = [&](const Vector3d& x) {
        return std::all_of(walls.begin(), walls.end(), [&](const Wall& w) { return w.height(x) > -1e-9; });
    };
    if (free(p)) return p;
    Vector3d best = p;
    double distance = std::numeric_limits<double>::infinity();
    for (unsigned set = 1; set < 1u << walls.size(); ++set) {
        Eigen::MatrixXd normals(0, 3);
        Eigen::VectorXd depths;
        for (std::size_t i = 0; i < walls.size(); ++i) {
            if ((set >> i & 1) == 0) continue;
            normals.conservativeResize(normals.rows() + 1, 3);
            depths.conservativeResize(normals.rows());
            normals.bottomRows(1) = walls[i].normal.transpose();
            depths[normals.rows() - 1] = -walls[i].height(p);
        }
        if (normals.rows() > 3) continue;
        const Vector3d x = p + normals.completeOrthogonalDecomposition().solve(depths);
        if (free(x) && (x - p).norm() < distance) distance = (x - p).norm(), best = x;
    }
    return best;
}

/// The answer for a hand that is behind several walls at once.
enum class Behind { edge, deepest, shallowest };

/// A room between walls that meet in concave corners.
inline SurfaceModel room(const Walls& walls, Behind behind) {
    return [=](const Vec3& q) -> SurfacePoint {
        const Vector3d p = to_eigen(q);
        const Vector3d x = nearest_free(walls, p);
        const bool inside = (x - p).norm() > 1e-9;
        if (inside && behind == Behind::edge)
            return {.foot = to_plain(x), .normal = to_plain((x - p).normalized())};
        const Wall* chosen = nullptr;
        for (const Wall& wall : walls) {
            if (inside && behind == Behind::shallowest && wall.height(p) >= 0) continue;
            const bool nearer = chosen != nullptr &&
                                (inside && behind == Behind::shallowest ? wall.height(p) > chosen->height(p)
                                                                        : wall.height(p) < chosen->height(p));
            if (chosen == nullptr || nearer) chosen = &wall;
        }
        return {.foot = to_plain(p - chosen->height(p) * chosen->normal), .normal = to_plain(chosen->normal)};
    };
}

/// A floor at z = 0 and a wall that it meets at x = 0, open by that angle towards x < 0.
inline Walls floor_and_wall(double opening) {
    return {{{0, 0, 1}, 0}, {{-std::sin(opening), 0, -std::cos(opening)}, 0}};
}

}  // namespace models
