#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <knurl/servo/supervisor.hpp>

namespace knurl::servo {

using protocol::RefusalReason;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The smaller of the device's and the configuration's value; 0: not stated.
double tighter(double device, double configured) {
    if (device > 0 && configured > 0) return std::min(device, configured);
    if (device > 0 || configured > 0) return std::max(device, configured);
    return infinity;
}

/// Half the peak if neither states a value (the usual rating of a desktop device's motors).
double continuous(double device, double configured, double peak) {
    const double stated = tighter(device, configured);
    return stated < infinity ? stated : peak / 2;
}

/// Torque may change as fast as force, measured against the peaks.
double torque_slew(double slew, double peak_torque, double peak_force) {
    return peak_torque < infinity && peak_force < infinity ? slew * peak_torque / peak_force : infinity;
}

/// The largest stable virtual damping of a sampled, filtered loop: b <= m/(4 (T + tau + tau_f)) with the 100
/// Hz filter (measured; Colgate & Brown 1994 for the form). An unknown mass counts as light.
double largest_damping(const drivers::LinkConfig& link, double rate) {
    const double mass = link.apparent_mass > 0 ? link.apparent_mass : 0.05;  // kg
    const double filter = 1 / (2 * std::numbers::pi * 100);                  // s
    return mass / (4 * (1 / rate + link.lag + filter));
}

bool finite(const Wrench& w) {
    return w.force.allFinite() && w.torque.allFinite();
}

}  // namespace

Supervisor::Supervisor(const drivers::LinkConfig& link, const SupervisorLimits& limits, double rate)
    : link_(link),
      limits_(limits),
      peak_force_(tighter(link.peak_force, limits.peak_force)),
      continuous_force_(continuous(link.continuous_force, limits.continuous_force, peak_force_)),
      peak_torque_(tighter(link.peak_torque, limits.peak_torque)),
      damping_cap_(largest_damping(link, rate > 0 ? rate : link.nominal_rate)),
      torque_(link.renders_torque),
      power_(limits.power_time),
      slew_(limits.slew, torque_slew(limits.slew, peak_torque_, peak_force_)),
      thermal_(peak_force_, continuous_force_, limits.thermal_time) {}

// ---------------------------------------------------------------------------------------------- requests

RefusalReason Supervisor::may_arm(bool calibrated, double speed, bool after_reset) const noexcept {
    if (state_ == DeviceState::disconnected) return RefusalReason::disconnected;
    if (state_ == DeviceState::fault && !after_reset) return RefusalReason::in_fault;
    if (!calibrated) return RefusalReason::not_calibrated;
    // In `armed` the servo waits for a quick hand to slow down; a hand above the fault's speed would fault at
    // once.
    return speed < limits_.speed_fault ? RefusalReason::none : RefusalReason::hand_too_fast;
}

RefusalReason Supervisor::arm(bool calibrated, double speed) noexcept {
    const RefusalReason refusal = may_arm(calibrated, speed);
    if (refusal != RefusalReason::none) return refusal;
    if (state_ == DeviceState::idle) state_ = DeviceState::armed;
    arm_again_ = state_ == DeviceState::ramp_down;
    return RefusalReason::none;
}

void Supervisor::disarm() noexcept {
    arm_again_ = false;
    if (state_ == DeviceState::armed) state_ = DeviceState::idle;
    if (state_ == DeviceState::ramp_up || state_ == DeviceState::active) state_ = DeviceState::ramp_down;
}

RefusalReason Supervisor::may_reset_fault(double speed, std::uint32_t trouble) const noexcept {
    if (state_ == DeviceState::disconnected) return RefusalReason::disconnected;
    if (state_ != DeviceState::fault) return RefusalReason::not_in_fault;
    if (trouble != 0) return RefusalReason::cause_persists;
    return speed < limits_.arm_speed ? RefusalReason::none : RefusalReason::hand_too_fast;
}

