#include <Eigen/Eigenvalues>

#include <knurl/reps/taylor6.hpp>

#include "effects/jacobian.hpp"
#include "scene/clamped.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// (s w, s v) for s = +-1 are the same orientation: w >= 0 gives the shorter rotation.
Vector3d rotation_vector(const Eigen::Quaterniond& q) noexcept {
    const double sine = q.vec().norm();
    if (!(sine > 0)) return Vector3d::Zero();
    const double angle = 2 * std::atan2(sine, std::abs(q.w()));
    return (std::copysign(angle, q.w()) / sine) * q.vec();
}

// A bounded length continues beyond its rim as R (2 - R / r), with a continuous slope; as a share of the
// length at the rim.
constexpr double stretched(double share) noexcept {
    return 2 - share;
}

// The linear and the quadratic part of one argument (position, or rotation vector) beyond its rim.
struct Rim {
    explicit Rim(const Vector3d& whole, double reach) noexcept : at(whole) {
        const double length = whole.norm();
        if (length <= reach) return;
        share = reach / length;
        at = share * whole;
        u = whole / length;
    }
    // Gradient of the work u^T S u (2 R r - R^2) / 2, from S times the value at the rim.
    Vector3d quadratic(const Vector3d& change) const noexcept {
        return stretched(share) * change - (1 - share) * u.dot(change) * u;
    }
    // Gradient of the work c^T x R (2 - R / r) / r.
    Vector3d linear(const Vector3d& c) const noexcept {
        return share * (stretched(share) * c - 2 * (1 - share) * u.dot(c) * u);
    }
    Vector3d at;                    // clamped
    Vector3d u = Vector3d::Zero();  // towards the argument, where it is beyond the rim
    double share = 1;
};

// From a potential where J is symmetric. The product of position and rotation vector grows to at most twice
// its value at the rim, so neither force nor torque grows with distance.
Eigen::Matrix<double, 6, 1> held(const Taylor6& params, const Vector3d& d, const Vector3d& turn) noexcept {
    const Rim far(d, params.radius), turned(turn, params.angle);
    const auto j = to_eigen(params.jacobian);
    Eigen::Matrix<double, 6, 1> rim;
    rim << far.at, turned.at;
    Eigen::Matrix<double, 6, 1> change = j * rim;
    if (far.share == 1 && turned.share == 1) return change;
    const Square<6> even = 0.5 * (j + j.transpose());
    change -= even * rim;  // the rest comes from the curl, at the rim
    const Vector3d stretched_turn = stretched(turned.share) * turned.at,
                   stretched_d = stretched(far.share) * far.at;
    change.head<3>() += far.quadratic(even.topLeftCorner<3, 3>() * far.at) +
                        far.linear(even.topRightCorner<3, 3>() * stretched_turn);
    change.tail<3>() += turned.quadratic(even.bottomRightCorner<3, 3>() * turned.at) +
                        turned.linear(even.bottomLeftCorner<3, 3>() * stretched_d);
    return change;
}

// The measure in which the Jacobian is bounded: a radian counts as so many metres. Where the device's
// torsional limit is unknown, only force by position is bounded, at any rotation within the field's reach.
struct Metric {
    Metric(const Limits& limits, double largest) noexcept
        : metres(std::sqrt(limits.max_torsion / largest)),
          whole(std::isfinite(largest) && metres > world_length(1e-6, limits) &&
                metres < world_length(1e6, limits)) {}
    double metres;
    bool whole;
};

