#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/servo/stages.hpp>

namespace knurl::servo {

void PowerMeter::add(double work, double dt) noexcept {
    filling_work_ += work;
    filling_time_ += dt;
    // Half a cycle of tolerance: twenty steps of 0.1 ms fill a part of 2 ms, however their sum is rounded.
    if (filling_time_ + dt / 2 < part_time_) return;
    work_[next_] = filling_work_;
    next_ = (next_ + 1) % parts;
    filling_work_ = filling_time_ = 0;
    double sum = 0;
    for (const double part : work_) sum += part;
    mean_ = sum / (part_time_ * static_cast<double>(parts));
}

void PowerMeter::reset() noexcept {
    *this = PowerMeter(part_time_ * static_cast<double>(parts));
}

namespace {

/// Moves `last` towards `wanted` by at most `step`. True: the limit acted.
bool approach(Eigen::Vector3d& last, const Eigen::Vector3d& wanted, double step) noexcept {
    const Eigen::Vector3d change = wanted - last;
    const double size = change.norm();
    if (!(size > step)) {  // also when there is no limit
        last = wanted;
        return false;
    }
    last += change * (step / size);
    return true;
}

}  // namespace

bool SlewGate::clip(Wrench& wanted, double dt) noexcept {
    const bool force = approach(last_.force, wanted.force, force_slew_ * dt);
    const bool torque = approach(last_.torque, wanted.torque, torque_slew_ * dt);
    wanted = last_;
    clipped_for_ = force || torque ? clipped_for_ + dt : 0;
    return force || torque;
}

void SlewGate::restart_from_zero() noexcept {
    last_ = Wrench{};
    clipped_for_ = 0;
}

ThermalLimit::ThermalLimit(double peak, double continuous, double time) noexcept
    : peak_(peak), continuous_(continuous), tau_(std::numeric_limits<double>::infinity()) {
    const double ratio = continuous / peak;
    if (ratio < 1) tau_ = -time / std::log1p(-ratio * ratio);
}

double ThermalLimit::allowed() const noexcept {
    if (!(continuous_ < peak_)) return peak_;
    const double room = std::clamp((1 - heat_) / (1 - full_until), 0.0, 1.0);
    return continuous_ + (peak_ - continuous_) * room;
}

void ThermalLimit::add(double force, double dt) noexcept {
    if (!(continuous_ < peak_)) return;
    const double load = force / continuous_;
    const double x = dt / tau_;
    heat_ += (x - x * x / 2) * (load * load - heat_);  // 1 - exp(-x) for x << 1
}

}  // namespace knurl::servo
