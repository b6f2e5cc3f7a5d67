#pragma once
// Where a cycle's time goes. Each look at the clock costs some 20 ns, so only one cycle in 64 looks: what
// people want to know is a mean, and 16 samples a second are plenty for that.

#include <algorithm>
#include <array>
#include <cstdint>

#include <knurl/servo/clock.hpp>

namespace knurl::servo {

enum class Stage : std::uint32_t { read, kinematics, take, scenes, supervise, write, publish, size_ };

class StageClock {
  public:
    static constexpr std::uint64_t every = 64;  // cycles

    explicit StageClock(Clock& clock) noexcept : clock_(clock) {}

    /// Before all of them; `now`: when the cycle began.
    void begin(std::uint64_t cycle, Nanoseconds now) noexcept {
        on_ = looks_ && cycle % every == 0;
        if (!on_) return;
        last_ = now;
        ++stamped_;
    }
    /// What has been done since the last call was this.
    void end(Stage stage) noexcept {
        if (!on_) return;
        const Nanoseconds now = clock_.now();
        // A clock that was set back is the supervisor's business.
        sums_[static_cast<std::size_t>(stage)] +=
            static_cast<std::uint64_t>(std::max<Nanoseconds>(0, now - last_));
        last_ = now;
    }

    /// A replay's clock is asked for what matters alone.
    void never() noexcept { looks_ = false; }

    bool stamping() const noexcept { return on_; }  // this cycle
    std::uint64_t stamped() const noexcept { return stamped_; }
    std::uint64_t sum(Stage stage) const noexcept { return sums_[static_cast<std::size_t>(stage)]; }  // ns

  private:
    Clock& clock_;
    bool looks_ = true, on_ = false;
    Nanoseconds last_ = 0;
    std::uint64_t stamped_ = 0;
    std::array<std::uint64_t, static_cast<std::size_t>(Stage::size_)> sums_{};
};

}  // namespace knurl::servo
