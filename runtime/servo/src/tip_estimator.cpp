#include "tip_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <knurl/drivers/conditioning.hpp>

namespace knurl::servo {

using drivers::JointSample;
using drivers::ReadStatus;

TipEstimator::TipEstimator(drivers::Device& device, bool trusting)
    : device_(device),
      trusting_(trusting),
      joints_(static_cast<std::size_t>(std::clamp(device.mechanism().joints(), 0, drivers::max_joints))) {
    const std::vector<double>& counts = device.link().radians_per_count;
    for (std::size_t i = 0; i < drivers::max_joints; ++i)
        count_[static_cast<Eigen::Index>(i)] = i < counts.size() ? std::abs(counts[i]) : 0;
    const drivers::LinkConfig& link = device.link();
    driven_ = link.actuated_joints > 0 ? link.actuated_joints : link.sensed_joints;
    for (std::size_t i = 0; i < drivers::max_joints; ++i) {
        const double least = link.joint_least[i], greatest = link.joint_greatest[i];
        // In an unbounded range the joint is never near a stop.
        const double near = std::isfinite(greatest - least) ? limit_share * (greatest - least) : 0;
        near_least_[i] = least + near;
        near_greatest_[i] = greatest - near;
    }
}

Trouble TipEstimator::read(Nanoseconds now, StageClock& stages) noexcept {
    received = sample;
    status = device_.read(now, received);
    stages.end(Stage::read);
    const Trouble trouble = believe(status, received, now);
    stages.end(Stage::kinematics);
    return trouble;
}

Trouble TipEstimator::believe(ReadStatus got, const JointSample& next, Nanoseconds now) noexcept {
    stale = false;
    has_pose = false;
    // A device counts as connected from its first good sample on. Until then its position is unknown, and
    // what was known before it was unplugged (its homing too) no longer holds.
    if (got == ReadStatus::unplugged || (!connected && got != ReadStatus::ok)) {
        connected = false;
        sample.calibrated = false;
        if (got == ReadStatus::bad) ++bad_samples;
        restart();
        return {.unplugged = true};
    }
    const bool first = !connected;
    connected = true;
    const double gap = first ? 0 : static_cast<double>(now - last_good_) * 1e-9;
    // How far a hand can have moved since the last sample, accepted or not. Else a jump would become
    // plausible by being rejected for long enough. A repeated sample does not count.
    const double since_sample = first ? 0 : static_cast<double>(now - last_sample_) * 1e-9;
    if (got != ReadStatus::stale) last_sample_ = now;

    bool finite = true;
    for (std::size_t i = 0; i < joints_; ++i)
        finite = finite && std::isfinite(next.position[i]) &&
                 (!next.has_velocity || std::isfinite(next.velocity[i]));
    if (got == ReadStatus::bad || !finite) return bad(fault::bad_samples);
    if (got == ReadStatus::stale) {
        ++stale_samples;
        stale = true;
        has_pose = known_;
        return gap > stale_limit ? bad(fault::bad_samples) : Trouble{};
    }
    // Homing has just set the encoders' origin, so earlier positions are not comparable.
    if (next.calibrated && !sample.calibrated) restart();
    if (!trusting_ && impossible(next, since_sample)) {
        const Trouble trouble = bad(fault::encoder_jump);
        // The joints stay there: after a reset of the fault this is their position.
        if (trouble.faults != 0) {
            sample = next;
            last_good_ = now;
            restart();
        }
        return trouble;
    }
    bad_in_row_ = 0;
    sample = next;
    last_good_ = now;
    if (place(gap)) {
        poseless_in_row_ = 0;
        return {};
    }
    ++kinematics_failures;
    return {.faults = ++poseless_in_row_ >= bad_fault ? fault::kinematics : 0};
}

Trouble TipEstimator::bad(std::uint32_t fault) noexcept {
    ++bad_samples;
    bad_in_row_ = std::min(bad_in_row_ + 1, bad_fault);
    has_pose = known_;  // the old sample's
    return {.ramp_down = bad_in_row_ >= bad_ramp_down, .faults = bad_in_row_ >= bad_fault ? fault : 0};
}

bool TipEstimator::impossible(const JointSample& next, double gap) const noexcept {
    if (!known_) return false;
    Eigen::Matrix<double, drivers::max_joints, 1> change =
        Eigen::Matrix<double, drivers::max_joints, 1>::Zero();
    for (std::size_t i = 0; i < joints_; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        // Two counts of tolerance: they are no motion.
        change[row] = std::max(0.0, std::abs(next.position[i] - sample.position[i]) - 2 * count_[row]);
    }
    // Per joint, with the last Jacobian: in a sum two jumps could cancel.
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(joints_); ++i)
        if (change[i] * jacobian.col(i).head<3>().norm() > impossible_speed * gap ||
            change[i] * jacobian.col(i).tail<3>().norm() > impossible_turn * gap)
            return true;
    return false;
}

