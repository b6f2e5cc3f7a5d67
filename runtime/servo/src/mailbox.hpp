#pragma once
// Messages between the broker's thread and the servo's thread: claims come and go by pointer, wait-free.
//
//   producer: slot t = message ─sb─> tail = t+1 (rel) ══sw══> tail read (acq) ─sb─> reads slot t
//   consumer: reads slot h     ─sb─> head = h+1 (rel) ══sw══> head read (acq) ─sb─> overwrites slot h
//
// The message carries a pointer, so the same release also publishes all that the broker has built behind it.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include <knurl/protocol/bounds.hpp>

namespace knurl::servo {

template <class T, std::size_t Slots>
class Mailbox {
    static_assert((Slots & (Slots - 1)) == 0);

  public:
    bool post(const T& message) noexcept {
        const std::uint64_t tail = tail_.load(std::memory_order_relaxed);  // its only writer is this thread
        if (tail - head_.load(std::memory_order_acquire) == Slots)
            return false;  // pairs with head_'s release
        slots_[tail % Slots] = message;
        tail_.store(tail + 1, std::memory_order_release);  // pairs with tail_'s acquire in take
        return true;
    }

    bool take(T& message) noexcept {
        const std::uint64_t head = head_.load(std::memory_order_relaxed);  // its only writer is this thread
        if (tail_.load(std::memory_order_acquire) == head) return false;   // pairs with tail_'s release
        message = slots_[head % Slots];
        head_.store(head + 1, std::memory_order_release);  // pairs with head_'s acquire in post
        return true;
    }

  private:
    alignas(128) std::atomic<std::uint64_t> tail_{0};
    alignas(128) std::atomic<std::uint64_t> head_{0};
    alignas(128) std::array<T, Slots> slots_ = {};
};

/// All claims of a full device can come and go at once, with room to spare.
inline constexpr std::size_t mailbox_slots = 4 * protocol::max_clients;

}  // namespace knurl::servo
