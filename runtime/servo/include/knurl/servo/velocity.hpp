#pragma once

/// @file
/// Velocity from positions that come in encoder counts. Three answers for three uses: damping wants little
/// phase lag, friction and reports want little noise, prediction wants the trend.
///
/// Windows are seconds, not samples: at 4 kHz sixteen samples would be four times shorter and twice as noisy.

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace knurl::servo {

/// First order low pass of the difference quotient, exact for any dt.
class FirstOrderVelocity {
  public:
    /// `cutoff` in Hz.
    explicit FirstOrderVelocity(double cutoff /* Hz */) noexcept;
    /// Adds a difference quotient (m/s) over `dt` (s).
    void add(const Eigen::Vector3d& raw /* m/s */, double dt) noexcept;
    /// The velocity (m/s).
    const Eigen::Vector3d& value() const noexcept { return value_; }
    /// Back to 0.
    void reset() noexcept { value_.setZero(); }
    /// What is remembered between cycles, for an input log's keyframe (state_words.hpp).
    template <class Visit>
    void state(Visit& visit) noexcept {  // as of the stages: state_words.hpp
        visit(value_);
    }

  private:
    double rate_;  // 1/s
    Eigen::Vector3d value_ = Eigen::Vector3d::Zero();
};

/// First-order adaptive windowing, end-fit (Janabi-Sharifi, Hayward & Chen, IEEE Trans. Control Systems
/// Technology 8 (2000), section III): the slope over the longest window whose positions all lie within the
/// noise band of the line through its ends; long at rest, short when the hand turns. Each axis has its own
/// window.
///
/// A window of n samples is admissible if its slope lies in the cone that the samples inside it leave open;
/// so one walk back, narrowing the cone, finds the same window as testing every line against every sample, in
/// n steps.
class AdaptiveVelocity {
  public:
    /// Positions that are kept.
    static constexpr std::size_t window = 16;
    /// Least time between those kept (s): 16 ms for all at any rate.
    static constexpr double spacing = 0.95e-3;

    /// `band`: what noise may move a position by, per axis (m); one encoder count at the tip.
    void add(const Eigen::Vector3d& position, const Eigen::Vector3d& band, double dt) noexcept;
    /// The velocity (m/s).
    const Eigen::Vector3d& value() const noexcept { return value_; }
    /// Forgets all positions.
    void reset() noexcept;
    /// What is remembered between cycles, for an input log's keyframe (state_words.hpp).
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(positions_, times_, newest_, kept_, time_, value_);
        newest_ %= window;  // a file may say anything
        kept_ = kept_ < window ? kept_ : window;
    }

  private:
    std::array<Eigen::Vector3d, window> positions_;  // a ring, newest at newest_
    std::array<double, window> times_ = {};          // s
    std::size_t newest_ = 0, kept_ = 0;
    double time_ = 0;  // s, since the first sample after a reset
    Eigen::Vector3d value_ = Eigen::Vector3d::Zero();
};

}  // namespace knurl::servo
