#pragma once
// The fate of a stream's reports, by their numbers (1, 2, ... in order of sending). Counting begins with the
// first report that arrives. Exact within the window: a report that arrives even later stays counted as lost.

#include <cstdint>

#include "counter_window.hpp"

namespace knurl::bridge {

class ReportTally {
  public:
    /// For a datagram seen for the first time. True: it is the newest, and the missing ones before it count
    /// as lost so far. One number may come in two datagrams (the newest report is sent again to a peer
    /// without any).
    bool take(std::uint64_t number) noexcept {
        const std::uint64_t newest = seen_.newest();
        if (number <= newest) {
            if (seen_.look(number) != CounterWindow::Seen::never) return false;
            seen_.accept(number);
            if (number > first_) ++late_;  // reports before the first were not missed
            return false;
        }
        if (newest == 0)
            first_ = number;
        else
            gaps_ += number - newest - 1;
        seen_.accept(number);
        return true;
    }
    /// For a datagram so old that it may be a duplicate.
    void take_old(std::uint64_t number) noexcept {
        if (seen_.look(number) == CounterWindow::Seen::already)
            ++copies_;
        else if (number < seen_.newest())
            take(number);
    }

    std::uint64_t newest() const noexcept { return seen_.newest(); }
    std::uint64_t gaps() const noexcept { return gaps_; }  // numbers skipped by newer ones
    std::uint64_t late() const noexcept { return late_; }  // of those, arrived later
    std::uint64_t lost() const noexcept { return gaps_ - late_; }
    std::uint64_t copies() const noexcept { return copies_; }  // seen by take_old()

  private:
    CounterWindow seen_;
    std::uint64_t first_ = 0, gaps_ = 0, late_ = 0, copies_ = 0;
};

}  // namespace knurl::bridge
