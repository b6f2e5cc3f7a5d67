#include <cmath>
#include <limits>

#include <knurl/reps/collapsed_springs.hpp>

namespace knurl {

void CollapsedSprings::add(const Spring& spring, const Vec3& anchor_now, double weight) noexcept {
    if (count_++ == 0) origin_ = to_eigen(anchor_now);
    const double k = weight * spring.stiffness;
    const Eigen::Vector3d pull = k * (to_eigen(anchor_now) - origin_);
    stiffness_ += k;
    anchors_ += pull;
    if (spring.attach == Vec3{}) return;
    turns_ = true;
    const Eigen::Vector3d attach = to_eigen(spring.attach);
    attached_ += k * attach;
    moments_ += attach * pull.transpose();
}

Wrench CollapsedSprings::evaluate(const Probe& probe, const Limits& limits) const noexcept {
    const Eigen::Vector3d d = probe.position - origin_;
    Wrench out;
    out.force = anchors_ - stiffness_ * d;
    if (!turns_) return out;
    const Eigen::Matrix3d turn = probe.orientation.toRotationMatrix();
    const Eigen::Matrix3d moments = moments_ - attached_ * d.transpose();
    const Eigen::Matrix3d w = turn * moments;
    out.force -= turn * attached_;
    out.torque = {w(1, 2) - w(2, 1), w(2, 0) - w(0, 2), w(0, 1) - w(1, 0)};
    if (limits.max_torsion < std::numeric_limits<double>::infinity()) {
        const double torsion = moments.norm();
        if (torsion > limits.max_torsion) out.torque *= std::max(0.0, limits.max_torsion) / torsion;
    }
    return out;
}

}  // namespace knurl
