#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <knurl/servo/velocity.hpp>

namespace knurl::servo {

FirstOrderVelocity::FirstOrderVelocity(double cutoff) noexcept : rate_(2 * std::numbers::pi * cutoff) {}

void FirstOrderVelocity::add(const Eigen::Vector3d& raw, double dt) noexcept {
    value_ += -std::expm1(-rate_ * dt) * (raw - value_);
}

void AdaptiveVelocity::add(const Eigen::Vector3d& position, const Eigen::Vector3d& band, double dt) noexcept {
    time_ += dt;
    double inverse_span[window];
    for (std::size_t i = 0; i < kept_; ++i) {
        const double span = time_ - times_[(newest_ + window - i) % window];
        inverse_span[i] = span > 0 ? 1 / span : 0;
    }
    for (int axis = 0; axis < 3; ++axis) {
        double lowest = -std::numeric_limits<double>::infinity();
        double highest = std::numeric_limits<double>::infinity();
        double slope = 0;
        for (std::size_t i = 0; i < kept_; ++i) {
            const double change = position[axis] - positions_[(newest_ + window - i) % window][axis];
            const double candidate = change * inverse_span[i];
            if (candidate < lowest || candidate > highest) break;
            slope = candidate;
            lowest = std::max(lowest, (change - band[axis]) * inverse_span[i]);
            highest = std::min(highest, (change + band[axis]) * inverse_span[i]);
        }
        value_[axis] = slope;
    }
    if (kept_ > 0 && time_ - times_[newest_] < spacing) return;
    newest_ = (newest_ + 1) % window;
    positions_[newest_] = position;
    times_[newest_] = time_;
    kept_ = std::min(kept_ + 1, window);
}

void AdaptiveVelocity::reset() noexcept {
    kept_ = 0;
    time_ = 0;
    value_.setZero();
}

}  // namespace knurl::servo
