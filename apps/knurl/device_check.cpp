#include "device_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <knurl/drivers/conditioning.hpp>
#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/reach.hpp>

namespace knurl::cli {

namespace {

using drivers::JointArray;
using Eigen::Vector3d;

constexpr int directions = 162;              // in which reach and force are computed
constexpr int places = 2000;                 // in the workspace
constexpr double step = 0.004;               // m along a ray
constexpr double farthest = 1.5;             // m
constexpr double poor = 20, singular = 100;  // condition

/// Evenly over a sphere: Fibonacci's spiral (Gonzalez 2010, Math. Geosci. 42).
Vector3d direction(int i, int count) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double out = std::sqrt(1 - z * z);
    return {out * std::cos(turn), out * std::sin(turn), z};
}

/// Van der Corput's sequence.
double halton(int i, int base) {
    double value = 0, share = 1;
    for (; i > 0; i /= base) {
        share /= base;
        value += share * (i % base);
    }
    return value;
}

struct Posture {
    JointArray joints = {};
    drivers::TipPose pose;
    drivers::Jacobian jacobian;
    double condition = 0;
};

int driven(const CheckedArm& arm) {
    return arm.profile.joints - arm.profile.passive_joints;
}

Posture posture_of(const CheckedArm& arm, const JointArray& joints) {
    Posture posture{.joints = joints, .pose = {}, .jacobian = drivers::Jacobian::Zero()};
    arm.profile.mechanism->forward({joints.data(), static_cast<std::size_t>(arm.profile.joints)},
                                   posture.pose, posture.jacobian);
    posture.condition = 1 / std::max(1e-9, drivers::conditioning(posture.jacobian, driven(arm)));
    return posture;
}

/// The limit that a posture violates; empty: none.
std::string overstepped(const CheckedArm& arm, const JointArray& q) {
    constexpr double grace = 1e-9;
    for (int i = 0; i < arm.profile.joints; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        if (q[axis] < arm.profile.least[axis] - grace || q[axis] > arm.profile.greatest[axis] + grace)
            return fmt::format("the limit of axis {} ({})", i + 1, arm.axis_names[axis]);
    }
    for (std::size_t row = 0; row < arm.row_limits.size(); ++row) {
        const double variable = arm.chain->variable(row, q);
        const drivers::Between& limits = arm.row_limits[row];
        if (variable < limits.least - grace || variable > limits.greatest + grace)
            return fmt::format("the limit of row {}", row + 1);
    }
    return {};
}

using WrenchVector = Eigen::Matrix<double, 6, 1>;  // force and torque

WrenchVector force_along(const Vector3d& u) {
    return (WrenchVector() << u, Vector3d::Zero()).finished();
}
WrenchVector torque_about(const Vector3d& u) {
    return (WrenchVector() << Vector3d::Zero(), u).finished();
}

/// Largest multiple (N, N m) of w before the first motor is at its limit: the efforts are J^T w.
double largest(const CheckedArm& arm, const Posture& posture, const std::vector<double>& limits,
               const WrenchVector& w) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < driven(arm); ++i) {
        const double share = std::abs(posture.jacobian.col(i).dot(w));
        if (share > 1e-12) least = std::min(least, limits[static_cast<std::size_t>(i)] / share);
    }
    return least;
}

/// Over all directions the force is least along the column of one motor: max over u of |J_i . u| is |J_i|. So
/// the linear programme over the box of efforts needs no solver.
Extreme weakest(const CheckedArm& arm, const Posture& posture, const std::vector<double>& limits, int* axis) {
    Extreme found{.value = std::numeric_limits<double>::infinity()};
    for (int i = 0; i < driven(arm); ++i) {
        const Vector3d lever = posture.jacobian.col(i).head<3>();
        const double force = limits[static_cast<std::size_t>(i)] / std::max(1e-12, lever.norm());
        if (force < found.value) {
            found = {.value = force, .where = lever.normalized()};
            if (axis != nullptr) *axis = i;
        }
    }
    return found;
}

/// The effect of one count of the coarsest axis: translation of the tip in m (rows from 0), or rotation in
/// rad (from 3).
double resolution(const CheckedArm& arm, const Posture& posture, int from = 0) {
    double most = 0;
    for (int i = 0; i < arm.profile.joints; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        const double stated = arm.profile.radians_per_count[axis];
        const double count = stated > 0 ? stated : arm.profile.quantum / arm.profile.lever[axis];
        most = std::max(most, count * posture.jacobian.col(i).segment<3>(from).norm());
    }
    return most;
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

}  // namespace

CheckedArm checked_arm(const std::string& name) {
    CheckedArm arm;
    if (name == "falcon") {
        arm.profile = drivers::sim_profile(name);
        arm.axis_names = {"leg 1", "leg 2", "leg 3"};
        arm.unlimited = arm.axis_names;
        arm.assumed = {"all dynamics and motors"};
        arm.delta = drivers::falcon_in_device_frame();
        return arm;
    }
    const drivers::ArmFile file = drivers::find_arm(name);
    arm.profile = drivers::sim_profile_of(file, &arm.assumed);
    arm.profile.description = file.description;
    arm.row_limits = file.row_limits;
    for (const drivers::ArmAxis& axis : file.axes) {
        arm.axis_names.push_back(axis.name);
        if (!axis.limits.known()) arm.unlimited.push_back(axis.name);
    }
    arm.figures = file.figures;
    arm.chain = file.table;
    return arm;
}