RefusalReason Supervisor::reset_fault(double speed, std::uint32_t trouble) noexcept {
    const RefusalReason refusal = may_reset_fault(speed, trouble);
    if (refusal != RefusalReason::none) return refusal;
    faults_ = 0;
    state_ = DeviceState::idle;
    power_.reset();  // power before the fault must not count after it
    return RefusalReason::none;
}

void Supervisor::raise(std::uint32_t fault_bits) noexcept {
    if (state_ != DeviceState::fault) ++counts_.faults;
    faults_ |= fault_bits;
    state_ = DeviceState::fault;
    gain_ = 0;
    arm_again_ = false;
}

void Supervisor::hold() noexcept {
    if (!powered()) return;
    state_ = state_ == DeviceState::ramp_down ? state_ : DeviceState::ramp_up;
    gain_ = 0;
    sent_force_.setZero();  // the hand's motion in the gap is unknown, so no work is counted over it
    moved_ = false;
    slew_.restart_from_zero();
}

void Supervisor::disconnected() noexcept {
    state_ = DeviceState::disconnected;
    gain_ = 0;
    arm_again_ = false;
}

void Supervisor::reconnected() noexcept {
    // Unplugging the device must not reset another fault.
    faults_ &= ~fault::unplugged;
    state_ = faults_ != 0 ? DeviceState::fault : DeviceState::idle;
    gain_ = 0;
    moved_ = false;
}

void Supervisor::start_active() noexcept {
    state_ = DeviceState::active;
    gain_ = 1;
}

// ------------------------------------------------------------------------------------------ every cycle

void Supervisor::advance_state(double speed, int armed_claims, double dt) noexcept {
    if (powered() && state_ != DeviceState::ramp_down && armed_claims == 0) state_ = DeviceState::ramp_down;
    // A ramp of n steps ends after n steps, however their sum is rounded.
    constexpr double rounding = 1e-9;
    switch (state_) {
        case DeviceState::armed:
            if (armed_claims == 0)
                state_ = DeviceState::idle;
            else if (speed < limits_.arm_speed)
                state_ = DeviceState::ramp_up;
            break;
        case DeviceState::ramp_up:
            gain_ += dt / limits_.ramp_up;
            if (gain_ < 1 - rounding) break;
            gain_ = 1;
            state_ = DeviceState::active;
            break;
        case DeviceState::ramp_down:
            gain_ -= dt / limits_.ramp_down;
            if (gain_ > rounding) break;
            gain_ = 0;
            state_ = arm_again_ && armed_claims > 0 ? DeviceState::armed : DeviceState::idle;
            arm_again_ = false;
            break;
        default:
            break;
    }
}

void Supervisor::account(const Eigen::Vector3d& position, double dt) noexcept {
    const double work = moved_ ? sent_force_.dot(position - last_position_) : 0;
    last_position_ = position;
    moved_ = true;
    power_.add(work, dt);
    energy_.add(work, !sent_force_.isZero(0));
    counts_.generated_energy = energy_.generated();
}

void Supervisor::damp_speed(Wrench& w, const Eigen::Vector3d& velocity) const noexcept {
    const double above = velocity.norm() - limits_.speed_damping_from;
    if (above > 0) w.force -= std::min(limits_.speed_damping * above, damping_cap_) * velocity;
}

void Supervisor::keep_inside(Wrench& w, const Eigen::Vector3d& position) const noexcept {
    const double edge = limits_.workspace_margin * link_.workspace_radius;
    if (!(edge > 0)) return;
    const Eigen::Vector3d from_centre =
        position -
        Eigen::Vector3d(link_.workspace_centre[0], link_.workspace_centre[1], link_.workspace_centre[2]);
    // The outward force falls to zero over the last 5 % of the radius, since a step there would be felt.
    const double band = 0.05 * link_.workspace_radius;
    const double distance = from_centre.norm();
    if (distance <= edge - band) return;
    const Eigen::Vector3d outwards = from_centre / distance;
    const double push = w.force.dot(outwards);
    if (push > 0) w.force -= (1 - std::clamp((edge - distance) / band, 0.0, 1.0)) * push * outwards;
}

