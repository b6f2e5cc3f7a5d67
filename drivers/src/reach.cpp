#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include <knurl/drivers/reach.hpp>

#include "rotation_vector.hpp"

namespace knurl::drivers {

std::optional<JointArray> reach(const Mechanism& mechanism, const JointArray& from,
                                const Eigen::Vector3d& position,
                                const std::optional<Eigen::Quaterniond>& orientation) {
    constexpr int steps = 300;
    constexpr double longest = 0.02;  // m and, times ten, rad per step
    const auto joints = static_cast<std::size_t>(mechanism.joints());
    JointArray q = from;
    TipPose pose;
    Jacobian jacobian;
    for (int step = 0; step < steps; ++step) {
        if (!mechanism.forward({q.data(), joints}, pose, jacobian)) {
            break;
        }
        Eigen::Matrix<double, 6, 1> miss = Eigen::Matrix<double, 6, 1>::Zero();
        miss.head<3>() = position - pose.position;
        if (orientation) {
            miss.tail<3>() = rotation_vector(pose.orientation, *orientation) * 0.1;
            jacobian.bottomRows<3>() *= 0.1;
        } else {
            jacobian.bottomRows<3>().setZero();
        }
        if (miss.norm() < 1e-12) {
            return q;
        }
        miss *= std::min(1.0, longest / miss.norm());
        const Eigen::Matrix<double, 6, 6> square =
            jacobian * jacobian.transpose() + 1e-12 * Eigen::Matrix<double, 6, 6>::Identity();
        const Eigen::Matrix<double, 8, 1> change = jacobian.transpose() * square.ldlt().solve(miss);
        for (std::size_t i = 0; i < joints; ++i) {
            q[i] += change[static_cast<Eigen::Index>(i)];
        }
    }
    if ((position - pose.position).norm() < 1e-9 &&
        (!orientation || pose.orientation.angularDistance(*orientation) < 1e-6)) {
        return q;
    }
    return {};
}

}  // namespace knurl::drivers
