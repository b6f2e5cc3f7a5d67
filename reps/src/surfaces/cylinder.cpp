#include <algorithm>
#include <cmath>

#include <knurl/reps/cylinder.hpp>

#include "surfaces/bend.hpp"
#include "surfaces/solid.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// Where the probe is: along the axis and away from it.
struct Place {
    Vector3d axis, out;
    double along, away;

    Place(const Vector3d& along_axis, const Vector3d& q, const Vec3& last) noexcept
        : axis(along_axis), along(axis.dot(q)) {
        const Vector3d lateral = across(q, axis);
        away = lateral.norm();
        out = direction_or(lateral, away, last, axis);
    }
    Vector3d to_end() const noexcept { return std::copysign(1.0, along) * axis; }
};

constexpr std::uint32_t wall_part = 1, front_part = 2,
                        back_part = 3;  // the ends: along the axis, and against it

// While the probe's centre is inside, the face through which it came in holds it, as with a box. The wall's
// normal turns with the probe, down to half the radius.
struct SolidCylinder {
    Vector3d axis;
    double radius, half_length, probe;
    double margin = probe;

    double ball() const noexcept { return std::hypot(radius, half_length) + probe; }
    Facing natural(const Place& at) const noexcept {
        const double wall = at.away - radius, end = std::abs(at.along) - half_length;
        if (wall > 0 && end > 0) {  // over the edge
            const double distance = std::hypot(wall, end);
            return {(wall / distance) * at.out + (end / distance) * at.to_end(), distance - probe};
        }
        if (wall >= end) return {at.out, wall - probe, wall_part};
        return {at.to_end(), end - probe, at.along < 0 ? back_part : front_part};
    }
    // A path is for a while between the planes of the ends, and for a while in the endless cylinder. It
    // enters through the face that it crosses last.
    std::optional<Facing> entered(const Vector3d& last, const Vector3d& q,
                                  const SolidHold& hold) const noexcept {
        const Vector3d way = q - last;
        const double rise = axis.dot(way), start = axis.dot(last);
        double in = -1, out = 1;
        std::uint32_t part = 0;
        if (std::abs(start) > half_length) {
            if (!(rise * start < 0)) return std::nullopt;
            in = (std::abs(start) - half_length) / std::abs(rise);
            part = start < 0 ? back_part : front_part;
        }
        if (rise != 0) out = std::min(out, (half_length - std::copysign(1.0, rise) * start) / std::abs(rise));
        const Vector3d from = last - start * axis, step = way - rise * axis;
        const double a = step.squaredNorm(), b = from.dot(step), c = from.squaredNorm() - radius * radius;
        if (a > 0) {
            const double root = b * b - a * c;
            if (root < 0) return std::nullopt;
            const double enters = (-b - std::sqrt(root)) / a, leaves = (-b + std::sqrt(root)) / a;
            if (c > 0 && enters > in) {
                in = enters;
                part = wall_part;
            }
            out = std::min(out, leaves);
        } else if (c > 0) {
            return std::nullopt;
        }
        if (part == 0 || in > out || in < 0) return std::nullopt;
        // A probe with a radius came over the edge with the normal that held it there.
        if (!(hold.normal == Vec3{})) return Facing{to_eigen(hold.normal), 0, part};
        if (part != wall_part) return Facing{(part == front_part ? 1 : -1) * axis, 0, part};
        return Facing{Place(axis, last + in * way, Vec3{}).out, 0, part};
    }
    Aim aim(const Vector3d& q, const Vector3d& n, std::uint32_t part, const Facing& natural) const noexcept {
        const Place at(axis, q, Vec3{});
        if (part != wall_part) {
            const double side = part == front_part ? 1 : -1;
            if (at.away <= radius && side * at.along <= half_length) return {Aim::Kind::face, side * axis};
            return {Aim::Kind::natural, natural.normal};
        }
        const Vector3d flat = across(n, axis);
        const double length = flat.norm();
        const Vector3d by = direction_or(flat, length, to_plain(at.out), axis);
        const double front = by.dot(q), aside = axis.cross(by).dot(q);
        if (std::abs(at.along) <= half_length && std::abs(aside) <= radius) {
            if (!(front > 0) || at.away < radius / 2) return {Aim::Kind::keep, n};
            if (at.away <= radius) return {Aim::Kind::face, at.out};
        }
        return {Aim::Kind::natural, natural.normal};
    }
    // The supporting plane in this direction. An endless cylinder has one only across its axis.
    double over(const Vector3d& q, const Vector3d& n, std::uint32_t) const noexcept {
        const double cosine = n.dot(axis), sine = n.cross(axis).norm();
        // A smaller cosine is rounding, which a long distance along the axis would amplify.
        if (std::abs(cosine) < 1e-14) return n.dot(q) - cosine * axis.dot(q) - radius * sine - probe;
        const double ends = std::isfinite(half_length) ? half_length * std::abs(cosine) : 0;
        return n.dot(q) - radius * sine - ends - probe;
    }
};

