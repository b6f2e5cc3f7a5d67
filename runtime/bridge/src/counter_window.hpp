#pragma once
// Which numbers of a sequence have arrived. A network may duplicate and reorder datagrams, and an attacker
// may replay them. So each counter is accepted once, and none that is `width` or more behind the newest (the
// window of RFC 4303, 3.4.3).

#include <array>
#include <cstdint>

namespace knurl::bridge {

class CounterWindow {
  public:
    static constexpr std::uint64_t width = 1024;  // a second of a servo's reports
    enum class Seen : std::uint8_t { never, already, too_old };

    Seen look(std::uint64_t counter) const noexcept {
        if (counter > newest_) return Seen::never;
        if (counter == 0 || newest_ - counter >= width) return Seen::too_old;
        return (word(counter) & bit(counter)) != 0 ? Seen::already : Seen::never;
    }
    /// Only for a counter that is known to be the peer's and was never seen.
    void accept(std::uint64_t counter) noexcept {
        if (counter > newest_) {
            // New counters take the places of those that leave the window.
            if (counter - newest_ > width) newest_ = counter - width;
            while (newest_ < counter) {
                ++newest_;
                word(newest_) &= ~bit(newest_);
            }
        }
        word(counter) |= bit(counter);
    }
    std::uint64_t newest() const noexcept { return newest_; }

  private:
    static std::uint64_t bit(std::uint64_t counter) noexcept { return std::uint64_t{1} << counter % 64; }
    std::uint64_t& word(std::uint64_t counter) noexcept { return seen_[counter / 64 % seen_.size()]; }
    std::uint64_t word(std::uint64_t counter) const noexcept { return seen_[counter / 64 % seen_.size()]; }

    std::uint64_t newest_ = 0;  // counters begin at 1
    std::array<std::uint64_t, width / 64> seen_{};
};

}  // namespace knurl::bridge
