#include "solids.hpp"

namespace exact {

namespace {

V or_across(const V& v, const V& n) {
    return length(v) > 0 ? unit(v) : across(n);
}

}  // namespace

/// From half way to the core on the contact is the tangent plane of where it got that deep, no deeper than
/// that, until the probe is out.
template <class Over>
Foot SolidTouch::guarded(const Foot& foot, Real core, Over&& over) {
    const Real limit = core / 2, depth = -foot.height;
    doubt = std::min({doubt, std::fabs(depth), std::fabs(depth - limit)});
    bool deep = deep_ && depth > 0;
    V kept = normal_;
    Real clear = clear_;
    if (!deep && depth > limit) deep = true, kept = foot.normal, clear = foot.clear;
    deep_ = deep, normal_ = kept, clear_ = clear;
    return deep ? Foot{kept, std::max(over(kept), -limit), clear} : foot;
}

std::vector<Foot> SolidTouch::step(const Solid& s, const V& probe, Real radius) {
    doubt = INFINITY;
    const V axis = unit(s.axis), q = probe - s.center;
    const Real z = dot(q, axis), sign = z < 0 ? -1 : 1;
    const V flat = flattened(q, axis);
    const Real rho = length(flat);
    const auto room = [&](Real size) {
        return std::max(Real(0), size - radius);
    };  // of a hollow; none: held in its middle

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
        // The plane that supports the solid on that side.
        return {guarded(foot, std::min(s.radius, s.half_length) + radius, [&](const V& n) {
            const Real ends = std::isfinite(s.half_length) ? s.half_length * std::fabs(dot(n, axis)) : 0;
            return dot(n, q) - s.radius * length(cross(n, axis)) - ends - radius;
        })};
    }

    // The others are balls about the nearest point of a point, a line or a circle.
    V nearest;
    Real size = s.radius;
    std::vector<Foot> feet;
    if (s.kind == Solid::Kind::capsule) nearest = std::min(std::max(z, -s.half_length), s.half_length) * axis;
    const V out = or_across(flat, axis);
    if (s.kind == Solid::Kind::torus) {
        nearest = s.radius * out;
        size = s.tube;
    }
    const V away = q - nearest;
    const Real distance = length(away);
    const Real clear = s.kind == Solid::Kind::torus ? std::min(distance, rho) : distance;
    if (s.hollow) return {{-or_across(away, axis), room(size) - distance, clear}};
    const Real reach = size + radius;
    if (s.kind != Solid::Kind::torus) {
        return {guarded({or_across(away, axis), distance - reach, clear}, reach, [&](const V& n) {
            return dot(n, q) - s.half_length * std::fabs(dot(n, axis)) - reach;
        })};
    }
    return {ring(s, rho, z, reach, out, axis)};
}

/// In the plane through the axis and the probe: {outwards, along the axis}. Free is what lies outside of the
/// disc about (R, 0) and of its mirror image; the nearest free point is the foot on the disc, or where the
/// two circles meet.
Foot SolidTouch::ring(const Solid& s, Real rho, Real z, Real reach, const V& out, const V& axis) {
    const Real x = rho - s.radius, distance = length({x, z, 0}), limit = reach / 2;
    const V normal = distance > 0 ? (1 / distance) * V{x, z, 0} : V{0, 1, 0};
    Foot foot{normal, distance - reach, std::min(distance, rho)};
    bool seated = false;
    Real most = limit;
    const Real seat = reach > s.radius ? std::sqrt(reach * reach - s.radius * s.radius) : 0;
    const Real above = z < 0 ? -1 : 1;
    if (seat > 0) {
        if (seat < 1e-3L * reach) doubt = 0;  // it moves by rounding / this share
        const V at = V{s.radius, 0, 0} + reach * normal;
        seated = length(at + V{s.radius, 0, 0}) < reach;  // in the other disc
    }
    if (seated) {
        doubt = std::min(doubt, std::fabs(z));
        const V way{-rho, above * seat - z, 0};
        foot = {unit(way), -length(way), length(way)};
        most = length(way) * (seat / 2) / std::fabs(way.y);  // there z has half the seat's height
    }
    const Real depth = -foot.height;
    doubt = std::min({doubt, std::fabs(depth), std::fabs(depth - most)});
    const V world = foot.normal.x * out + foot.normal.y * axis;
    deep_ = deep_ && depth > 0;
    if (!deep_ && depth > most) {
        deep_ = true, on_seat_ = seated, clear_ = foot.clear;
        normal_ = seated ? world : foot.normal;
    }
    if (!deep_) return {world, foot.height, foot.clear};
    if (on_seat_) {  // stands still in the world, since near the axis the section turns at once
        const Real rises = dot(normal_, axis), side = rises < 0 ? -1 : 1;
        const Real height = rho * dot(normal_, out) + rises * (z - side * seat);
        return {normal_, std::max(height, -seat / (2 * std::fabs(rises))), clear_};
    }
    const Real height = normal_.x * x + normal_.y * z - reach;
    return {normal_.x * out + normal_.y * axis, std::max(height, -limit), std::min(clear_, rho)};
}

}  // namespace exact