Supervised Supervisor::supervise(const Wrench& sum, const Eigen::Vector3d& position,
                                 const Eigen::Vector3d& velocity, const drivers::Jacobian& jacobian,
                                 int joints, int armed_claims, double dt) noexcept {
    if (!finite(sum)) raise(fault::not_finite);
    if (limits_.off && state_ != DeviceState::fault) {
        Supervised out;
        out.sent = sum;
        Eigen::Map<Eigen::Matrix<double, drivers::max_joints, 1>>(out.efforts.data()) =
            jacobian.topRows<3>().transpose() * sum.force + jacobian.bottomRows<3>().transpose() * sum.torque;
        return out;
    }
    const double speed = velocity.norm();
    advance_state(speed, armed_claims, dt);
    account(position, dt);
    if (powered() && !(speed <= limits_.speed_fault)) raise(fault::speed);
    if (powered() && power_.mean() > limits_.power) raise(fault::power);
    if (!powered()) return nothing(dt);

    Wrench w = sum;
    if (!torque_) w.torque.setZero();
    damp_speed(w, velocity);
    w = gain_ * w;
    keep_inside(w, position);

    const bool clipped = slew_.clip(w, dt);
    if (clipped) ++counts_.slew_clips;
    if (slew_.clipped_for() > limits_.slew_fault_time + dt / 2) {
        raise(fault::slew);
        return nothing(dt);
    }
    Supervised out = limit_and_map(w, jacobian, joints, dt);
    if (clipped) out.flags |= report_flags::clamped;
    return out;
}

Supervised Supervisor::limit_and_map(Wrench w, const drivers::Jacobian& jacobian, int joints,
                                     double dt) noexcept {
    Supervised out;
    const auto scale_to = [&out](Eigen::Vector3d& v, double limit, std::uint64_t& count) {
        const double size = v.norm();
        if (size <= limit) return;
        v *= limit / size;
        ++count;
        out.flags |= report_flags::clamped;
    };
    scale_to(w.force, peak_force_, counts_.force_clamps);
    scale_to(w.torque, peak_torque_, counts_.force_clamps);
    scale_to(w.force, thermal_.allowed(), counts_.thermal_clamps);
    thermal_.add(w.force.norm(), dt);

    using Efforts = Eigen::Matrix<double, drivers::max_joints, 1>;
    Eigen::Map<Efforts> efforts(out.efforts.data());
    efforts = jacobian.topRows<3>().transpose() * w.force;
    if (torque_) efforts += jacobian.bottomRows<3>().transpose() * w.torque;
    const int actuated = std::clamp(std::min(joints, link_.actuated_joints), 0, drivers::max_joints);
    double scale = 1;
    for (int i = 0; i < drivers::max_joints; ++i) {
        if (i >= actuated) efforts[i] = 0;  // a passive joint takes none
        const auto n = static_cast<std::size_t>(i);
        const double limit = n < link_.effort_limit.size() ? link_.effort_limit[n] : infinity;
        if (std::abs(efforts[i]) * scale > limit) scale = limit / std::abs(efforts[i]);
    }
    if (scale < 1) {
        efforts *= scale;
        w = scale * w;
        ++counts_.joint_clamps;
        out.flags |= report_flags::clamped;
    }
    if (!efforts.allFinite()) {  // finite force, absurd Jacobian
        raise(fault::kinematics);
        return nothing(0);
    }
    out.sent = w;
    sent_force_ = w.force;
    return out;
}

Supervised Supervisor::nothing(double dt) noexcept {
    slew_.restart_from_zero();
    thermal_.add(0, dt);
    sent_force_.setZero();
    return {};
}

Supervised Supervisor::cut(int armed_claims, double dt) noexcept {
    advance_state(infinity, armed_claims, dt);
    moved_ = false;
    return nothing(dt);
}

}  // namespace knurl::servo
