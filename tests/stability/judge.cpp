#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stability {

double wanted_speed(const Conditions& c, double t) {
    if (c.speed == 0 || t <= judged_from || t >= rest_from) return 0;
    const double ramp = std::min({1.0, (t - judged_from) / speed_up, (rest_from - t) / speed_up});
    if (c.reach == 0) return ramp * c.speed;
    // To and fro: 2 reach at full speed, then a turn in which the speed changes linearly.
    const double pass = 2 * c.reach / c.speed;
    const double phase = std::fmod(t - judged_from, 2 * (pass + speed_up));
    const double half = phase < pass + speed_up ? phase : phase - pass - speed_up;
    const double sign = phase < pass + speed_up ? 1 : -1;
    const double turning = half < pass ? 1 : 1 - 2 * (half - pass) / speed_up;
    return ramp * sign * turning * c.speed;
}

unsigned Figures::broken() const {
    // Written so that NaN breaks all of them.
    unsigned mask = 0;
    if (!(jump <= 1.0)) mask |= stability::jump;
    if (!(rise <= 1.0)) mask |= stability::rise;
    if (!(kick <= 0.3)) mask |= stability::kick;
    if (!(cycle < 0.1e-3)) mask |= stability::cycle;
    if (!(power <= 0.1)) mask |= stability::power;
    return mask;
}

void Figures::worst_of(const Figures& other) {
    jump = std::max(jump, other.jump);
    rise = std::max(rise, other.rise);
    kick = std::max(kick, other.kick);
    cycle = std::max(cycle, other.cycle);
    power = std::max(power, other.power);
    error = std::max(error, other.error);
    peak = std::max(peak, other.peak);
}

Judge::Judge(const Conditions& conditions, double stiffness, bool measure)
    : conditions_(conditions), stiffness_(stiffness), measure_(measure) {
    const double cycles = 1e-3 * conditions.rate;  // in a millisecond
    last_.resize(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(cycles))));
    share_ = cycles < 1 ? cycles : 1;
}

void Judge::add(double t, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
                const Eigen::Vector3d& force, double work) {
    const Eigen::Vector3d before = last_[next_];
    last_[next_] = force;
    next_ = next_ + 1 == last_.size() ? 0 : next_ + 1;
    if (known_ < last_.size()) {
        ++known_;
        return;
    }
    if (t < judged_from) return;
    if (!begun_) work_at_start_ = work;
    begun_ = true;
    work_ = work;

    const double change = share_ * (force - before).norm();
    if (!(change <= figures_.jump)) figures_.jump = change;
    const double size = force.norm(), growth = share_ * (size - before.norm());
    if (!(growth <= figures_.rise)) figures_.rise = growth;
    figures_.peak = std::max(figures_.peak, size);
    // The foot is computed only where it can matter.
    const bool fast = !(velocity.norm() <= figures_.kick), at_rest = t >= cycle_from;
    if (!fast && !at_rest && !measure_) return;
    const Ridge::Foot foot = conditions_.ridge.foot(position);
    if (fast) {
        const double away = velocity.dot(foot.normal);
        if (!(away <= figures_.kick)) figures_.kick = away;
    }
    if (measure_ && t < rest_from) {
        const double wanted = std::min(stiffness_ * std::max(0.0, -foot.height), conditions_.peak_force);
        squares_ += (force - wanted * foot.normal).squaredNorm();
        ++measured_;
    }
    if (at_rest) {
        lowest_ = resting_ ? std::min(lowest_, foot.height) : foot.height;
        highest_ = resting_ ? std::max(highest_, foot.height) : foot.height;
        resting_ = true;
    }
}

void Judge::fault() {
    figures_.jump = figures_.rise = figures_.kick = figures_.cycle = figures_.power =
        std::numeric_limits<double>::infinity();
}

Figures Judge::finish() {
    // A surface that was never touched has no verdict: a search for the stiffest must not count it as stable.
    if (begun_ && figures_.peak == 0) fault();
    if (!std::isinf(figures_.cycle)) {
        figures_.cycle = 0.5 * (highest_ - lowest_);
        figures_.power = (work_ - work_at_start_) / (run_end - judged_from);
    }
    if (measured_ > 0) figures_.error = std::sqrt(squares_ / static_cast<double>(measured_));
    return figures_;
}

}  // namespace stability
