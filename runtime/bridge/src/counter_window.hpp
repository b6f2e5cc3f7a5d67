#pragma once
// Which datagrams of one stream were there already. A network may double and reorder them, and an attacker
// may replay them: each counter is accepted once, and never when it is more than 64 behind the newest (the
// window of RFC 4303, 3.4.3).

#include <cstdint>

namespace knurl::bridge {

class CounterWindow {
  public:
    static constexpr std::uint64_t width = 64;
    enum class Seen : std::uint8_t { never, already, too_old };

    Seen look(std::uint64_t counter) const noexcept {
        if (counter > newest_) return Seen::never;
        const std::uint64_t behind = newest_ - counter;
        if (counter == 0 || behind >= width) return Seen::too_old;
        return (seen_ >> behind & 1) != 0 ? Seen::already : Seen::never;
    }
    /// Only when it is known to be the peer's, and was never seen.
    void accept(std::uint64_t counter) noexcept {
        if (counter > newest_) {
            const std::uint64_t ahead = counter - newest_;
            seen_ = (ahead >= width ? 0 : seen_ << ahead) | 1;
            newest_ = counter;
        } else {
            seen_ |= std::uint64_t{1} << (newest_ - counter);
        }
    }

  private:
    std::uint64_t newest_ = 0;  // counters begin at 1
    std::uint64_t seen_ = 0;    // bit n: newest_ - n
};

}  // namespace knurl::bridge
