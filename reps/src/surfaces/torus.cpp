#include <algorithm>
#include <cmath>

#include <knurl/reps/torus.hpp>

#include "surfaces/bend.hpp"
#include "surfaces/solid.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// The probe in the plane through it and the axis, at distance `from_axis` from the axis and `along` it. The
// tube's section there is a disc about (radius, 0). A kept normal turns with this plane, so the kept surface
// is a cone around the ring.
struct Section {
    Vector3d axis, radial;
    double from_axis, along;

    Section(const Vector3d& ring_axis, const Vector3d& q) noexcept : axis(ring_axis), along(axis.dot(q)) {
        const Vector3d lateral = across(q, axis);
        from_axis = lateral.norm();
        radial = direction_or(lateral, from_axis, Vec3{}, axis);
    }
    Vector3d world(const Vector3d& section) const noexcept {
        return section.x() * radial + section.z() * axis;
    }

    // From the circle.
    struct Away {
        double x, z, length;
        Vector3d normal(const SolidHold& hold) const noexcept {
            if (length > 1e-100) return {x / length, 0, z / length};
            return hold.normal == Vec3{} ? Vector3d::UnitZ() : to_eigen(hold.normal);
        }
    };
    Away away(double radius) const noexcept {
        const double x = from_axis - radius;
        return {x, along, std::sqrt(x * x + along * along)};
    }
};

// A probe of radius r meets a tube of size t = tube + r. Where t > R, R the radius, the probe plugs the hole.
// Then the section's disc and its mirror image about (-R, 0) overlap, and the axis is free only beyond the
// seats (0, +-s), s^2 = t^2 - R^2. Where the foot on the probe's own disc would lie in the other disc, the
// seat is the nearest free point. (The feet on both discs as two planes would meet almost anywhere along the
// axis, since they face each other.) A tube's normal is kept in the section, a seat's in the world: near the
// axis the section turns at once.
constexpr std::uint32_t tube_part = 1, seat_part = 2;

struct Seat {
    double along;  // m, of both seats from the centre; 0: no seats
    Seat(double size, double radius) noexcept
        : along(size > radius ? std::sqrt((size - radius) * (size + radius)) : 0) {}
    double over(const Vector3d& q, const Vector3d& axis, const Vector3d& normal) const noexcept {
        const double rises = normal.dot(axis);
        return normal.dot(q) - rises * std::copysign(along, rises);
    }
    // Half way on the straight line from the seat to the middle plane, beyond which the other seat is
    // nearest.
    double limit(const Vector3d& axis, const Vector3d& normal) const noexcept {
        return along / (2 * std::abs(normal.dot(axis)));
    }
};

Facing facing(const Section& at, const Section::Away& away, const Seat& seat, double radius, double size,
              const SolidHold& hold) noexcept {
    if (seat.along > 0 && radius * away.length + size * away.x < 0) {
        const double side = std::copysign(1.0, at.along), to = side * seat.along - at.along;
        const double depth = std::sqrt(to * to + at.from_axis * at.from_axis);
        const Vector3d out = to * at.axis - at.from_axis * at.radial;
        return {depth > 1e-100 ? Vector3d(out / depth) : Vector3d(side * at.axis), -depth, seat_part};
    }
    return {away.normal(hold), away.length - size, tube_part};
}

// A ring that the probe's radius makes `size` thick. `radial` is the direction about the axis in which it
// holds: from half way to the axis outwards it follows the probe, further in it is kept.
struct Ring {
    Vector3d axis, radial;
    double radius, size;
    Seat seat;
    double margin;

