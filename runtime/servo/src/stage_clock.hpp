#pragma once
// Measures how a cycle's time divides among its stages. Each reading of the clock costs some 20 ns, so only
// one cycle in 64 measures. The purpose is a mean, and 16 samples a second are enough for that.

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

    /// Before all stages; `now`: when the cycle began.
    void begin(std::uint64_t cycle, Nanoseconds now) noexcept {
        on_ = looks_ && cycle % every == 0;
        if (!on_) return;
        last_ = now;
        ++stamped_;
    }
    /// The time since the last call belongs to this stage.
    void end(Stage stage) noexcept {
        if (!on_) return;
        const Nanoseconds now = clock_.now();
        // A clock that was set back is handled by the supervisor.
        sums_[static_cast<std::size_t>(stage)] +=
            static_cast<std::uint64_t>(std::max<Nanoseconds>(0, now - last_));
        last_ = now;
    }

    /// For a replay, whose clock holds only the readings that matter.
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