// The wall, an end or the cone over the edge: what the section turned about the axis has in common with the
// plane of normal `lean` (from the wall, along the axis). The probe decides which one, as with a box. So it
// changes where the probe rolls over the edge, not where x does.
CurvedContact turned_about(const SolidCylinder& solid, const Place& at, double out, double along) noexcept {
    CurvedContact cone{.normal = out * at.out + along * at.axis};
    cone.height = out * (at.away - solid.radius) - solid.probe;
    if (along != 0)
        cone.height += std::abs(along) * (std::copysign(1.0, along) * at.along - solid.half_length);
    if (at.away > 1e-100) cone.bend = bend_along(at.axis.cross(at.out), out / at.away);
    return cone;
}

struct Hollow {
    Facing wall, end;

    Hollow(const Cylinder& params, const Place& at, const Probe& probe) noexcept
        : wall{-at.out, room(params.radius, probe) - at.away},
          end{-at.to_end(), room(params.half_length, probe) - std::abs(at.along)} {}
};

Vector3d place_of(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    return from_surface(params.center, params.velocity, state.motion, probe);
}

}  // namespace

Cylinder prepared(Cylinder params, const Limits& limits) noexcept {
    return prepared_solid(params, limits);
}

void adopt(const Cylinder& params, const Cylinder* previous, Cylinder::State& state, const Probe&) noexcept {
    adopt_solid(params, previous, state);
}

Contact contact(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt) noexcept {
    const Vector3d axis = to_eigen(params.axis), q = place_of(params, state, probe, dt);
    const Place at(axis, q, state.hold.normal);
    if (params.side == Side::outside) {
        SolidCylinder solid{axis, params.radius, params.half_length, probe.radius};
        const Facing now = facing_of(solid, q, solid.natural(at), state.hold, dt);
        return contact_of(params, now.normal, now.height);
    }
    const Hollow hollow(params, at, probe);
    const Facing& now = hollow.wall.height <= hollow.end.height ? hollow.wall : hollow.end;
    return contact_of(params, now.normal, now.height);
}

std::uint32_t contacts(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept {
    if (out.empty()) return 0;
    if (params.side == Side::outside || out.size() < 2) {
        out[0] = contact(params, state, probe, dt);
        return 1;
    }
    const Vector3d q = place_of(params, state, probe, dt);
    const Hollow hollow(params, Place(to_eigen(params.axis), q, Vec3{}), probe);
    out[0] = contact_of(params, hollow.wall.normal, hollow.wall.height);
    if (std::isinf(params.half_length)) return 1;
    out[1] = contact_of(params, hollow.end.normal, hollow.end.height);
    return 2;
}

std::uint32_t curved(const Cylinder& params, const Cylinder::State& state, const Probe& probe,
                     const Probe& there, std::span<CurvedContact> out) noexcept {
    const SolidHold& hold = state.hold;
    if (hold.part > wall_part || hold.turning != 0) return 0;
    const Vector3d axis = to_eigen(params.axis);
    const Place at(axis, from_surface(params.center, params.velocity, state.motion, there), hold.normal);
    const SolidCylinder solid{axis, params.radius, params.half_length, there.radius};
    if (params.side == Side::inside) {
        const Hollow room(params, at, there);
        out[0] = hollow(turned_about(solid, at, 1, 0), room.wall.height);
        if (std::isinf(params.half_length) || out.size() < 2) return 1;
        out[1] = {.normal = room.end.normal, .height = room.end.height};
        return 2;
    }
    if (hold.part == wall_part) {
        out[0] = turned_about(solid, at, 1, 0);
        return 1;
    }
    const Place foot(axis, from_surface(params.center, params.velocity, state.motion, probe), hold.normal);
    const double beside = foot.away - solid.radius, beyond = std::abs(foot.along) - solid.half_length;
    if (beside > 0 && beyond > 0) {
        const double distance = std::hypot(beside, beyond);
        out[0] = turned_about(solid, at, beside / distance, std::copysign(beyond / distance, foot.along));
    } else if (beside >= beyond) {
        out[0] = turned_about(solid, at, 1, 0);
    } else {
        return 0;
    }
    return 1;
}

// Only the wall leans: an end is flat everywhere.
void lean(const Cylinder& params, Cylinder::State& state, const Probe& there, double below) noexcept {
    if (state.hold.part != wall_part) return;
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, there);
    meet(state.hold, Place(to_eigen(params.axis), q, state.hold.normal).out, below);
}

bool plane_alone(const Cylinder& params, const Cylinder::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept {
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
    const SolidCylinder solid{to_eigen(params.axis), params.radius, params.half_length, probe.radius};
    return plane_alone(solid, q, state.hold, stiffness, out);
}

std::optional<Bound> bound(const Cylinder& params, const Cylinder::State& state) noexcept {
    if (std::isinf(params.half_length)) return std::nullopt;
    return ball_about(params, state, std::hypot(params.radius, params.half_length));
}

void out_of_reach(const Cylinder&, Cylinder::State& state) noexcept {
    state.hold = {};
}

}  // namespace knurl
