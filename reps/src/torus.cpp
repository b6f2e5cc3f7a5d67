#include <algorithm>
#include <cmath>

#include <knurl/reps/torus.hpp>

#include "solid.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// The probe in the plane through it and the axis: `from_axis` away from it, `along` it. The tube's section
// there is a disc about (radius, 0), and the kept normal turns with this plane: what is kept is a cone around
// the ring.
struct Section {
    Vector3d axis, radial;
    double from_axis, along;

    Section(const Torus& params, Torus::State& state, const Probe& probe, double dt) noexcept {
        move_on(state.motion, dt);
        const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
        axis = to_eigen(params.axis);
        along = axis.dot(q);
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
        Vector3d normal(const Core& core) const noexcept {
            if (length > 1e-100) return {x / length, 0, z / length};
            return core.normal == Vec3{} ? Vector3d::UnitZ() : to_eigen(core.normal);
        }
    };
    Away away(double radius) const noexcept {
        const double x = from_axis - radius;
        return {x, along, std::sqrt(x * x + along * along)};
    }
};

// A probe of radius r sees a tube of the size t = tube + r. Where t > radius = R it plugs the hole: the
// section's disc and its mirror image about (-R, 0) overlap, and of the axis only what lies beyond the seats
// (0, +-s), s^2 = t^2 - R^2, is free. A probe whose foot on its own disc would lie beyond the axis, in the
// other disc, has the seat as the nearest free point instead. (The feet of both discs as two planes would
// meet nearly anywhere along the axis: they face each other.) Of the tube the normal in the section is kept,
// of a seat the world's: near the axis the section turns at once.
constexpr std::uint32_t tube_part = 1, seat_part = 2;

struct Seat {
    double along;  // m, of both seats from the centre; 0: there are none
    Seat(double size, double radius) noexcept
        : along(size > radius ? std::sqrt((size - radius) * (size + radius)) : 0) {}
    double over(const Section& at, const Vector3d& normal) const noexcept {
        const double rises = normal.dot(at.axis), to = std::copysign(along, rises);
        return normal.dot(at.from_axis * at.radial) + rises * (at.along - to);
    }
    // Half way on the straight line from the seat to the middle plane, where the other seat becomes the
    // nearest.
    double limit(const Section& at, const Vector3d& normal) const noexcept {
        return along / (2 * std::abs(normal.dot(at.axis)));
    }
};

Facing facing(const Section& at, const Section::Away& away, const Seat& seat, const Torus& params,
              double size, const Core& core) noexcept {
    if (seat.along > 0 && params.radius * away.length + size * away.x < 0) {
        const double side = std::copysign(1.0, at.along), to = side * seat.along - at.along;
        const double depth = std::sqrt(to * to + at.from_axis * at.from_axis);
        const Vector3d out = to * at.axis - at.from_axis * at.radial;
        return {depth > 1e-100 ? Vector3d(out / depth) : Vector3d(side * at.axis), -depth, seat_part};
    }
    return {away.normal(core), away.length - size, tube_part};
}

Contact solid(const Torus& params, const Section& at, Core& core, const Probe& probe, double dt) noexcept {
    const double size = params.tube + probe.radius;
    const Section::Away away = at.away(params.radius);
    const Seat seat(size, params.radius);
    const Facing natural = facing(at, away, seat, params, size, core);
    const double limit = natural.part == seat_part ? seat.limit(at, natural.normal) : size / 2;
    const Facing now = guarded_part(natural, limit, core, dt, [&](const Vector3d& n, std::uint32_t part) {
        if (part == seat_part) return std::max(seat.over(at, n), -seat.limit(at, n));
        return std::max(n.x() * away.x + n.z() * away.z - size, -size / 2);
    });
    if (now.part == tube_part) return contact_of(params, at.world(now.normal), now.height);
    if (dt > 0 && core.deep == 0) core.normal = Vec3{};  // no section's, and there is no doubt about it
    return contact_of(params, now.normal, now.height);
}

}  // namespace

Verdict Describe<Torus>::check(const Torus& torus) noexcept {
    if (const Verdict verdict = check_material(torus); !verdict) return verdict;
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
    const Section at(params, state, probe, dt);
    if (params.side == Side::outside) return solid(params, at, state.core, probe, dt);
    const Section::Away away = at.away(params.radius);
    return contact_of(params, at.world(-away.normal(state.core)), room(params.tube, probe) - away.length);
}

std::optional<Bound> bound(const Torus& params, const Torus::State& state) noexcept {
    return ball_about(params, state, params.radius + params.tube);
}

void out_of_reach(const Torus&, Torus::State& state) noexcept {
    state.core = {};
}

}  // namespace knurl
