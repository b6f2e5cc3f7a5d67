#include <cmath>
#include <utility>

#include <knurl/reps/cap.hpp>

#include "surface.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// shorter ones, also as a share within the tangent plane, are no direction
constexpr double least_axis = 1e-6;

// The signed distance of (x, z) from an arc of that curvature through the origin, tangent to x there, that is
// continued by its tangents where the angle's sine reaches `rim`; and its gradient, a unit vector.
//   within:  h = 1/K - sqrt(x^2 + (z - 1/K)^2)     as a plane's z where K is 0: multiplied out by the conjugate
//   beyond:  h = n.(p - g), g the rim point
struct Arc {
    double height, x, z;

    Arc(double curvature, double rim, double px, double pz) noexcept {
        const double mx = -curvature * px, mz = 1 - curvature * pz;  // (centre - p) x curvature
        const double cosine = std::sqrt(1 - rim * rim);
        if (mz >= 0 && cosine * std::abs(mx) <= rim * mz) {
            const double length = std::sqrt(mx * mx + mz * mz);
            height = (2 * pz - curvature * (px * px + pz * pz)) / (1 + length);
            x = length > 0 ? mx / length : 0;  // at the centre itself: as on the way there from the foot
            z = length > 0 ? mz / length : 1;
        } else {
            x = std::copysign(rim, mx);
            z = cosine;
            height = x * px + z * pz + rim * rim / ((1 + cosine) * curvature);
        }
    }
};

double felt(double curvature, const Probe& probe) noexcept {
    return 2 * curvature * probe.radius > 1 ? 0.5 / probe.radius : curvature;
}

}  // namespace

Verdict Describe<Cap>::check(const Cap& cap) noexcept {
    if (const Verdict verdict = check_material(cap); !verdict) return verdict;
    if (cap.curvature2 == cap.curvature) return {};
    const double length = to_eigen(cap.axis).norm();
    if (length < least_axis) {
        constexpr std::uint32_t row = row_of<Cap>("curvature2");
        return cap.curvature2 == 0 ? Verdict{}
                                   : Verdict{Verdict::Code::contradiction, row, cap.curvature2, 1};
    }
    const Vector3d normal = to_eigen(unit(cap.normal));
    if (across(to_eigen(cap.axis) / length, normal).norm() < least_axis) {
        constexpr std::uint32_t row = row_of<Cap>("axis");
        return {Verdict::Code::contradiction, row, length, 2};
    }
    return {};
}

Cap prepared(Cap params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    params.normal = unit(params.normal);
    const Vector3d normal = to_eigen(params.normal), axis = to_eigen(params.axis);
    if (axis.norm() < least_axis || params.curvature == params.curvature2) {
        params.curvature2 = params.curvature;
        params.axis = {};
        return params;
    }
    Vector3d along = across(axis.normalized(), normal).normalized();
    // The tube of the torus is the stronger curvature, so that the surface does not depend on which is named
    // first.
    const double first = std::abs(params.curvature), second = std::abs(params.curvature2);
    if (second > first || (second == first && params.curvature < 0)) {
        std::swap(params.curvature, params.curvature2);
        along = normal.cross(along);
    }
    params.axis = to_plain(along);
    return params;
}

void adopt(const Cap& params, const Cap* previous, Cap::State& state, const Probe&) noexcept {
    if (!previous || !(params.foot == previous->foot) || !(params.normal == previous->normal) ||
        !(params.velocity == previous->velocity)) {
        place(state.motion);
    }
}

Contact contact(const Cap& params, Cap::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Vector3d q = from_surface(params.foot, params.velocity, state.motion, probe);
    const Vector3d normal = to_eigen(params.normal), axis = to_eigen(params.axis);
    const double z = normal.dot(q);
    const double curvature = felt(params.curvature, probe);
    if (params.curvature == params.curvature2) {
        const Vector3d along = across(q, normal);
        const double r = along.norm();
        const Arc arc(curvature, params.rim, r, z);
        const Vector3d direction = r > 0 ? Vector3d(along / r) : Vector3d(normal.unitOrthogonal());
        return contact_of(params, arc.z * normal + arc.x * direction, arc.height - probe.radius);
    }
    // The distance from a torus is that from a circle in the plane which has turned with the ring: two arcs.
    const Vector3d side = normal.cross(axis);
    const double share = std::abs(params.curvature2 / params.curvature);  // the same reach in both directions
    const Arc ring(felt(params.curvature2, probe), params.rim * share, side.dot(q), z);
    const Arc tube(curvature, params.rim, axis.dot(q), ring.height);
    return contact_of(params, tube.x * axis + tube.z * (ring.x * side + ring.z * normal),
                      tube.height - probe.radius);
}

// Its height is a signed distance.
double clearance(const Cap& params, const Cap::State& state, const Probe& probe) noexcept {
    Cap::State copy = state;
    return contact(params, copy, probe, 0).height;
}

}  // namespace knurl
