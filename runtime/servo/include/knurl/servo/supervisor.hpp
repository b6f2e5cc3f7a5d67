#pragma once
// The last gate before the motors, and the device's state machine. Scene code may be wrong; the hand must not
// notice. One list of stages, every cycle, in every state:
//
//   1 finite? else zero and fault -> device gain -> workspace
//   2 energy account (passivity observer)
//   3 slew gate: clips, counts, faults after 5 ms in a row
//   4 norm clamp -> thermal (I^2 t) -> J^T -> joint clamp, all joints together
//
// Works in device units; figures about methods are taken from the scene's wrench, before this.

#include <cstdint>

#include <knurl/drivers/device.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/wrench.hpp>
#include <knurl/servo/stages.hpp>

namespace knurl::servo {

/// What cannot be changed while the servo runs. Zero in the first block means "from the device".
struct SupervisorLimits {
    double peak_force = 0;        // N
    double continuous_force = 0;  // N: for ever; the peak is allowed for about `thermal_time`
    double peak_torque = 0;       // N m

    double thermal_time = 10;         // s
    double slew = 2000;               // N/s; a fault gate, never smoothing: 2000 or more
    double slew_fault_time = 5e-3;    // s of clipping in a row
    double speed_damping_from = 1.0;  // m/s: damping comes in
    double speed_fault = 1.5;         // m/s
    double speed_damping = 5.0;       // N s/m, per m/s above speed_damping_from and capped by stability
    double power = 5.0;               // W into the hand, mean over power_time
    double power_time = 50e-3;        // s
    double ramp_up = 0.5;             // s
    double ramp_down = 0.05;          // s
    double claim_ramp = 0.05;         // s, a claim's own gain
    double arm_speed = 0.2;           // m/s: arming and resetting wait for a hand slower than this
    double stall = 20e-3;             // s: a longer gap between cycles sets the gain to 0
    double clock_jump = 1.0;          // s: a longer gap is a fault
    double workspace_margin = 1.25;   // times the workspace radius: beyond, forces may not push outwards

    bool off = false;  // offline evaluation without a device: no stage changes anything
};

/// One cycle of the gate.
struct Supervised {
    drivers::JointEfforts efforts = {};
    Wrench sent;              // device frame, after all stages
    std::uint32_t flags = 0;  // report_flags::clamped
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

    // Requests, each answered at once. `none`: accepted.
    protocol::RefusalReason arm(bool calibrated, double speed) noexcept;
    void disarm() noexcept;  // ramp down, then idle; always allowed
    /// `trouble`: faults that would be raised again at once.
    protocol::RefusalReason reset_fault(double speed, std::uint32_t trouble = 0) noexcept;
    void raise(std::uint32_t fault_bits) noexcept;  // zero, latched
    void hold() noexcept;                           // a stall: gain 0 now, then the ordinary ramp up

    // What arm and reset_fault would answer. `after_reset`: as if the fault had been reset.
    protocol::RefusalReason may_arm(bool calibrated, double speed, bool after_reset = false) const noexcept;
    protocol::RefusalReason may_reset_fault(double speed, std::uint32_t trouble = 0) const noexcept;

    void disconnected() noexcept;  // no device any more: after the fault that said so
    void reconnected() noexcept;   // samples again: idle, or fault if another one is still latched
    void start_active() noexcept;  // offline evaluation: active with gain 1, now

    /// The whole output stage. `armed_claims`: how many claims want force; with none the device ramps down.
    Supervised supervise(const Wrench& sum, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
                         const drivers::Jacobian& jacobian, int joints, int armed_claims, double dt) noexcept;
    /// Instead of supervise, in a cycle without a pose: zero now, then on from zero.
    Supervised cut(int armed_claims, double dt) noexcept;

    DeviceState state() const noexcept { return state_; }
    /// Efforts other than zero may be sent.
    bool powered() const noexcept {
        return state_ == DeviceState::ramp_up || state_ == DeviceState::active ||
               state_ == DeviceState::ramp_down;
    }
    std::uint32_t faults() const noexcept { return faults_; }
    double gain() const noexcept { return gain_; }
    /// N, N m: device and configuration together; infinity: neither states one.
    double peak_force() const noexcept { return peak_force_; }
    double peak_torque() const noexcept { return peak_torque_; }
    double continuous_force() const noexcept { return continuous_force_; }

    struct Counts {
        std::uint64_t slew_clips = 0, force_clamps = 0, thermal_clamps = 0, joint_clamps = 0, faults = 0;
        double generated_energy = 0;  // J put into the hand since contact began, from the passivity observer
    };
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