// As in taylor.cpp, over both edges at once: S + 2 e G + V (the second derivative of the share), with e the
// largest slope of the share, and G and V upper bounds of gradient and energy.
double slope_of_edge(const Taylor6& params, const Square<6>& even, double mean_work, const Metric& metric,
                     double largest, double core) noexcept {
    const double reach = params.radius, angle = params.angle, per = 1 / (1 - core);
    const double middle = middle_of_edge(core), force = to_eigen(params.force).norm(),
                 torque = to_eigen(params.torque).norm();
    const double turning = even.bottomRightCorner<3, 3>().norm(), mixed = even.topRightCorner<3, 3>().norm();
    const double moving = even.topLeftCorner<3, 3>().norm();
    const double work = force * reach + torque * angle +
                        0.5 * (moving * reach * reach + turning * angle * angle) + mixed * reach * angle +
                        std::abs(mean_work) * middle * middle;
    double gradient, first, second;
    if (metric.whole) {
        const double across = angle * metric.metres;  // m
        gradient = std::hypot(force, torque / metric.metres) + largest * std::hypot(reach, across);
        first = std::hypot(1 / reach, 1 / across);
        second = 6 * std::pow(std::max(1 / reach, 1 / across), 2) + 2.25 / (reach * across);
    } else {
        gradient = force + largest * reach + mixed * angle;
        first = 1 / reach;
        second = 6 / (reach * reach);
    }
    return largest + 2 * 1.5 * per * first * gradient + per * per * second * work;
}

// Beyond the rim of a held field: the additional stiffness, of each argument alone and of both together.
double slope_when_held(const Taylor6& params, const Square<6>& even, const Metric& metric,
                       const Spectrum& spectrum) noexcept {
    const double mixed = even.topRightCorner<3, 3>().norm();
    const double over = metric.whole
                            ? std::max(params.angle / params.radius,
                                       params.radius / (params.angle * metric.metres * metric.metres))
                            : params.angle / params.radius;
    return -spectrum.least + spectrum.most / 3 + 6 * mixed * over;
}

}  // namespace

Taylor6 prepared(Taylor6 params, const Limits& limits) noexcept {
    const double largest = largest_stiffness(0, limits);
    const double pushing = std::isfinite(largest) ? world_stiffness(hand_stiffness, limits) : largest;
    const bool fades = params.edge == TaylorEdge::fade;
    const double restoring = fades ? largest : restoring_when_held(largest, pushing);
    const Metric metric(limits, largest);
    Square<6> j = to_eigen(params.jacobian);
    Spectrum spectrum;
    if (metric.whole) {
        Eigen::Matrix<double, 6, 1> unit;
        unit << 1, 1, 1, 1 / metric.metres, 1 / metric.metres, 1 / metric.metres;
        const Square<6> before = unit.asDiagonal() * j * unit.asDiagonal();
        Square<6> after = before;
        spectrum = clamp_eigenvalues<6>(after, -restoring, pushing);
        if (after != before) j = unit.cwiseInverse().asDiagonal() * after * unit.cwiseInverse().asDiagonal();
    } else {
        Square<3> forces = j.topLeftCorner<3, 3>();
        spectrum = clamp_eigenvalues<3>(forces, -restoring, pushing);
        j.topLeftCorner<3, 3>() = forces;
    }
    const Square<6> even = 0.5 * (j + j.transpose());
    const double mean_work = (even.topLeftCorner<3, 3>().trace() * params.radius * params.radius +
                              even.bottomRightCorner<3, 3>().trace() * params.angle * params.angle) /
                             6;
    params.metres = metric.whole ? metric.metres : 0;
    params.core = widest_core;
    params.level = 0;
    double strength = 1;
    if (fades) {
        const double most = spectrum.largest();
        const Core core = core_within(largest, [&](double share) {
            return slope_of_edge(params, even, mean_work, metric, most, share);
        });
        params.core = core.share;
        params.stiffness = core.slope;
        params.level = core.strength * mean_work * std::pow(middle_of_edge(core.share), 2);
        strength = core.strength;
        params.force = to_plain(strength * to_eigen(params.force));
        params.torque = to_plain(strength * to_eigen(params.torque));
    } else {
        params.stiffness = slope_when_held(params, even, metric, spectrum);
        if (params.stiffness > largest) strength = largest / params.stiffness;
        params.stiffness = std::min(params.stiffness, largest);
    }
    if (strength < 1) j *= strength;
    params.jacobian = to_mat6(j);
    params.orientation = to_plain(to_eigen(params.orientation).normalized());
    params.reserved = 0;
    return params;
}

void adopt(const Taylor6&, const Taylor6*, Taylor6::State&, const Probe&) noexcept {}

