#pragma once

/// @file
/// The newest value wins, between two threads or, in a shared mapping, two processes.

// One publishes, one takes, and neither ever waits. A triple buffer: each side owns a slot, and `middle_` names the
// third and says whether it is fresh. (shm/ has the same for the runtime; the modules do not include each other.)
//
//   publisher: write back ─sb─> exchange(middle) ══sw══> exchange(middle) ─sb─> taker reads front
//   taker: last read of old front ─sb─> exchange(middle) ══sw══> exchange(middle) ─sb─> publisher reuses it

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace knurl::drivers {

/// A word of any size. One side alone publishes, one side alone takes.
template <class T>
class Newest {
  public:
    /// Replaces the value.
    void publish(const T& value) noexcept {
        slots_[back_ & index] = value;
        back_ = middle_.exchange(back_ | fresh, std::memory_order_acq_rel) & index;  // pairs with take
    }

    /// Takes the newest value. False: nothing new since the last call.
    bool take(T& value) noexcept {
        if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index;  // pairs with publish
        value = slots_[front_ & index];
        return true;
    }

  private:
    static constexpr std::uint32_t index = 3, fresh = 4;

    // Three are used. The fourth is there so that no index leaves the array, whatever the other process wrote into a
    // shared mapping.
    std::array<T, 4> slots_ = {};
    alignas(64) std::atomic<std::uint32_t> middle_ = 1;
    alignas(64) std::uint32_t back_ = 0;   // the publisher's
    alignas(64) std::uint32_t front_ = 2;  // the taker's
};

}  // namespace knurl::drivers
