#pragma once
// The simulated device: joint-space dynamics, encoders, actuators and a hand, driven by the caller's clock.

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
    std::int64_t unplug_at = -1, replug_at = -1;  // reads say unplugged, writes fail, motors are off
    std::int64_t stale_at = -1, stale_reads = 1;  // no new sample
    std::int64_t bad_at = -1, bad_reads = 1;      // garbage arrived
    std::int64_t nan_at = -1, nan_reads = 1;      // a NaN in joint 0 of a sample that says ok
    std::int64_t jump_at = -1, jump_reads = 1;    // encoder of jump_joint is off by jump
    int jump_joint = 0;
    double jump = 0.5;                                // rad (m)
    std::int64_t unhomed_at = -1, unhomed_reads = 1;  // calibrated is false
};

/// The truth, unquantised, as of the last read. Device frame, SI.
struct SimState {
    double t = 0;             // s simulated since the first read
    JointArray joints = {};   // rad (m)
    JointArray rates = {};    // rad/s
    JointArray efforts = {};  // N m (N), what the actuators really exert, after lag and limits
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d motor_force = Eigen::Vector3d::Zero();  // N at the tip, from the efforts above
    Eigen::Vector3d hand_force = Eigen::Vector3d::Zero();   // N, of the hand on the tip
    Eigen::Vector3d hand_wants = Eigen::Vector3d::Zero();   // m, the intended position
    double kinetic_energy = 0;                              // J
    double energy_to_hand = 0;    // J, work that the hand received since the first read (its own is negative)
    double motor_work = 0;        // J, work that the actuators did
    double peak_motor_force = 0;  // N, largest |motor_force| at any sub-step
    std::uint64_t reads = 0, writes = 0;
    std::uint64_t refused_efforts = 0;  // writes that held something not finite: taken as zero
    std::uint64_t watchdog_trips = 0;   // times that the device's own watchdog switched the motors off
    std::int64_t skipped = 0;           // ns of time that were not simulated: gaps longer than max_catch_up
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
    static constexpr Nanoseconds max_sub_step = 100'000;     // ns
    static constexpr Nanoseconds max_catch_up = 50'000'000;  // ns in one read; what is beyond never happens

    /// Throws std::runtime_error if the motion's start cannot be reached.
    explicit SimDevice(SimProfile profile, const std::optional<Motion>& hand = {});
    ~SimDevice() override;

    const LinkConfig& link() const noexcept override;
    const Mechanism& mechanism() const noexcept override;
    bool has_buttons() const noexcept override;
    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override;
    bool write(Nanoseconds now, const JointEfforts& efforts) noexcept override;
    void notify(Notice notice) noexcept override;
    /// Nothing: this device lives inside its process and dies with it; a guardian holds only a copy.
    void make_safe() noexcept override {}

    const SimState& state() const noexcept;
    /// FNV-1a over the bits of joints, rates, efforts and time, all reads so far.
    std::uint64_t digest() const noexcept;

    /// From the next read on. LinkConfig's grip_damping follows: call it on the thread that reads.
    void set_grip(double grip) noexcept;
    SimFaults& faults() noexcept;
    /// Puts the arm there, with those joint rates; motors and lag at zero. For tests.
    void place(const JointArray& joints, const JointArray& rates = {}) noexcept;
    const SimProfile& profile() const noexcept;

  private:
    struct Body;
    std::unique_ptr<Body> body_;
};

/// Scheme "sim": "sim:PROFILE[,OPTION=VALUE...]".
Driver sim_driver();

}  // namespace knurl::drivers
