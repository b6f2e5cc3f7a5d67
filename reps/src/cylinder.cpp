#include <algorithm>
#include <cmath>

#include <knurl/reps/cylinder.hpp>

#include "solid.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// Where the probe is: along the axis and away from it.
struct Place {
    Vector3d q, axis, out;
    double along, away;

    Place(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt) noexcept {
        move_on(state.motion, dt);
        q = from_surface(params.center, params.velocity, state.motion, probe);
        axis = to_eigen(params.axis);
        along = axis.dot(q);
        const Vector3d lateral = across(q, axis);
        away = lateral.norm();
        out = direction_or(lateral, away, state.core.normal, axis);
    }
    Vector3d to_end() const noexcept { return std::copysign(1.0, along) * axis; }
};

Facing solid(const Cylinder& params, const Place& at, Core& core, const Probe& probe, double dt) noexcept {
    const double wall = at.away - params.radius, end = std::abs(at.along) - params.half_length;
    Facing natural{wall >= end ? at.out : at.to_end(), std::max(wall, end) - probe.radius};
    if (wall > 0 && end > 0) {  // over the edge
        const double distance = std::hypot(wall, end);
        natural = {(wall / distance) * at.out + (end / distance) * at.to_end(), distance - probe.radius};
    }
    const double limit = (std::min(params.radius, params.half_length) + probe.radius) / 2;
    return guarded(natural, limit, core, dt, [&](const Vector3d& n) {
        // The plane that supports the solid in this direction; an endless one has none across its axis but
        // the wall's.
        const double cosine = n.dot(at.axis), sine = n.cross(at.axis).norm();
        const double ends = std::isfinite(params.half_length) ? params.half_length * std::abs(cosine) : 0;
        return n.dot(at.q) - params.radius * sine - ends - probe.radius;
    });
}

struct Hollow {
    Facing wall, end;

    Hollow(const Cylinder& params, const Place& at, const Probe& probe) noexcept
        : wall{-at.out, room(params.radius, probe) - at.away},
          end{-at.to_end(), room(params.half_length, probe) - std::abs(at.along)} {}
};

}  // namespace

Cylinder prepared(Cylinder params, const Limits& limits) noexcept {
    return prepared_solid(params, limits);
}

void adopt(const Cylinder& params, const Cylinder* previous, Cylinder::State& state, const Probe&) noexcept {
    adopt_solid(params, previous, state);
}

Contact contact(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt) noexcept {
    const Place at(params, state, probe, dt);
    if (params.side == Side::outside) {
        const Facing now = solid(params, at, state.core, probe, dt);
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
    const Hollow hollow(params, Place(params, state, probe, dt), probe);
    out[0] = contact_of(params, hollow.wall.normal, hollow.wall.height);
    if (std::isinf(params.half_length)) return 1;
    out[1] = contact_of(params, hollow.end.normal, hollow.end.height);
    return 2;
}

std::optional<Bound> bound(const Cylinder& params, const Cylinder::State& state) noexcept {
    if (std::isinf(params.half_length)) return std::nullopt;
    return ball_about(params, state, std::hypot(params.radius, params.half_length));
}

void out_of_reach(const Cylinder&, Cylinder::State& state) noexcept {
    state.core = {};
}

}  // namespace knurl
