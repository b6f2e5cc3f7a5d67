#pragma once
// What became of a stream's reports, by their numbers (1, 2, ... as they were sent). The first that comes is
// where it begins. Exact as far back as the window goes: what comes even later stays among the lost.

#include <cstdint>

#include "counter_window.hpp"

namespace knurl::bridge {

class ReportTally {
  public:
    /// In a datagram that had not come before. True: it is the newest, and the others have been waited for in
    /// vain until now. The same number may come in two datagrams (the newest, sent again to one that had
    /// none).
    bool take(std::uint64_t number) noexcept {
        const std::uint64_t newest = seen_.newest();
        if (number <= newest) {
            if (seen_.look(number) != CounterWindow::Seen::never) return false;
            seen_.accept(number);
            if (number > first_) ++late_;  // what went before the first was not missed
            return false;
        }
        if (newest == 0)
            first_ = number;
        else
            gaps_ += number - newest - 1;
        seen_.accept(number);
        return true;
    }
    /// In a datagram so old that nobody knows whether it had come before.
    void take_old(std::uint64_t number) noexcept {
        if (seen_.look(number) == CounterWindow::Seen::already)
            ++copies_;
        else if (number < seen_.newest())
            take(number);
    }

    std::uint64_t newest() const noexcept { return seen_.newest(); }
    std::uint64_t gaps() const noexcept { return gaps_; }  // passed over by those that were the newest
    std::uint64_t late() const noexcept { return late_; }  // of those
    std::uint64_t lost() const noexcept { return gaps_ - late_; }
    std::uint64_t copies() const noexcept { return copies_; }  // seen by take_old()

  private:
    CounterWindow seen_;
    std::uint64_t first_ = 0, gaps_ = 0, late_ = 0, copies_ = 0;
};

}  // namespace knurl::bridge
