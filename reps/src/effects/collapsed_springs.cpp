#include <knurl/reps/collapsed_springs.hpp>

namespace knurl {
namespace {

// One row of a rotation, in scalars: GCC 12 spends more time on shuffling Eigen's pairs than on the products.
struct Row {
    double x, y, z;
    double operator*(const Eigen::Vector3d& v) const noexcept { return x * v.x() + y * v.y() + z * v.z(); }
};

}  // namespace

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
    for (std::size_t i = 0; i < 3; ++i) moments_[i] += pull[static_cast<Eigen::Index>(i)] * attach;
}

Wrench CollapsedSprings::evaluate(const Probe& probe) const noexcept {
    const double dx = probe.position.x() - origin_.x(), dy = probe.position.y() - origin_.y(),
                 dz = probe.position.z() - origin_.z();
    Wrench out;
    out.force = {anchors_.x() - stiffness_ * dx, anchors_.y() - stiffness_ * dy,
                 anchors_.z() - stiffness_ * dz};
    if (!turns_) return out;

    const double w = probe.orientation.w(), x = probe.orientation.x(), y = probe.orientation.y(),
                 z = probe.orientation.z();
    const Row r0{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)};
    const Row r1{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)};
    const Row r2{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    const double bx = r0 * attached_, by = r1 * attached_, bz = r2 * attached_;
    out.force.x() -= bx, out.force.y() -= by, out.force.z() -= bz;
    out.torque = {r1 * moments_[2] - r2 * moments_[1] - (by * dz - bz * dy),
                  r2 * moments_[0] - r0 * moments_[2] - (bz * dx - bx * dz),
                  r0 * moments_[1] - r1 * moments_[0] - (bx * dy - by * dx)};
    return out;
}

}  // namespace knurl
