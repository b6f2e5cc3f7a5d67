#include <cmath>
#include <utility>

#include <knurl/reps/cap.hpp>

#include "surfaces/bend.hpp"
#include "surfaces/surface.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// a shorter axis, or a shorter part of it in the tangent plane, gives no direction
constexpr double least_axis = 1e-6;

// The signed distance of (x, z) from an arc with the given curvature through the origin, tangent to x there.
// Where the sine of the arc's angle reaches `rim`, its tangents continue it. The gradient is a unit vector.
//   within:  h = 1/K - sqrt(x^2 + (z - 1/K)^2)     multiplied out by the conjugate: K = 0 gives z
//   beyond:  h = n.(p - g), g the rim point
struct Arc {
    double height, x, z;
    double bend;  // 1/m, along (-z, x)

    Arc(double curvature, double rim, double px, double pz) noexcept {
        const double mx = -curvature * px, mz = 1 - curvature * pz;  // (centre - p) x curvature
        const double cosine = std::sqrt(1 - rim * rim);
        if (mz >= 0 && cosine * std::abs(mx) <= rim * mz) {
            const double length = std::sqrt(mx * mx + mz * mz);
            height = (2 * pz - curvature * (px * px + pz * pz)) / (1 + length);
            x = length > 0 ? mx / length : 0;  // at the centre: the limit on the way there from the foot
            z = length > 0 ? mz / length : 1;
            bend = length > 0 ? -curvature / length : 0;
        } else {
            x = std::copysign(rim, mx);
            z = cosine;
            bend = 0;
            height = x * px + z * pz + rim * rim / ((1 + cosine) * curvature);
        }
    }
};

double felt(double curvature, double radius) noexcept {
    return 2 * curvature * radius > 1 ? 0.5 / radius : curvature;
}

}  // namespace

Verdict Describe<Cap>::check(const Cap& cap) noexcept {
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
    // The stronger curvature becomes the tube of the torus, so that the order of the two curvatures has no
    // effect.
    const double first = std::abs(params.curvature), second = std::abs(params.curvature2);
    if (second > first || (second == first && params.curvature < 0)) {
        std::swap(params.curvature, params.curvature2);
        along = normal.cross(along);
    }
    params.axis = to_plain(along);
    return params;
}

namespace {

// Computing `bend` costs more than the contact, so only callers that need it pay for it.
template <bool Bends>
CurvedContact curved_at(const Cap& params, const Vector3d& p, double radius) noexcept {
    const Vector3d q = p - to_eigen(params.foot);
    const Vector3d normal = to_eigen(params.normal), axis = to_eigen(params.axis);
    const double z = normal.dot(q);
    const double curvature = felt(params.curvature, radius);
    CurvedContact out;
    if (params.curvature == params.curvature2) {
        const Vector3d along = across(q, normal);
        const double r = along.norm();
        const Arc arc(curvature, params.rim, r, z);
        const Vector3d direction = r > 0 ? Vector3d(along / r) : Vector3d(normal.unitOrthogonal());
        out.normal = arc.z * normal + arc.x * direction;
        out.height = arc.height - radius;
        if constexpr (Bends) {
            const double around = r > 0 ? arc.x / r : arc.bend;
            out.bend = bend_along(arc.z * direction - arc.x * normal, arc.bend) +
                       bend_along(normal.cross(direction), around);
        }
        return out;
    }
    // The distance from a torus is the distance from a circle in the plane that turns with the ring: two
    // arcs.
    const Vector3d side = normal.cross(axis);
    const double share = std::abs(params.curvature2 / params.curvature);  // the same reach in both directions
    const Arc ring(felt(params.curvature2, radius), params.rim * share, side.dot(q), z);
    const Arc tube(curvature, params.rim, axis.dot(q), ring.height);
    const Vector3d up = ring.x * side + ring.z * normal;
    out.normal = tube.x * axis + tube.z * up;
    out.height = tube.height - radius;
    if constexpr (Bends) {
        out.bend = bend_along(tube.z * axis - tube.x * up, tube.bend) +
                   bend_along(ring.z * side - ring.x * normal, tube.z * ring.bend);
    }
    return out;
}

}  // namespace

SurfaceDistance distance(const Cap& params, const Vector3d& p, double radius) noexcept {
    const CurvedContact there = curved_at<false>(params, p, radius);
    return {there.height, there.normal};
}

std::uint32_t curved(const Cap& params, const Cap::State& state, const Probe&, const Probe& there,
                     std::span<CurvedContact> out) noexcept {
    out[0] =
        curved_at<true>(params, there.position - state.motion.time * to_eigen(params.velocity), there.radius);
    return 1;
}

// Its height is a signed distance.
double clearance(const Cap& params, const Cap::State& state, const Probe& probe) noexcept {
    return distance(params, probe.position - state.motion.time * to_eigen(params.velocity), probe.radius)
        .height;
}

}  // namespace knurl
