#pragma once

/// @file
/// Counters that any process can read and that cost the writer a plain store each. Looking at them costs it
/// nothing.

#include <span>
#include <string_view>

#include <knurl/shm/words.hpp>

namespace knurl::shm {

/// The names of a block's counters, in order: a constexpr array with static storage, the same in every
/// process.
using CounterNames = std::span<const std::string_view>;

/// Bytes of a block of `count` counters.
constexpr std::size_t counters_bytes(std::size_t count) {
    return round_up(count * sizeof(std::uint64_t), line_bytes);
}

/// A reader's view of a block; the mapping may be read-only. Each counter is whole, the block is not a
/// snapshot.
class CountersReader {
  public:
    /// Throws std::invalid_argument if `memory` is not aligned to 128 bytes.
    CountersReader(const std::byte* memory, CounterNames names) : CountersReader(checked(memory), names) {}

    /// Number of counters.
    std::size_t size() const noexcept { return names_.size(); }
    /// Name of counter i.
    std::string_view name(std::size_t i) const noexcept { return names_[i]; }
    /// Value of counter i.
    std::uint64_t read(std::size_t i) const noexcept {
        return HardwareMemory::load(words_[i], std::memory_order::relaxed);
    }

  protected:
    /// Of words that were checked.
    CountersReader(std::uint64_t* words, CounterNames names) : words_(words), names_(names) {}
    /// Throws std::invalid_argument if `memory` is not aligned to 128 bytes.
    static std::uint64_t* checked(const std::byte* memory);

    /// The counters.
    std::uint64_t* words_;
    /// Their names.
    CounterNames names_;
};

/// The one writer of a block. Relaxed: a counter orders nothing.
class Counters : public CountersReader {
  public:
    /// Throws std::invalid_argument if `memory` is not aligned to 128 bytes.
    Counters(std::byte* memory, CounterNames names) : CountersReader(checked(memory), names) {}

    /// Sets counter i.
    void set(std::size_t i, std::uint64_t value) noexcept {
        HardwareMemory::store(words_[i], value, std::memory_order::relaxed);
    }
    /// Adds to counter i: load and store, not a locked addition, since nobody else writes.
    void increment(std::size_t i, std::uint64_t by = 1) noexcept { set(i, read(i) + by); }
};

}  // namespace knurl::shm
