#include "cap.hpp"

namespace exact {

namespace {

// One curved direction, in the plane of `across` (the distance from the axis of symmetry, >= 0) and `up`: the
// signed distance from an arc of curvature a (positive: a hump) through the origin. Beyond the angle with the
// given sine the arc continues as its tangent.
struct Arc {
    Real height, up, out;  // the height and its gradient
    Real clear;
};
Arc arc(Real a, Real sine, Real across, Real up) {
    const Real cosine = std::sqrt(1 - sine * sine);
    if (a == 0) return {up, 1, 0, INFINITY};
    const Real level = 1 + a * up;  // above the centre, in radii
    if (std::fabs(a) * across * cosine <= sine * level) {
        const Real root = std::sqrt(level * level + a * a * across * across);
        // (|p - c|^2 - R^2) / (|p - c| + R): subtracts no large numbers, however flat the arc is.
        return {(2 * up + a * (up * up + across * across)) / (1 + root), level / root, a * across / root,
                root / std::fabs(a)};
    }
    const Real sign = a > 0 ? 1 : -1, over = sine / std::fabs(a), under = -sine * sine / (1 + cosine) / a;
    return {cosine * (up - under) + sign * sine * (across - over), cosine, sign * sine, across};
}

Real felt(Real curvature, Real radius) {
    return radius > 0 ? std::min(curvature, 1 / (2 * radius)) : curvature;
}

}  // namespace

Foot cap(const Cap& c, const V& probe, Real radius) {
    const V n = unit(c.normal), d = probe - c.foot;
    const Real up = dot(n, d);
    const V flat = flattened(d, n);
    const Real k1 = felt(c.curvature, radius), k2 = felt(c.curvature2, radius);
    if (length(c.axis) == 0 || c.curvature == c.curvature2) {
        const Real across = length(flat);
        const Arc one = arc(-k1, c.rim, across, up);
        const V out = across > 0 ? (1 / across) * flat : V{};
        return {unit(one.up * n + one.out * out), one.height - radius, one.clear};
    }
    // The stronger curvature is the tube's, the weaker one the ring's. The application's own values decide
    // which is stronger, and the angles of the rims.
    const V along = unit(flattened(c.axis, n)), beside = cross(n, along);
    const bool first = std::fabs(c.curvature) > std::fabs(c.curvature2);
    const Real strong = first ? k1 : k2, weak = first ? k2 : k1;
    const Real ratio = first ? std::fabs(c.curvature2 / c.curvature) : std::fabs(c.curvature / c.curvature2);
    const V tube = first ? along : beside, ring = first ? beside : along;
    const Real x = dot(tube, flat), y = dot(ring, flat);
    const Arc outer = arc(-weak, c.rim * ratio, std::fabs(y), up);
    const Arc inner = arc(-strong, c.rim, std::fabs(x), outer.height);
    const V side_y = (y < 0 ? -1 : 1) * ring, side_x = (x < 0 ? -1 : 1) * tube;
    return {unit(inner.up * (outer.up * n + outer.out * side_y) + inner.out * side_x), inner.height - radius,
            std::min(outer.clear, inner.clear)};
}

}  // namespace exact