    Ring(const Torus& params, const Section& at, const Facing& natural, const SolidHold& hold,
         const Probe& probe, double dt) noexcept
        : axis(at.axis),
          radial(at.radial),
          radius(params.radius),
          size(params.tube + probe.radius),
          seat(size, radius),
          margin(natural.part == seat_part ? seat.limit(axis, natural.normal) : size / 2) {
        if (hold.part != tube_part) return;
        const Vector3d held = to_eigen(hold.radial);
        const bool inner = at.from_axis < radius / 2 || at.radial.dot(held) < 0;
        const bool past = at.from_axis * std::abs(axis.cross(held).dot(at.radial)) > ball();
        radial = inner && !past ? held : turned(held, at.radial, turn_rate * dt);
    }
    double ball() const noexcept { return radius + size; }
    std::optional<Facing> entered(const Vector3d& last, const Vector3d& q, const SolidHold& hold) noexcept {
        const double from = axis.dot(last), to = axis.dot(q);
        if (seat.along > 0) {
            // A path this short crosses the axis only through the middle of the hole.
            if (!(from * to < 0)) return std::nullopt;
            if (Section(axis, last + from / (from - to) * (q - last)).from_axis >= radius)
                return std::nullopt;
            return Facing{std::copysign(1.0, from) * axis, 0, seat_part};
        }
        const auto at = where_entered(last, q, size, [&](const Vector3d& p) {
            return Section(axis, p).away(radius).length - (size - margin);
        });
        if (!at) return std::nullopt;
        const Section section(axis, *at);
        radial = section.radial;
        return Facing{section.away(radius).normal(hold), 0, tube_part};
    }
    Vector3d in_section(const Vector3d& q) const noexcept { return {q.dot(radial) - radius, 0, q.dot(axis)}; }
    Aim aim(const Vector3d& q, const Vector3d& n, std::uint32_t part, const Facing& natural) const noexcept {
        const Aim keeps{Aim::Kind::keep, n};
        const Section at(axis, q);
        const bool from_seat = natural.part == seat_part;
        if (part == seat_part) {
            const Vector3d aside = q - n.dot(q) * n;
            if (aside.squaredNorm() <= ball() * ball()) return keeps;
            return {Aim::Kind::natural, from_seat ? natural.normal : at.world(natural.normal)};
        }
        const Aim lets_go{radial == at.radial ? Aim::Kind::natural : Aim::Kind::face,
                          from_seat ? Vector3d(natural.normal.dot(at.radial), 0, natural.normal.dot(axis))
                                    : natural.normal};
        if (natural.height < -margin) return keeps;
        const Vector3d y = in_section(q);
        const bool beside = std::abs(n.x() * y.z() - n.z() * y.x()) > size;
        const bool past = std::abs(axis.cross(radial).dot(q)) > ball();
        return n.dot(y) > 0 || beside || past ? lets_go : keeps;
    }
    double over(const Vector3d& q, const Vector3d& n, std::uint32_t part) const noexcept {
        return part == seat_part ? seat.over(q, axis, n) : n.dot(in_section(q)) - size;
    }
};

Contact solid(const Torus& params, const Vector3d& q, SolidHold& hold, const Probe& probe,
              double dt) noexcept {
    const Section at(to_eigen(params.axis), q);
    const double size = params.tube + probe.radius;
    const Facing natural =
        facing(at, at.away(params.radius), Seat(size, params.radius), params.radius, size, hold);
    Ring ring(params, at, natural, hold, probe, dt);
    const Facing now = facing_of(ring, q, natural, hold, dt);
    if (dt > 0) {
        // A seat that does not hold keeps no normal: its normal belongs to no section, and it is unique.
        if (now.part == seat_part && hold.part == 0) hold.normal = Vec3{};
        if (hold.part == tube_part) hold.radial = to_plain(ring.radial);
    }
    if (now.part == seat_part) return contact_of(params, now.normal, now.height);
    const Vector3d& radial = now.held ? ring.radial : at.radial;
    return contact_of(params, now.normal.x() * radial + now.normal.z() * ring.axis, now.height);
}

}  // namespace

Verdict Describe<Torus>::check(const Torus& torus) noexcept {
    if (torus.tube < torus.radius) return {};
    constexpr std::uint32_t row = row_of<Torus>("tube");
    return {Verdict::Code::contradiction, row, torus.tube, 1};
}

Torus prepared(Torus params, const Limits& limits) noexcept {
    return prepared_solid(params, limits);
}

void adopt(const Torus& params, const Torus* previous, Torus::State& state, const Probe&) noexcept {
    adopt_solid(params, previous, state);
}

Contact contact(const Torus& params, Torus::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
    if (params.side == Side::outside) return solid(params, q, state.hold, probe, dt);
    const Section at(to_eigen(params.axis), q);
    const Section::Away away = at.away(params.radius);
    return contact_of(params, at.world(-away.normal(SolidHold{})), room(params.tube, probe) - away.length);
}

// Where the probe plugs the hole, the seats are points: this cycle's plane stands for them.
std::uint32_t curved(const Torus& params, const Torus::State& state, const Probe&, const Probe& there,
                     std::span<CurvedContact> out) noexcept {
    const bool inside = params.side == Side::inside;
    if (state.hold.part != 0) return 0;
    if (!inside && Seat(params.tube + there.radius, params.radius).along > 0) return 0;
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, there);
    const Section at(to_eigen(params.axis), q);
    const Section::Away away = at.away(params.radius);
    const Vector3d n = away.normal(SolidHold{}), tangent(-n.z(), 0, n.x());
    CurvedContact tube{.normal = at.world(n), .height = away.length - (params.tube + there.radius)};
    if (away.length > 1e-100) tube.bend = bend_along(at.world(tangent), 1 / away.length);
    if (at.from_axis > 1e-100) tube.bend += bend_along(at.axis.cross(at.radial), n.x() / at.from_axis);
    out[0] = inside ? hollow(tube, room(params.tube, there) - away.length) : tube;
    return 1;
}

std::optional<Bound> bound(const Torus& params, const Torus::State& state) noexcept {
    return ball_about(params, state, params.radius + params.tube);
}

void out_of_reach(const Torus&, Torus::State& state) noexcept {
    state.hold = {};
}

}  // namespace knurl
