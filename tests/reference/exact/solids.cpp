#include "solids.hpp"

namespace exact {

namespace {

V or_across(const V& v, const V& n) {
    return length(v) > 0 ? unit(v) : across(n);
}

}  // namespace

Foot SolidTouch::nearest(const Foot& foot, Real limit) {
    const Real depth = -foot.height;
    doubt = std::min({doubt, std::fabs(depth), std::fabs(depth - limit)});
    deep = deep || depth > limit || step_ * (1 + 1e-9L) >= limit - depth;
    return foot;
}

std::vector<Foot> SolidTouch::step(const Solid& s, const V& probe, Real radius) {
    doubt = INFINITY;
    const V axis = unit(s.axis), q = probe - s.center;
    const Real z = dot(q, axis), sign = z < 0 ? -1 : 1;
    step_ = met_ ? length(q - last_) : 0;
    last_z_ = met_ ? dot(last_, axis) : z;
    last_ = q, met_ = true, deep = false;
    const V flat = flattened(q, axis);
    const Real rho = length(flat);
    const auto room = [&](Real size) {
        return std::max(Real(0), size - radius);
    };  // of a hollow; 0: the probe is held in the middle

    if (s.kind == Solid::Kind::cylinder) {
        const Real wall = rho - s.radius, end = std::fabs(z) - s.half_length;
        if (s.hollow) {
            std::vector<Foot> feet{{-or_across(flat, axis), room(s.radius) - rho, rho}};
            if (std::isfinite(s.half_length))
                feet.push_back({-sign * axis, room(s.half_length) - std::fabs(z), INFINITY});
            return feet;
        }
        Foot foot;
        if (wall > 0 && end > 0) {
            const Real out = std::sqrt(wall * wall + end * end);
            foot = {(1 / out) * (wall * unit(flat) + end * sign * axis), out - radius, out};
        } else {
            doubt = std::fabs(wall - end);
            if (wall > 0 || end > 0) doubt = std::max(std::fabs(wall), std::fabs(end));
            foot = wall >= end ? Foot{or_across(flat, axis), wall - radius, rho}
                               : Foot{sign * axis, end - radius, INFINITY};
            if (wall < end) doubt = std::min(doubt, std::fabs(z));
        }
        return {nearest(foot, radius)};
    }

    // The others are the points within a radius of a point, a line or a circle.
    V core;
    Real size = s.radius;
    std::vector<Foot> feet;
    if (s.kind == Solid::Kind::capsule) core = std::min(std::max(z, -s.half_length), s.half_length) * axis;
    const V out = or_across(flat, axis);
    if (s.kind == Solid::Kind::torus) {
        core = s.radius * out;
        size = s.tube;
    }
    const V away = q - core;
    const Real distance = length(away);
    const Real clear = s.kind == Solid::Kind::torus ? std::min(distance, rho) : distance;
    if (s.hollow) return {{-or_across(away, axis), room(size) - distance, clear}};
    const Real reach = size + radius;
    if (s.kind != Solid::Kind::torus)
        return {nearest({or_across(away, axis), distance - reach, clear}, reach / 2)};
    return {ring(s, rho, z, reach, out, axis)};
}

/// In the plane through the axis and the probe, with coordinates {outwards, along the axis}. Free space is
/// outside of the disc about (R, 0) and of its mirror image. The nearest free point is the foot on the disc,
/// or the point where the two circles meet.
Foot SolidTouch::ring(const Solid& s, Real rho, Real z, Real reach, const V& out, const V& axis) {
    const Real x = rho - s.radius, distance = length({x, z, 0}), limit = reach / 2;
    const V normal = distance > 0 ? (1 / distance) * V{x, z, 0} : V{0, 1, 0};
    Foot foot{normal, distance - reach, std::min(distance, rho)};
    bool seated = false;
    Real most = limit;
    const Real seat = reach > s.radius ? std::sqrt(reach * reach - s.radius * s.radius) : 0;
    const Real above = z < 0 ? -1 : 1;
    if (seat > 0) {
        if (seat < 1e-3L * reach) doubt = 0;  // rounding moves it by rounding * reach / seat
        const V at = V{s.radius, 0, 0} + reach * normal;
        seated = length(at + V{s.radius, 0, 0}) < reach;  // in the other disc
    }
    if (seated) {
        doubt = std::min(doubt, std::fabs(z));
        const V way{-rho, above * seat - z, 0};
        foot = {unit(way), -length(way), length(way)};
        most = length(way) * (seat / 2) / std::fabs(way.y);  // there z has half the seat's height
    }
    if (seat > 0 && last_z_ * z < 0) deep = true;  // through the hole
    nearest(foot, most);
    return {foot.normal.x * out + foot.normal.y * axis, foot.height, foot.clear};
}

}  // namespace exact
