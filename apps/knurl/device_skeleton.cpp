// An arm in a posture as lines to draw.

#include "device_check.hpp"

namespace knurl::cli {

Lines skeleton(const CheckedArm& arm, const drivers::JointArray& q) {
    if (arm.chain) return view::skeleton(*arm.chain, q);
    drivers::TipPose pose;
    drivers::Jacobian jacobian;
    arm.profile.mechanism->forward({q.data(), 3}, pose, jacobian);
    return view::skeleton(*arm.delta, pose.position, q);
}

}  // namespace knurl::cli
