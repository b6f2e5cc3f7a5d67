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

    // From a point of the circle: `radius` from the axis; negative: on its other side.
    struct Away {
        double x, z, length;
        Vector3d normal() const noexcept { return {x / length, 0, z / length}; }
    };
    Away away(double radius) const noexcept {
        const double x = from_axis - radius;
        return {x, along, std::sqrt(x * x + along * along)};
    }
};

Contact nearest(const Torus& params, const Section& at, Core& core, const Probe& probe, double dt) noexcept {
    const Section::Away away = at.away(params.radius);
    const Vector3d normal = away.length > 1e-100    ? away.normal()
                            : core.normal == Vec3{} ? Vector3d::UnitZ()
                                                    : to_eigen(core.normal);
    if (params.side == Side::inside)
        return contact_of(params, at.world(-normal), room(params.tube, probe) - away.length);
    const double reach = params.tube + probe.radius;
    const Facing now = guarded({normal, away.length - reach}, reach / 2, core, dt,
                               [&](const Vector3d& n) { return n.x() * away.x + n.z() * away.z - reach; });
    return contact_of(params, at.world(now.normal), now.height);
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
    return nearest(params, Section(params, state, probe, dt), state.core, probe, dt);
}

std::uint32_t contacts(const Torus& params, Torus::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept {
    if (out.empty()) return 0;
    const Section at(params, state, probe, dt);
    out[0] = nearest(params, at, state.core, probe, dt);
    const double reach = params.tube + probe.radius;
    if (params.side == Side::inside || reach <= params.radius || out.size() < 2) return 1;
    const Section::Away far = at.away(-params.radius);
    out[1] = contact_of(params, at.world(far.normal()), far.length - reach);
    return 2;
}

std::optional<Bound> bound(const Torus& params, const Torus::State& state) noexcept {
    return ball_about(params, state, params.radius + params.tube);
}

void out_of_reach(const Torus&, Torus::State& state) noexcept {
    state.core = {};
}

}  // namespace knurl
