#pragma once

/// @file
/// Shared memory is made of 64-bit words, and every access to one is atomic: the sanitizer, the standard and
/// the code agree about it, whatever the other side does at that moment.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace knurl::shm {

/// Words of different writers keep this distance: Intel prefetches lines in pairs. A literal, because
/// std::hardware_destructive_interference_size changes with compiler flags and this is an ABI.
inline constexpr std::size_t line_bytes = 128;

/// `bytes` rounded up to a multiple of `unit`.
constexpr std::size_t round_up(std::size_t bytes, std::size_t unit) {
    return (bytes + unit - 1) / unit * unit;
}

/// The memory that ships. The rings are templates over it so that the Relacy models in tests/shm run the very
/// same algorithms on simulated memory, and deliberately weakened ones to see that each order is needed.
struct HardwareMemory {
    /// Indexes, flags.
    using Word = std::uint64_t;
    /// What is copied.
    using Payload = std::uint64_t;

    /// The word as an atomic.
    static std::atomic_ref<Word> at(const Word& word) noexcept {
        // atomic_ref<const T> comes with C++26. A lock-free load never writes, so a read-only mapping is
        // fine.
        static_assert(std::atomic_ref<Word>::is_always_lock_free);
        return std::atomic_ref<Word>(const_cast<Word&>(word));
    }
    /// Atomic load.
    static std::uint64_t load(const Word& word, std::memory_order order) noexcept {
        return at(word).load(order);
    }
    /// Atomic store.
    static void store(Word& word, std::uint64_t value, std::memory_order order) noexcept {
        at(word).store(value, order);
    }
    /// Atomic exchange.
    static std::uint64_t exchange(Word& word, std::uint64_t value, std::memory_order order) noexcept {
        return at(word).exchange(value, order);
    }
    /// Atomic compare-exchange. Fails relaxed; `expected` is then what was found.
    static bool compare_exchange(Word& word, std::uint64_t& expected, std::uint64_t value,
                                 std::memory_order order) noexcept {
        return at(word).compare_exchange_strong(expected, value, order, std::memory_order::relaxed);
    }
    /// Fence between threads.
    static void fence(std::memory_order order) noexcept { std::atomic_thread_fence(order); }

    /// Asks for the cache lines of what will be copied out of shared memory soon.
    static void prefetch(const Payload* shared, std::size_t words) noexcept {
        constexpr std::size_t line_words = 8;
        for (std::size_t i = 0; i < words; i += line_words) __builtin_prefetch(shared + i);
    }

    /// Copies into shared memory word by word, because compilers never join atomics to vectors; four to a
    /// turn, which halves the time.
    static void store_payload(Payload* shared, const void* from, std::size_t words,
                              std::memory_order order) noexcept {
        const auto* bytes = static_cast<const std::byte*>(from);
        const std::size_t fours = words / 4 * 4;
        for (std::size_t i = 0; i < fours; i += 4)
            for (std::size_t k = 0; k < 4; ++k) store(shared[i + k], word_at(bytes, i + k), order);
        for (std::size_t i = fours; i < words; ++i) store(shared[i], word_at(bytes, i), order);
    }
    /// Copies out of shared memory, likewise.
    static void load_payload(void* to, const Payload* shared, std::size_t words,
                             std::memory_order order) noexcept {
        auto* bytes = static_cast<std::byte*>(to);
        const std::size_t fours = words / 4 * 4;
        for (std::size_t i = 0; i < fours; i += 4)
            for (std::size_t k = 0; k < 4; ++k) put_word(bytes, i + k, load(shared[i + k], order));
        for (std::size_t i = fours; i < words; ++i) put_word(bytes, i, load(shared[i], order));
    }

  private:
    static std::uint64_t word_at(const std::byte* bytes, std::size_t i) noexcept {
        std::uint64_t value;
        std::memcpy(&value, bytes + i * sizeof value, sizeof value);
        return value;
    }
    static void put_word(std::byte* bytes, std::size_t i, std::uint64_t value) noexcept {
        std::memcpy(bytes + i * sizeof value, &value, sizeof value);
    }
};

/// Copies `words` 64-bit words into shared memory, each as one atomic store with `order` (relaxed or
/// release).
inline void store_words(std::uint64_t* shared, const void* src, std::size_t words,
                        std::memory_order order = std::memory_order::relaxed) noexcept {
    HardwareMemory::store_payload(shared, src, words, order);
}

/// Copies `words` 64-bit words out of shared memory, each as one atomic load with `order` (relaxed or
/// acquire).
inline void load_words(void* dst, const std::uint64_t* shared, std::size_t words,
                       std::memory_order order = std::memory_order::relaxed) noexcept {
    HardwareMemory::load_payload(dst, shared, words, order);
}

/// Throws std::invalid_argument unless `memory` begins on a 128-byte boundary, as every segment does.
void require_aligned(const void* memory, const char* who);
/// Throws std::invalid_argument unless `count` is a power of two of 2 or more.
void require_power_of_two(std::uint32_t count, const char* who);
/// Throws std::invalid_argument unless `bytes` is a multiple of 8 of 8 or more.
void require_whole_words(std::size_t bytes, const char* who);

}  // namespace knurl::shm
