#pragma once

/// @file
/// The last gate before the motors, and the device's state machine. Scene code may be wrong; the hand must
/// not notice. One list of stages, every cycle, in every state:
///
///     1 finite? else zero and fault -> device gain -> workspace
///     2 energy account (passivity observer)
///     3 slew gate: clips, counts, faults after 5 ms in a row
///     4 norm clamp -> thermal (I^2 t) -> J^T -> joint clamp, all joints together
///
/// Works in device units; figures about methods are taken from the scene's wrench, before this.

#include <cstdint>

#include <knurl/drivers/device.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/wrench.hpp>
#include <knurl/servo/stages.hpp>

namespace knurl::servo {

/// What cannot be changed while the servo runs. 0 in the first three fields means "from the device".
struct SupervisorLimits {
    /// Peak force (N); 0: the device's.
    double peak_force = 0;
    /// Force that is allowed without end (N), while the peak is allowed for about `thermal_time`; 0: the
    /// device's.
    double continuous_force = 0;
    /// Peak torque (N m); 0: the device's.
    double peak_torque = 0;

    /// How long a cold motor may give the peak force (s).
    double thermal_time = 10;
    /// Largest rate of the force (N/s), 2000 or more: a fault gate, never smoothing.
    double slew = 2000;
    /// Clipping in a row that is a fault (s).
    double slew_fault_time = 5e-3;
    /// Speed of the hand from which on it is damped (m/s).
    double speed_damping_from = 1.0;
    /// Speed of the hand that is a fault (m/s).
    double speed_fault = 1.5;
    /// That damping (N s/m) per m/s above speed_damping_from, capped by stability.
    double speed_damping = 5.0;
    /// Largest power into the hand (W), mean over power_time.
    double power = 5.0;
    /// Window of that mean (s).
    double power_time = 50e-3;
    /// Time of the ramp up (s).
    double ramp_up = 0.5;
    /// Time of the ramp down (s).
    double ramp_down = 0.05;
    /// Time in which a claim's own gain comes in and goes out (s).
    double claim_ramp = 0.05;
    /// Arming and resetting wait for a hand slower than this (m/s).
    double arm_speed = 0.2;
    /// A longer gap between cycles sets the gain to 0 (s).
    double stall = 20e-3;
    /// A longer gap between cycles is a fault (s).
    double clock_jump = 1.0;
    /// Beyond so many workspace radii forces may not push outwards (1).
    double workspace_margin = 1.25;

    /// True: no stage changes anything (offline evaluation without a device).
    bool off = false;
};

/// One cycle of the gate.
struct Supervised {
    /// Efforts of the joints.
    drivers::JointEfforts efforts = {};
    /// Wrench after all stages, device frame.
    Wrench sent;
    /// report_flags::clamped, or 0.
    std::uint32_t flags = 0;
};

/// The state machine. `fault` and `disconnected` are reached from anywhere.
///
///   disconnected --sample--> idle --arm--> armed --slow hand--> ramp_up --gain 1--> active
///                             ^              |                     |                  |
///                             |         none armed          disarm, none armed   disarm, none armed
///                             +--------------+                     v                  v
///                             +-------------------gain 0------- ramp_down <-----------+
///   fault --reset, slow hand, cause gone--> idle        (arm during ramp_down: armed, once the gain is 0)
class Supervisor {
  public:
    /// `rate` in Hz bounds the speed damping by stability; 0: the link's nominal rate.
    Supervisor(const drivers::LinkConfig& link, const SupervisorLimits& limits, double rate = 0);

    /// Allows force. `speed` of the hand in m/s. Answered at once; `none`: accepted.
    protocol::RefusalReason arm(bool calibrated, double speed) noexcept;
    /// Ramps down, then idle; always allowed.
    void disarm() noexcept;
    /// Leaves a fault. `trouble`: faults that would be raised again at once.
    protocol::RefusalReason reset_fault(double speed, std::uint32_t trouble = 0) noexcept;
    /// A fault: zero, latched.
    void raise(std::uint32_t fault_bits) noexcept;
    /// A stall: gain 0 now, then the ordinary ramp up.
    void hold() noexcept;

