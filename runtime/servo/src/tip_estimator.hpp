#pragma once
// From joint samples to the hand's motion, in the device frame: which samples are accepted, where the tip is,
// how fast it moves.

#include <cstdint>

#include <knurl/drivers/device.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/servo/velocity.hpp>

#include "stage_clock.hpp"

namespace knurl::servo {

/// What a bad sample requires from the supervisor.
struct Trouble {
    bool unplugged = false;
    bool ramp_down = false;    // three bad samples in a row
    std::uint32_t faults = 0;  // ten bad samples in a row
};

class TipEstimator {
  public:
    static constexpr std::uint32_t bad_ramp_down = 3;  // in a row
    static constexpr std::uint32_t bad_fault = 10;
    static constexpr double stale_limit = 20e-3;  // s: a repeated sample older than this counts as bad
    // No hand moves this fast: the encoder has lost counts. 1.5 m/s already is a fault.
    static constexpr double impossible_speed = 10;  // m/s at the tip
    static constexpr double impossible_turn = 100;  // rad/s

    static constexpr double poor_conditioning = 0.05;  // drivers::conditioning: 1 in 20
    static constexpr double limit_share = 0.01;
    static constexpr std::uint32_t posture_every = 16;  // calls

    /// `trusting`: accepts every finite sample (offline evaluation along a given motion).
    TipEstimator(drivers::Device& device, bool trusting);

    /// Processes one reading. Afterwards the members below describe the hand in this cycle.
    Trouble read(Nanoseconds now, StageClock& stages) noexcept;
    /// After the write: states of the posture for the application, which do not affect the force. Every 16th
    /// call computes them.
    void look_at_posture() noexcept;

    drivers::JointSample sample;  // the last accepted one
    drivers::TipPose pose;
    drivers::Jacobian jacobian = drivers::Jacobian::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, first order 100 Hz: damping
    // m/s, adaptive window of 16 ms: friction, reports
    Eigen::Vector3d smooth_velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d slow_velocity = Eigen::Vector3d::Zero();     // m/s, first order 20 Hz: prediction
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
    // The device's sample of this cycle, accepted or not: for an input log.
    drivers::JointSample received;
    drivers::ReadStatus status{};
    bool connected = false;
    bool has_pose = false;        // this cycle: the mechanism had a pose for the sample
    bool stale = false;           // this cycle: no new sample
    bool near_singular = false;   // conditioning below `poor_conditioning`; needs three joints or more
    bool at_joint_limit = false;  // within `limit_share` of its range from a stop, or beyond it
    std::uint64_t bad_samples = 0, stale_samples = 0, kinematics_failures = 0;

    /// State kept between cycles, except counters: for an input log's keyframe (state_words.hpp).
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(sample.position, sample.velocity, sample.has_velocity, sample.calibrated, sample.buttons,
              pose.position, pose.orientation, jacobian, velocity, smooth_velocity, slow_velocity,
              angular_velocity, connected, has_pose, stale, near_singular, at_joint_limit, bad_in_row_,
              poseless_in_row_, since_posture_, last_good_, last_sample_, known_, damping_, slow_, turning_,
              smooth_);
    }

  private:
    Trouble believe(drivers::ReadStatus got, const drivers::JointSample& next, Nanoseconds now) noexcept;
    Trouble bad(std::uint32_t fault) noexcept;
    bool impossible(const drivers::JointSample& next, double gap) const noexcept;
    void restart() noexcept;
    bool place(double gap) noexcept;
    void differentiate(const drivers::TipPose& previous, double gap) noexcept;

    drivers::Device& device_;
    bool trusting_;
    std::size_t joints_;
    int driven_;
    drivers::JointArray near_least_, near_greatest_;       // rad: `at_joint_limit` outside
    Eigen::Matrix<double, drivers::max_joints, 1> count_;  // rad per count of each joint
    std::uint32_t bad_in_row_ = 0, poseless_in_row_ = 0, since_posture_ = posture_every;
    Nanoseconds last_good_ = 0, last_sample_ = 0;
    bool known_ = false;  // a sample and a pose are there for comparison
    FirstOrderVelocity damping_{100}, slow_{20}, turning_{100};
    AdaptiveVelocity smooth_;
};

}  // namespace knurl::servo
