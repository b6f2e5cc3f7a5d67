#pragma once
// Inside a solid the normal of the nearest surface turns round at its core: the centre of a sphere, the axis
// of a cylinder, the middle of a plate. A probe that is pressed through would be thrown out on the other
// side. So from half way to the core on
//
//   the contact is the tangent plane of where it got that deep,  height = max(height over that plane,
//   -limit),
//
// until the probe is out of the solid or over that plane. Entering is continuous, and leaving never gives
// back more than was put in: the plane's depth is then 0 (back the same way), or what is left of it is lost
// (out elsewhere).

#include <algorithm>

#include <knurl/reps/solid.hpp>

namespace knurl {

/// What a shape alone decides of its contact, in whatever frame it keeps its normals in.
struct Facing {
    Eigen::Vector3d normal;  // unit
    double height;           // m
};

/// `natural` by the nearest surface; `limit` (m) half way to the core, both for the solid as large as the
/// probe makes it; over(normal) the height over the solid's tangent plane that faces that way. Time that does
/// not pass (dt = 0) leaves no trace in `core`.
template <class Over>
Facing guarded(const Facing& natural, double limit, Core& core, double dt, Over&& over) noexcept {
    Eigen::Vector3d kept = to_eigen(core.normal);
    bool deep = core.deep != 0 && natural.height < 0;
    if (!deep && natural.height < -limit) {
        deep = true;
        kept = natural.normal;
    }
    const Facing now = deep ? Facing{kept, std::max(over(kept), -limit)} : natural;
    if (dt > 0) {
        // Out of contact nothing is remembered, so a surface that was not asked there answers the same.
        core.normal = natural.height < 0 ? to_plain(now.normal) : Vec3{};
        core.deep = deep;
    }
    return now;
}

/// A direction. On the core there is none: last cycle's then, and where that is none (0 0 0) a fixed one
/// across `axis`.
inline Eigen::Vector3d direction_or(const Eigen::Vector3d& v, double length, const Vec3& last,
                                    const Eigen::Vector3d& axis) noexcept {
    if (length > 1e-100) return v / length;
    return last == Vec3{} ? axis.unitOrthogonal() : to_eigen(last);
}

}  // namespace knurl
