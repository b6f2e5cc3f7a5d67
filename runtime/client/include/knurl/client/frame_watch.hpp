#pragma once

#include <algorithm>
#include <cstdint>

namespace knurl {

/// Whether a simulation's frames come as they should. Times are s of any one clock.
class FrameWatch {
  public:
    /// How frames come.
    enum class State {
        /// As they should.
        on_time,
        /// Half an interval overdue.
        late,
        /// None for `patience` intervals, and for half a second at least.
        stopped,
    };

    /// `interval`: expected time between frames (s), measured from the fifth on. `patience`: in intervals.
    explicit FrameWatch(double interval, double patience = 5) : interval_(interval), patience_(patience) {}

    /// The next frame is the first.
    void begin() {
        state_ = State::on_time;
        last_ = -1;
    }
    /// A frame has come at the time `now` (s). `count`: frames since the call before; those that came at once
    /// are told in one call.
    void frame(double now, int count = 1) {
        // Also after a stop: else one that is slower than expected would stop for ever.
        if (last_ >= 0 && now > last_ && ++gaps_ > 4)
            interval_ += 0.1 * (std::min((now - last_) / count, 3 * interval_) - interval_);
        last_ = now;
        state_ = State::on_time;
    }
    /// The state at the time `now` (s).
    State watch(double now) {
        constexpr double late = 1.5, shortest_stop = 0.5;  // intervals, s
        if (state_ == State::stopped) return state_;
        if (last_ < 0) last_ = now;
        const double silent = now - last_;
        state_ = silent > late * interval_ ? State::late : State::on_time;
        if (silent > std::max(patience_ * interval_, shortest_stop)) state_ = State::stopped;
        return state_;
    }
    /// Usual time between frames (s).
    double interval() const { return interval_; }

  private:
    double interval_, patience_, last_ = -1;
    std::uint64_t gaps_ = 0;
    State state_ = State::on_time;
};

}  // namespace knurl
