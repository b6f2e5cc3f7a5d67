#include <Eigen/Eigenvalues>

#include <knurl/reps/taylor.hpp>

#include "effects/jacobian.hpp"
#include "scene/clamped.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// What the slope of share x (W - level) is at most in the edge, in either sense. With the share s, u = d / r,
// G the gradient of W and V = W - level it is
//   s S + s' (u G^T + G u^T) + V (s'' u u^T + s'/r (1 - u u^T)),    s'/r <= 6 t / width^2
// of which each factor is bounded on every eighth of the edge.
double slope_of_edge(double force, const Spectrum& spectrum, double mean, double reach,
                     double core) noexcept {
    constexpr int parts = 8;
    const double width = (1 - core) * reach, level = mean * std::pow(middle_of_edge(core) * reach, 2);
    const double largest = spectrum.largest();
    double most = largest;
    for (int i = 0; i < parts; ++i) {
        const double low = static_cast<double>(i) / parts, high = static_cast<double>(i + 1) / parts;
        const double far = reach - width * low, near = reach - width * high;
        const double steepest = std::clamp(0.5, low, high);
        const double share = high * high * (3 - 2 * high);
        const double first = 6 * steepest * (1 - steepest) / width;
        const double second =
            6 * std::max({std::abs(1 - 2 * low), std::abs(1 - 2 * high), high}) / (width * width);
        double square = 0;
        for (const double value : {spectrum.least, spectrum.most}) {
            for (const double r : {near, far}) square = std::max(square, std::abs(value * r * r - level));
        }
        most = std::max(most, share * largest + 2 * first * (force + largest * far) +
                                  second * (force * far + square / 2));
    }
    return most;
}

// Within the rim it is the series. Beyond it W = F0 d + (2 R r - R^2) u^T S u / 2. Its gradient is
// continuous: radially the rim's, tangentially up to twice that. So a closed loop returns its work.
Vector3d held(const Taylor& params, const Vector3d& d) noexcept {
    const auto j = to_eigen(params.jacobian);
    const double r = d.norm();
    if (r <= params.radius) return to_eigen(params.force) + j * d;
    const double share = params.radius / r;
    const Vector3d u = d / r, rim = params.radius * u, change = j * rim;
    const Vector3d even = 0.5 * (change + j.transpose() * rim);
    return to_eigen(params.force) + change + (1 - share) * (even - u.dot(even) * u);
}

}  // namespace

Taylor prepared(Taylor params, const Limits& limits) noexcept {
    const double largest = largest_stiffness(0, limits);
    const bool fades = params.edge == TaylorEdge::fade;
    const double pushing = std::isfinite(largest) ? world_stiffness(hand_stiffness, limits) : largest;
    Square<3> j = to_eigen(params.jacobian);
    const Spectrum spectrum =
        clamp_eigenvalues<3>(j, -(fades ? largest : restoring_when_held(largest, pushing)), pushing);
    params.core = widest_core;
    params.level = 0;
    params.reserved = 0;
    if (fades) {
        const double mean = j.trace() / 3, reach = params.radius;
        const double force = to_eigen(params.force).norm();
        const Core core = core_within(
            largest, [&](double share) { return slope_of_edge(force, spectrum, mean, reach, share); });
        params.core = core.share;
        params.stiffness = core.slope;
        if (core.strength < 1) {
            j *= core.strength;
            params.force = to_plain(core.strength * to_eigen(params.force));
        }
        params.level = j.trace() / 6 * std::pow(middle_of_edge(core.share) * reach, 2);
    } else {
        params.stiffness = -spectrum.least + spectrum.most / 3;
        if (std::isfinite(largest)) params.stiffness = std::min(params.stiffness, largest);
    }
    params.jacobian = to_mat3(j);
    return params;
}

void adopt(const Taylor&, const Taylor*, Taylor::State&, const Probe&) noexcept {}

Wrench evaluate(const Taylor& params, Taylor::State&, const Probe& probe, double) noexcept {
    const Vector3d d = probe.position - to_eigen(params.origin);
    if (params.edge == TaylorEdge::hold) return {.force = held(params, d)};
    const double r = d.norm();
    const EdgeShare share = smooth_edge(r, params.core, params.radius);
    if (share.value == 0) return {};
    const Vector3d change = to_eigen(params.jacobian) * d, force = to_eigen(params.force) + change;
    if (share.slope == 0) return {.force = share.value * force};
    const double work = to_eigen(params.force).dot(d) + 0.5 * d.dot(change) - params.level;
    return {.force = share.value * force + (share.slope * work / r) * d};
}

bool powerless(const Taylor& params) noexcept {
    return params.force == Vec3{} && params.jacobian == Mat3{};
}

std::optional<Bound> bound(const Taylor& params) noexcept {
    if (params.edge == TaylorEdge::hold) return std::nullopt;
    return Bound{.center = to_eigen(params.origin), .radius = params.radius};
}

namespace {

// W = F0 d + d J d / 2 - level, whose gradient is the series. It is nowhere larger than `most_work`.
double work_at(const Taylor& params, const Vector3d& d) noexcept {
    return to_eigen(params.force).dot(d) + 0.5 * d.dot(to_eigen(params.jacobian) * d) - params.level;
}
double most_work(const Taylor& params) noexcept {
    const auto j = to_eigen(params.jacobian);
    const Vector3d force = to_eigen(params.force);
    const Eigen::Matrix3d even = 0.5 * (j + j.transpose());
    const double most =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(even, Eigen::EigenvaluesOnly).eigenvalues().z();
    const double pushes = std::max(0.0, most);
    return std::max(
        0.0, force.norm() * params.radius + 0.5 * pushes * params.radius * params.radius - params.level);
}

}  // namespace

// No direction is stiffer, inside or at the edge. The load falls before the field does, alike in all
// directions: a jump of the load would make the scale of all effects jump, and their forces with it.
HandLoad load(const Taylor& params, const Taylor::State&, const Probe& probe) noexcept {
    const Vector3d d = probe.position - to_eigen(params.origin);
    const double r = d.norm();
    const bool holds = params.edge == TaylorEdge::hold;
    HandLoad load = isotropic_load(params.stiffness * (holds ? 1 : load_left(r, params.radius)), 0);
    const double share = holds ? 1 : smooth_edge(r, params.core, params.radius).value;
    if (share > 0) load.energy.held = std::max(0.0, most_work(params) - share * work_at(params, d));
    return load;
}

}  // namespace knurl
