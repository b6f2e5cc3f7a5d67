#pragma once

/// @file
/// The simulated device: joint-space dynamics, encoders, actuators and a hand, driven by the caller's clock.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// Faults for tests, by the number of the read (the first is 0; -1: never). What they do to a sample ends
/// with them; only unplugging lasts, until `replug_at`.
struct SimFaults {
    /// Read from which on reads say unplugged, writes fail and motors are off.
    std::int64_t unplug_at = -1;
    /// Read at which that ends.
    std::int64_t replug_at = -1;
    /// Read from which on there is no new sample.
    std::int64_t stale_at = -1;
    /// For so many reads.
    std::int64_t stale_reads = 1;
    /// Read from which on garbage arrives.
    std::int64_t bad_at = -1;
    /// For so many reads.
    std::int64_t bad_reads = 1;
    /// Read from which on a sample that says ok has a NaN in joint 0.
    std::int64_t nan_at = -1;
    /// For so many reads.
    std::int64_t nan_reads = 1;
    /// Read from which on the encoder of jump_joint is off by `jump`.
    std::int64_t jump_at = -1;
    /// For so many reads.
    std::int64_t jump_reads = 1;
    /// Joint whose encoder jumps.
    int jump_joint = 0;
    /// By how much it jumps (rad, m).
    double jump = 0.5;
    /// Read from which on `calibrated` is false.
    std::int64_t unhomed_at = -1;
    /// For so many reads.
    std::int64_t unhomed_reads = 1;
};

/// The truth, unquantised, as of the last read. Device frame, SI.
struct SimState {
    /// Simulated time since the first read (s).
    double t = 0;
    /// Positions of the joints (rad, m).
    JointArray joints = {};
    /// Velocities of the joints (rad/s, m/s).
    JointArray rates = {};
    /// Efforts that the actuators exert, after lag and limits (N m, N).
    JointArray efforts = {};
    /// Position of the tip (m).
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    /// Orientation of the tip.
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    /// Velocity of the tip (m/s).
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    /// Angular velocity of the tip (rad/s).
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
    /// Force of `efforts` at the tip (N).
    Eigen::Vector3d motor_force = Eigen::Vector3d::Zero();
    /// Force of the hand on the tip (N).
    Eigen::Vector3d hand_force = Eigen::Vector3d::Zero();
    /// Position that the hand intends (m).
    Eigen::Vector3d hand_wants = Eigen::Vector3d::Zero();
    /// Kinetic energy (J).
    double kinetic_energy = 0;
    /// Work that the hand received since the first read (J); its own work is negative.
    double energy_to_hand = 0;
    /// Work that the actuators did (J).
    double motor_work = 0;
    /// Largest motor_force at any sub-step (N).
    double peak_motor_force = 0;
    /// Reads so far.
    std::uint64_t reads = 0;
    /// Writes so far.
    std::uint64_t writes = 0;
    /// Writes that held something not finite; it was taken as zero.
    std::uint64_t refused_efforts = 0;
    /// Times that the device's own watchdog switched the motors off.
    std::uint64_t watchdog_trips = 0;
    /// Time that was not simulated (ns): gaps longer than max_catch_up.
    std::int64_t skipped = 0;
};

/// `read(now)` integrates from the now before it, with the efforts written last, in sub-steps of
/// gap / ceil(gap / 100 us), semi-implicit. So the virtual clock and the wall clock are the same code, and
/// the same calls give the same bits. One thread at a time.
///
/// The hand: without a motion it holds the tip where it began (the workspace's centre). With one, which is in
/// the DEVICE frame, the device begins at the motion's start and the hand rests there; it plays the motion
/// from its beginning after each Notice::claim_active, and goes back to the start after Notice::disabled.
/// Where it is not at the start when it begins, the difference fades within `return_time`.
class SimDevice final : public Device {
  public:
    /// Longest sub-step (ns).
    static constexpr Nanoseconds max_sub_step = 100'000;
    /// Longest time that one read simulates (ns); what is beyond never happens.
    static constexpr Nanoseconds max_catch_up = 50'000'000;

    /// Throws std::runtime_error if the motion's start cannot be reached.
    explicit SimDevice(SimProfile profile, const std::optional<Motion>& hand = {});
    ~SimDevice() override;

    /// As of Device.
    const LinkConfig& link() const noexcept override;
    /// As of Device.
    const Mechanism& mechanism() const noexcept override;
    /// As of Device.
    bool has_buttons() const noexcept override;
    /// As of Device; simulates up to `now`.
    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override;
    /// As of Device.
    bool write(Nanoseconds now, const JointEfforts& efforts) noexcept override;
    /// As of Device.
    void notify(Notice notice) noexcept override;
    /// Nothing: this device lives inside its process and dies with it; a guardian holds only a copy.
    void make_safe() noexcept override {}

    /// The truth as of the last read.
    const SimState& state() const noexcept;
    /// FNV-1a over the bits of joints, rates, efforts and time, all reads so far.
    std::uint64_t digest() const noexcept;

    /// Grip of the hand (0 to 1) from the next read on. LinkConfig's grip_damping follows: call it on the
    /// thread that reads.
    void set_grip(double grip) noexcept;
    /// Faults that are to come.
    SimFaults& faults() noexcept;
    /// Puts the arm into this posture, with these joint rates; motors and lag at zero. For tests.
    void place(const JointArray& joints, const JointArray& rates = {}) noexcept;
    /// What it is made of.
    const SimProfile& profile() const noexcept;

  private:
    struct Body;
    std::unique_ptr<Body> body_;
};

/// The driver of "sim:PROFILE[,OPTION=VALUE...]".
Driver sim_driver();

}  // namespace knurl::drivers
