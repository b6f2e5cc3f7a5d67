#include "sim/hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rotation_vector.hpp"

namespace knurl::drivers {

namespace {

/// splitmix64: the same numbers on all platforms, which <random>'s distributions do not guarantee.
double uniform(std::uint64_t& state) {
    state += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/// Minimum jerk from 1 to 0 over x in 0..1 (Flash & Hogan 1985), and its slope.
double fading(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return 1 - x * x * x * (10 + x * (6 * x - 15));
}
double fading_slope(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return -30 * x * x * (1 - x) * (1 - x);
}

}  // namespace

Hand::Hand(const SimHand& figures, std::optional<Motion> motion, const MotionSample& rest, std::uint64_t seed)
    : figures_(figures), motion_(std::move(motion)), rest_(rest) {
    if (motion_) {
        rest_.position = motion_->rows().front().position;
        if (motion_->has_orientation()) {
            rest_.orientation = motion_->rows().front().orientation;
        }
    }
    for (auto& axis : tremor_) {
        for (int i = 0; i < tremor_tones; ++i) {
            // Hz, one in each third of 8..12
            const double frequency = 8 + 4 * (i + uniform(seed)) / tremor_tones;
            axis[static_cast<std::size_t>(i)] = {.frequency = 2 * std::numbers::pi * frequency,
                                                 .phase = 2 * std::numbers::pi * uniform(seed)};
        }
    }
}

void Hand::begin(double t) noexcept {
    if (!motion_) {
        return;
    }
    const MotionSample here = wanted(t);
    push_before_ = push_level(t);
    plays_ = true;
    changed_at_ = t;
    hint_ = 0;
    leave_from(here);
}

void Hand::rest(double t) noexcept {
    if (!plays_) {
        return;
    }
    const MotionSample here = wanted(t);
    push_before_ = push_level(t);
    plays_ = false;
    changed_at_ = t;
    leave_from(here);
}

void Hand::leave_from(const MotionSample& here) noexcept {
    away_ = here.position - rest_.position;
    turned_ = rotation_vector(rest_.orientation, here.orientation);
}

double Hand::push_level(double t) const noexcept {
    const double share = std::clamp((t - changed_at_) / figures_.push_ramp, 0.0, 1.0);
    return plays_ ? push_before_ + (1 - push_before_) * share : push_before_ * (1 - share);
}

MotionSample Hand::wanted(double t) noexcept {
    MotionSample target = rest_;
    if (plays_) {
        const MotionSample moved = motion_->sample(motion_->begin() + (t - changed_at_), hint_);
        target.position = moved.position;
        target.velocity = moved.velocity;
        if (motion_->has_orientation()) {
            target.orientation = moved.orientation;
            target.angular_velocity = moved.angular_velocity;
        }
    }
    const double x = (t - changed_at_) / figures_.return_time;
    if (x < 1) {
        target.position += fading(x) * away_;
        target.velocity += fading_slope(x) / figures_.return_time * away_;
        target.orientation = rotation(fading(x) * turned_) * target.orientation;
        target.angular_velocity += fading_slope(x) / figures_.return_time * turned_;
    }
    return target;
}

HandForce Hand::force(double t, const MotionSample& wanted, const MotionSample& tip) const noexcept {
    HandForce result;
    if (figures_.grip == 0) {
        return result;
    }
    const Eigen::Vector3d spring(figures_.stiffness, figures_.stiffness, figures_.normal_stiffness);
    result.force = spring.cwiseProduct(wanted.position - tip.position) +
                   figures_.damping * (wanted.velocity - tip.velocity);
    result.force.z() -= figures_.push * push_level(t);
    if (figures_.tremor > 0) {
        const double amplitude = figures_.tremor * std::sqrt(2.0 / tremor_tones);  // of one of the tones
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const Tone& tone : tremor_[axis]) {
                result.force[static_cast<Eigen::Index>(axis)] +=
                    amplitude * std::sin(tone.frequency * t + tone.phase);
            }
        }
    }
    result.torque = figures_.rotational_stiffness * rotation_vector(tip.orientation, wanted.orientation) +
                    figures_.rotational_damping * (wanted.angular_velocity - tip.angular_velocity);
    result.force *= figures_.grip;
    result.torque *= figures_.grip;
    return result;
}

}  // namespace knurl::drivers
