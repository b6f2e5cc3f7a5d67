#pragma once
// Inside a solid the normal of the nearest surface turns round at its core: the centre of a sphere, the axis
// of a cylinder, the middle of a plate. A probe that is pressed through would be thrown out on the other
// side. So from half way to the core on
//
//   the contact is the tangent plane of where it got that deep,
//   height = max(height over that plane, -limit),
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
    std::uint32_t part = 1;  // of the solid (1, 2, ...) whose normal this is
};

/// `natural` by the nearest surface; `limit` (m) half way to the core there; over(normal, part) the height
/// over the tangent plane of that part that faces that way, but not below that plane's -limit. All for the
/// solid as large as the probe makes it. Time that does not pass (dt = 0) leaves no trace in `core`.
template <class Over>
Facing guarded_part(const Facing& natural, double limit, Core& core, double dt, Over&& over) noexcept {
    Eigen::Vector3d kept = to_eigen(core.normal);
    std::uint32_t deep = natural.height < 0 ? core.deep : 0;
    if (deep == 0 && natural.height < -limit) {
        deep = natural.part;
        kept = natural.normal;
    }
    const Facing now = deep != 0 ? Facing{kept, over(kept, deep), deep} : natural;
    if (dt > 0) {
        // Out of contact nothing is remembered, so a surface that was not asked there answers the same.
        core.normal = natural.height < 0 ? to_plain(now.normal) : Vec3{};
        core.deep = deep;
    }
    return now;
}

/// A solid of one part.
template <class Over>
Facing guarded(const Facing& natural, double limit, Core& core, double dt, Over&& over) noexcept {
    return guarded_part(natural, limit, core, dt, [&](const Eigen::Vector3d& normal, std::uint32_t) {
        return std::max(over(normal), -limit);
    });
}

/// A direction. On the core there is none: last cycle's then, and where that is none (0 0 0) a fixed one
/// across `axis`.
inline Eigen::Vector3d direction_or(const Eigen::Vector3d& v, double length, const Vec3& last,
                                    const Eigen::Vector3d& axis) noexcept {
    if (length > 1e-100) return v / length;
    return last == Vec3{} ? axis.unitOrthogonal() : to_eigen(last);
}

}  // namespace knurl