void TipEstimator::restart() noexcept {
    known_ = near_singular = at_joint_limit = false;
    since_posture_ = posture_every;
    damping_.reset();
    slow_.reset();
    turning_.reset();
    smooth_.reset();
    velocity.setZero();
    smooth_velocity.setZero();
    slow_velocity.setZero();
    angular_velocity.setZero();
}

bool TipEstimator::place(double gap) noexcept {
    drivers::TipPose next;
    drivers::Jacobian next_jacobian = drivers::Jacobian::Zero();
    if (!device_.mechanism().forward(std::span<const double>(sample.position.data(), joints_), next,
                                     next_jacobian) ||
        !next.position.allFinite() || !next.orientation.coeffs().allFinite() || !next_jacobian.allFinite())
        return false;
    const drivers::TipPose previous = pose;
    pose = next;
    jacobian = next_jacobian;
    has_pose = true;
    differentiate(previous, gap);
    known_ = true;
    return true;
}

void TipEstimator::look_at_posture() noexcept {
    if (!known_ || ++since_posture_ < posture_every) return;
    since_posture_ = 0;
    // With fewer joints than directions there is no such posture: the device moves along a line or a surface.
    near_singular = driven_ >= 3 && drivers::conditioning(jacobian, driven_) < poor_conditioning;
    at_joint_limit = false;
    for (std::size_t i = 0; i < joints_; ++i)
        at_joint_limit |= sample.position[i] <= near_least_[i] || sample.position[i] >= near_greatest_[i];
}

void TipEstimator::differentiate(const drivers::TipPose& previous, double gap) noexcept {
    Eigen::Vector3d raw = Eigen::Vector3d::Zero();
    if (sample.has_velocity) {
        const Eigen::Map<const Eigen::Matrix<double, drivers::max_joints, 1>> rates(sample.velocity.data());
        const auto n = static_cast<Eigen::Index>(joints_);
        raw = jacobian.topRows<3>().leftCols(n) * rates.head(n);
        velocity = smooth_velocity = raw;
        angular_velocity = jacobian.bottomRows<3>().leftCols(n) * rates.head(n);
    } else {
        // The band of the adaptive window: one count of every joint, as its motion of the tip along this
        // axis.
        const Eigen::Vector3d band =
            jacobian.topRows<3>().cwiseAbs() * count_ + Eigen::Vector3d::Constant(1e-9);
        smooth_.add(pose.position, band, gap);
        smooth_velocity = smooth_.value();
    }
    if (!known_ || !(gap > 0)) return;
    if (!sample.has_velocity) {
        raw = (pose.position - previous.position) / gap;
        damping_.add(raw, gap);
        velocity = damping_.value();
        Eigen::Quaterniond turn = pose.orientation * previous.orientation.conjugate();
        if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
        turning_.add(2 / gap * turn.vec(), gap);  // small angles: sin(a/2) = a/2
        angular_velocity = turning_.value();
    }
    slow_.add(raw, gap);
    slow_velocity = slow_.value();
}

}  // namespace knurl::servo
