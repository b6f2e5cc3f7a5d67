#pragma once
// Inside a solid the normal of the nearest surface reverses at the core: the centre of a sphere, the axis of
// a cylinder, the middle of a coin. A probe that is pressed past the core would be pushed out on the far
// side. So once a probe is deep (the height over the nearest surface is less than -margin), the solid keeps
// the normal of the side of entry, and holds the probe by its supporting plane with that normal at any
// depth. This also holds where the solid (a coin, a needle, a bead) is thinner than the hand sinks in.
//
//        natural            held: the plane by which it came in         beside: n turns to the natural one
//                                                                        at turn_rate, the force goes with it
//          p0   n                    n                                          n .->
//           \   |                    |                                          | /
//     .------\--|---.          .-----|----.                             .-------|'--.
//    (        p1     )        (      |     )   over: the line p + t n  (           ) |
//     '-------------'          '-----|----'    meets the solid          '---------'  p3  free once above its
//                                    p2                                              plane: height >= 0
//
// While the normal is kept, the force is that of a plane, so it is conservative. A normal that turns, turns
// towards less depth, which only removes energy. It turns slowly, so the force has no step.

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include <knurl/reps/solid.hpp>

namespace knurl {

/// The part of a contact that depends on the shape only, in the frame in which the shape keeps its normals.
struct Facing {
    Eigen::Vector3d normal;  // unit
    double height;           // m
    std::uint32_t part = 1;  // of the solid (1, 2, ...) whose normal this is
    bool held = false;       // a kept normal holds the probe
};

/// Angular rate at which a normal that is no longer kept turns to the natural one: a right angle in 31 ms.
inline constexpr double turn_rate = 50;  // rad/s

/// `from` turned towards `to` by at most that angle (rad); `to` itself, to the bit, if that suffices.
inline Eigen::Vector3d turned(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double angle) noexcept {
    if (!(angle > 0)) return from;
    const double cosine = from.dot(to);
    if (cosine >= std::cos(angle)) return to;
    const Eigen::Vector3d rest = to - cosine * from;
    const double sine = rest.norm();
    const Eigen::Vector3d side = sine > 1e-9 ? Eigen::Vector3d(rest / sine) : from.unitOrthogonal();
    return (std::cos(angle) * from + std::sin(angle) * side).normalized();
}

/// The first point of a straight path at which above(at) <= 0, by sphere tracing: each step has the length
/// above(at), since `above` changes by no more than the length of the step.
template <class Above>
std::optional<Eigen::Vector3d> where_entered(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                             double size, Above&& above) noexcept {
    constexpr int steps = 32;
    const Eigen::Vector3d way = to - from;
    const double length = way.norm();
    double gone = 0;
    for (int i = 0; i < steps; ++i) {
        const Eigen::Vector3d at = length > 0 ? Eigen::Vector3d(from + (gone / length) * way) : from;
        const double left = above(at);
        if (left <= 1e-6 * size) return at;
        gone += left;
        if (gone > length) return std::nullopt;
    }
    return std::nullopt;  // the path only grazes the surface
}

/// The normal that a solid should have where it holds a probe.
struct Aim {
    enum class Kind {
        keep,     // the present one
        face,     // of the flat or straight face through which the probe came
        natural,  // of the nearest surface: the solid lets go
    };
    Kind kind;
    Eigen::Vector3d normal;
};

/// A solid that is solved with other surfaces has the normal at their common point (hold.joint), so that the
/// force has no step when the solid takes hold or lets go. `alone` becomes the normal at its own foot, for
/// harder layers in which it holds alone. One normal for both would increase the depth in one of them at each
/// taking of hold, which gives the hand energy.
inline void lean(Facing& facing, const SolidHold& hold, Vec3& alone) noexcept {
    if (hold.joint == Vec3{}) return;
    if (std::isfinite(hold.met_below)) alone = to_plain(facing.normal);
    facing.normal = to_eigen(hold.joint);
}

/// Notes the normal with which the solid met other surfaces in a layer of the stiffness `below` (N/m;
/// infinity: no harder layer has the solid). Later calls are for harder layers. While the solid keeps two
/// normals, harder layers do not change `joint`.
inline void meet(SolidHold& hold, const Eigen::Vector3d& normal, double below) noexcept {
    if (!(hold.alone == Vec3{})) {
        if (below > hold.met_below) return;
    } else {
        hold.met_below = below;
    }
    hold.joint = to_plain(normal);
}

/// For a solid that does not hold the probe yet. True: it takes hold, and `by` becomes its facing.
template <class Solid>
bool takes_hold(Solid& solid, const Eigen::Vector3d& q, const Facing& natural, const SolidHold& hold,
                double dt, Facing& by, Vec3& alone) noexcept {
    const double above = natural.height + solid.margin;
    if (dt > 0 && hold.met != 0) {
        const Eigen::Vector3d last = to_eigen(hold.last);
        const bool may_have = above < 0 || above * above <= (q - last).squaredNorm();
        if (may_have && q.squaredNorm() <= solid.ball() * solid.ball()) {
            if (std::optional<Facing> entry = solid.entered(last, q, hold)) {
                lean(*entry, hold, alone);
                // A path that cuts a corner and leaves again has touched nothing.
                const bool holds =
                    above < 0 || solid.aim(q, entry->normal, entry->part, natural).kind != Aim::Kind::natural;
                if (holds) {
                    by = *entry;
                } else {
                    alone = Vec3{};
                }
                return holds;
            }
        }
    }
    if (!(above < 0)) return false;
    by = natural;
    lean(by, hold, alone);
    return true;
}

/// Turns the normal `alone` (see lean) towards its aim. True: it has arrived.
template <class Solid>
bool turn_alone(const Solid& solid, const Eigen::Vector3d& q, const Facing& natural, std::uint32_t part,
                double angle, Vec3& alone) noexcept {
    const Eigen::Vector3d normal = to_eigen(alone);
    const Aim aim = solid.aim(q, normal, part, natural);
    if (aim.kind == Aim::Kind::keep) return false;
    const Eigen::Vector3d next = turned(normal, aim.normal, angle);
    alone = to_plain(next);
    return next == aim.normal;
}

/// The contact of a solid at q (m, from its middle). A solid, enlarged by the probe's radius, offers
///
///   margin                     m, the depth down to which the natural contact counts
///   ball()                     m, radius about the middle: a path that ends outside has led past the solid
///   entered(last, q, hold)     the facing through which a path entered deeply, if it did
///   aim(q, normal, part, natural)
///   over(q, normal, part)      m, height over the plane that supports it in that direction
///
/// `natural` is the contact of the nearest surface. An evaluation with dt = 0 does not change `hold`.
template <class Solid>
// NOLINTNEXTLINE(readability-function-cognitive-complexity): in the cycle, a split cost 1 %
Facing facing_of(Solid& solid, const Eigen::Vector3d& q, const Facing& natural, SolidHold& hold,
                 double dt) noexcept {
    Facing now = natural;
    std::uint32_t part = hold.part;
    bool turning = hold.turning != 0;
    Vec3 alone = hold.alone;
    if (part == 0 && takes_hold(solid, q, natural, hold, dt, now, alone)) {
        part = now.part;
        turning = true;
    }
    if (part != 0) {
        Eigen::Vector3d normal = hold.part != 0 ? to_eigen(hold.normal) : now.normal;
        Aim aim = solid.aim(q, normal, part, natural);
        if (!(hold.joint == Vec3{})) {
            if (turning) aim.normal = to_eigen(hold.joint);
            if (aim.kind == Aim::Kind::keep && !turning) {
                if (std::isfinite(hold.met_below)) alone = to_plain(normal);
                normal = to_eigen(hold.joint);
            }
        }
        if (aim.kind == Aim::Kind::keep) {
            turning = true;
        } else if (aim.kind == Aim::Kind::face && !turning) {
            normal = aim.normal;
        } else {
            normal = turned(normal, aim.normal, turn_rate * dt);
            turning = normal != aim.normal;
        }
        if (!(alone == Vec3{})) {
            turning = !turn_alone(solid, q, natural, part, turn_rate * dt, alone) || turning;
            if (!turning) alone = Vec3{};
        }
        if (!turning && aim.kind == Aim::Kind::natural) part = 0;
        now = {normal, solid.over(q, normal, part), part, true};
        if (part == 0 || now.height >= 0) {
            part = 0;
            now = natural;
        }
    }
    if (dt > 0) {
        hold.normal = now.height < 0 ? to_plain(now.normal) : Vec3{};
        hold.joint = Vec3{};
        hold.alone = part != 0 ? alone : Vec3{};
        hold.last = to_plain(q);
        hold.part = part;
        hold.turning = turning && part != 0;
        hold.met = 1;
    }
    return now;
}

/// The plane by which the solid holds alone in layers of that stiffness (N/m). False: it is the contact's.
template <class Solid>
bool plane_alone(const Solid& solid, const Eigen::Vector3d& q, const SolidHold& hold, double stiffness,
                 CurvedContact& out) noexcept {
    if (hold.alone == Vec3{} || !(stiffness > hold.met_below)) return false;
    const Eigen::Vector3d normal = to_eigen(hold.alone);
    out = {.normal = normal, .height = solid.over(q, normal, hold.part)};
    return true;
}

/// The unit vector along v, whose length is given. On the core v has no direction: then it is the last
/// cycle's, or a fixed one across `axis` if that is 0 0 0.
inline Eigen::Vector3d direction_or(const Eigen::Vector3d& v, double length, const Vec3& last,
                                    const Eigen::Vector3d& axis) noexcept {
    if (length > 1e-100) return v / length;
    return last == Vec3{} ? axis.unitOrthogonal() : to_eigen(last);
}

}  // namespace knurl