    /// What `arm` would answer. `after_reset`: as if the fault had been reset.
    protocol::RefusalReason may_arm(bool calibrated, double speed, bool after_reset = false) const noexcept;
    /// What `reset_fault` would answer.
    protocol::RefusalReason may_reset_fault(double speed, std::uint32_t trouble = 0) const noexcept;

    /// There is no device any more: after the fault that said so.
    void disconnected() noexcept;
    /// There are samples again: idle, or fault if another one is still latched.
    void reconnected() noexcept;
    /// Active with gain 1, now (offline evaluation).
    void start_active() noexcept;

    /// The whole output stage. `armed_claims`: how many claims want force; with none the device ramps down.
    Supervised supervise(const Wrench& sum, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
                         const drivers::Jacobian& jacobian, int joints, int armed_claims, double dt) noexcept;
    /// Instead of supervise, in a cycle without a pose: zero now, then on from zero.
    Supervised cut(int armed_claims, double dt) noexcept;

    /// State of the device.
    DeviceState state() const noexcept { return state_; }
    /// True: efforts other than zero may be sent.
    bool powered() const noexcept {
        return state_ == DeviceState::ramp_up || state_ == DeviceState::active ||
               state_ == DeviceState::ramp_down;
    }
    /// Bit mask of latched faults (knurl::fault).
    std::uint32_t faults() const noexcept { return faults_; }
    /// Gain of the device, 0 to 1.
    double gain() const noexcept { return gain_; }
    /// Peak force (N), of device and configuration together; infinity: neither states one.
    double peak_force() const noexcept { return peak_force_; }
    /// Peak torque (N m), likewise.
    double peak_torque() const noexcept { return peak_torque_; }
    /// Continuous force (N), likewise.
    double continuous_force() const noexcept { return continuous_force_; }

    /// How often a stage acted.
    struct Counts {
        /// Cycles in which the slew gate clipped.
        std::uint64_t slew_clips = 0;
        /// Clamps of force or torque to its peak.
        std::uint64_t force_clamps = 0;
        /// Cycles in which the thermal limit clamped the force.
        std::uint64_t thermal_clamps = 0;
        /// Cycles in which the joint efforts were clamped.
        std::uint64_t joint_clamps = 0;
        /// Faults.
        std::uint64_t faults = 0;
        /// Energy put into the hand since contact began (J), by the passivity observer.
        double generated_energy = 0;
    };
    /// How often a stage acted.
    const Counts& counts() const noexcept { return counts_; }

    /// What is remembered between cycles, but for the counts: for an input log's keyframe (state_words.hpp).
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(state_, faults_, gain_, arm_again_, power_, energy_, slew_, thermal_, sent_force_,
              last_position_, moved_);
    }

  private:
    void advance_state(double speed, int armed_claims, double dt) noexcept;
    void account(const Eigen::Vector3d& position, double dt) noexcept;
    void damp_speed(Wrench& w, const Eigen::Vector3d& velocity) const noexcept;
    void keep_inside(Wrench& w, const Eigen::Vector3d& position) const noexcept;
    Supervised limit_and_map(Wrench w, const drivers::Jacobian& jacobian, int joints, double dt) noexcept;
    Supervised nothing(double dt) noexcept;

    drivers::LinkConfig link_;
    SupervisorLimits limits_;
    DeviceState state_ = DeviceState::idle;
    std::uint32_t faults_ = 0;
    double gain_ = 0;
    bool arm_again_ = false;  // armed while ramping down
    Counts counts_;

    double peak_force_, continuous_force_, peak_torque_, damping_cap_;
    bool torque_;  // rendered
    PowerMeter power_;
    PassivityObserver energy_;
    SlewGate slew_;
    ThermalLimit thermal_;
    Eigen::Vector3d sent_force_ = Eigen::Vector3d::Zero();     // of the last cycle
    Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero();  // m
    bool moved_ = false;                                       // last_position_ is known
};

}  // namespace knurl::servo