Ray ray(const CheckedArm& arm, const Vector3d& way) {
    Ray found;
    JointArray joints = arm.profile.centre;
    std::string stop;
    // Advances in whole steps as far as possible, then by halves of the last step.
    const auto advance = [&](double distance) {
        const auto next = drivers::reach(*arm.profile.mechanism, joints, distance * way);
        stop = next ? overstepped(arm, *next) : "the arm's length";
        if (!stop.empty()) return false;
        const Posture posture = posture_of(arm, *next);
        joints = *next;
        found.steps.push_back({distance * way, 1 / posture.condition});
        found.length = distance;
        return true;
    };
    for (double distance = 0; distance < farthest; distance += step) {
        if (advance(distance)) continue;
        found.stop = stop;
        for (double half = step / 2; half > 1e-5; half /= 2) {
            if (!advance(found.length + half)) found.stop = stop;
        }
        break;
    }
    return found;
}

namespace {

/// How far the arm reaches, along rays from its centre.
void find_size(const CheckedArm& arm, ArmCheck& result) {
    result.ball = farthest;
    for (int i = 0; i < directions; ++i) {
        const Vector3d way = direction(i, directions);
        const Ray along = ray(arm, way);
        result.low = result.low.cwiseMin(along.length * way);
        result.high = result.high.cwiseMax(along.length * way);
        if (along.length < result.ball) {
            result.ball = along.length;
            result.ball_end = way;
            result.ball_stop = along.stop;
        }
        for (const Reached& reached : along.steps) {
            const double distance = reached.position.norm();
            if (reached.conditioning * singular < 1 &&
                (!result.singular || distance < result.singular->value))
                result.singular = Extreme{.value = distance, .where = reached.position};
        }
    }
}

/// The largest effort of each axis (N, N m).
std::vector<double> limits_of(const CheckedArm& arm) {
    const drivers::SimProfile& profile = arm.profile;
    std::vector<double> limits;
    for (int i = 0; i < driven(arm); ++i) {
        const auto axis = static_cast<std::size_t>(i);
        const double stated = profile.effort_limit[axis];
        limits.push_back(stated > 0 ? stated : profile.peak_force * profile.largest_lever[axis]);
    }
    return limits;
}

/// Forces, torques and resolution at the centre.
void check_centre(const CheckedArm& arm, const std::vector<double>& limits, ArmCheck& result) {
    const drivers::SimProfile& profile = arm.profile;
    const Posture centre = posture_of(arm, profile.centre);
    int axis = 0;
    result.weakest_at_centre = weakest(arm, centre, limits, &axis);
    result.weakest_axis = arm.axis_names[static_cast<std::size_t>(axis)];
    for (int i = 0; i < 3; ++i)
        result.along_axes[i] = largest(arm, centre, limits, force_along(Vector3d::Unit(i)));
    for (int i = 0; i < directions; ++i) {
        const Vector3d way = direction(i, directions);
        result.every_way_at_centre.push_back(
            {.value = largest(arm, centre, limits, force_along(way)), .where = way});
    }
    for (int i = 0; i < places; ++i) {
        const Vector3d way = direction(i, places);
        const double force = largest(arm, centre, limits, force_along(way));
        if (std::isfinite(force) && force > result.strongest_at_centre.value)
            result.strongest_at_centre = {.value = force, .where = way};
    }
    result.resolution_at_centre = resolution(arm, centre);
    if (profile.renders_torque) {
        for (int i = 0; i < 3; ++i)
            result.torque_about_axes[i] = largest(arm, centre, limits, torque_about(Vector3d::Unit(i)));
        result.angular_resolution = resolution(arm, centre, 3);
    }
}

/// The same at places spread over the workspace.
void check_places(const CheckedArm& arm, const std::vector<double>& limits, ArmCheck& result) {
    const drivers::SimProfile& profile = arm.profile;
    result.best_condition.value = result.weakest_anywhere.value = std::numeric_limits<double>::infinity();
    std::vector<double> conditions, resolutions;
    int missed = 0, poorly = 0;
    for (int i = 0; i < places; ++i) {
        const double distance = profile.workspace_radius * std::cbrt(halton(i + 1, 2));
        const Vector3d place = distance * direction(i, places);
        const auto joints = drivers::reach(*profile.mechanism, profile.centre, place);
        if (!joints || !overstepped(arm, *joints).empty()) {
            ++missed;
            continue;
        }
        const Posture here = posture_of(arm, *joints);
        conditions.push_back(here.condition);
        if (here.condition > poor) ++poorly;
        if (here.condition < result.best_condition.value) result.best_condition = {here.condition, place};
        if (here.condition > result.worst_condition.value) result.worst_condition = {here.condition, place};
        const double force = weakest(arm, here, limits, nullptr).value;
        if (force < result.weakest_anywhere.value) result.weakest_anywhere = {force, place};
        resolutions.push_back(resolution(arm, here));
        if (resolutions.back() > result.worst_resolution.value)
            result.worst_resolution = {resolutions.back(), place};
    }
    result.out_of_reach = static_cast<double>(missed) / places;
    result.badly_conditioned = static_cast<double>(poorly) / places;
    result.median_condition.value = median(conditions);
    result.median_resolution = median(resolutions);
}

}  // namespace

ArmCheck check(const CheckedArm& arm) {
    ArmCheck result;
    find_size(arm, result);
    const std::vector<double> limits = limits_of(arm);
    check_centre(arm, limits, result);
    check_places(arm, limits, result);
    return result;
}

}  // namespace knurl::cli