Wrench evaluate(const Taylor6& params, Taylor6::State&, const Probe& probe, double) noexcept {
    const Vector3d d = probe.position - to_eigen(params.origin);
    const Vector3d turn = rotation_vector(probe.orientation * to_eigen(params.orientation).conjugate());
    const Vector3d force = to_eigen(params.force), torque = to_eigen(params.torque);
    if (params.edge == TaylorEdge::hold) {
        const Eigen::Matrix<double, 6, 1> change = held(params, d, turn);
        return {.force = force + change.head<3>(), .torque = torque + change.tail<3>()};
    }
    const double r = d.norm(), turned = turn.norm();
    const EdgeShare of_place = smooth_edge(r, params.core, params.radius),
                    of_turn = smooth_edge(turned, params.core, params.angle);
    const double share = of_place.value * of_turn.value;
    if (share == 0) return {};
    Eigen::Matrix<double, 6, 1> step;
    step << d, turn;
    const Eigen::Matrix<double, 6, 1> change = to_eigen(params.jacobian) * step;
    Wrench out{.force = share * (force + change.head<3>()), .torque = share * (torque + change.tail<3>())};
    if (of_place.slope == 0 && of_turn.slope == 0) return out;
    const double work = force.dot(d) + torque.dot(turn) + 0.5 * step.dot(change) - params.level;
    if (of_place.slope != 0) out.force += (of_place.slope * of_turn.value * work / r) * d;
    if (of_turn.slope != 0) out.torque += (of_place.value * of_turn.slope * work / turned) * turn;
    return out;
}

bool powerless(const Taylor6& params) noexcept {
    return params.force == Vec3{} && params.torque == Vec3{} && params.jacobian == Mat6{};
}

std::optional<Bound> bound(const Taylor6& params) noexcept {
    if (params.edge == TaylorEdge::hold) return std::nullopt;
    return Bound{.center = to_eigen(params.origin), .radius = params.radius};
}

namespace {

// Upper bound of the work that the field does from its origin, less `level`. With lengths relative to the
// radius and angles relative to the angle, no step is longer than sqrt 2.
double most_work(const Taylor6& params) noexcept {
    Eigen::Matrix<double, 6, 1> reach;
    reach << Vector3d::Constant(params.radius), Vector3d::Constant(params.angle);
    const Square<6> j = reach.asDiagonal() * to_eigen(params.jacobian) * reach.asDiagonal();
    const Square<6> even = 0.5 * (j + j.transpose());
    const double pushes =
        Eigen::SelfAdjointEigenSolver<Square<6>>(even, Eigen::EigenvaluesOnly).eigenvalues()(5);
    return std::max(0.0, to_eigen(params.force).norm() * params.radius +
                             to_eigen(params.torque).norm() * params.angle + std::max(0.0, pushes) -
                             params.level);
}

double energy_of(const Taylor6& params, const Vector3d& d, const Vector3d& turn) noexcept {
    const double share = params.edge == TaylorEdge::hold
                             ? 1
                             : smooth_edge(d.norm(), params.core, params.radius).value *
                                   smooth_edge(turn.norm(), params.core, params.angle).value;
    if (!(share > 0)) return 0;
    Eigen::Matrix<double, 6, 1> step;
    step << d, turn;
    const double work = to_eigen(params.force).dot(d) + to_eigen(params.torque).dot(turn) +
                        0.5 * step.dot(to_eigen(params.jacobian) * step) - params.level;
    return std::max(0.0, most_work(params) - share * work);
}

}  // namespace

// As in taylor.cpp.
HandLoad load(const Taylor6& params, const Taylor6::State&, const Probe& probe) noexcept {
    const Vector3d d = probe.position - to_eigen(params.origin);
    const Vector3d turn = rotation_vector(probe.orientation * to_eigen(params.orientation).conjugate());
    double left = params.stiffness;
    if (params.edge == TaylorEdge::fade)
        left *= load_left(d.norm(), params.radius) * load_left(turn.norm(), params.angle);
    HandLoad load = isotropic_load(left, 0);
    load.stiffness.bottomRightCorner<3, 3>().diagonal().setConstant(left * params.metres * params.metres);
    load.energy.held = energy_of(params, d, turn);
    return load;
}

}  // namespace knurl
