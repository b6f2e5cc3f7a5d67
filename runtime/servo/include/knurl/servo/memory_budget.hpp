#pragma once

/// @file
/// How much memory the clients of a servo may make it lock, all together.

#include <cstdint>
#include <utility>

#include <knurl/protocol/claim_segment.hpp>

namespace knurl::servo {

/// A sum with a bound. Used by the broker's thread alone.
class MemoryBudget {
  public:
    /// `total` in bytes.
    explicit MemoryBudget(std::uint64_t total) : total_(total) {}
    /// All of it (bytes).
    std::uint64_t total() const noexcept { return total_; }
    /// What is left (bytes).
    std::uint64_t left() const noexcept { return total_ - taken_; }

  private:
    friend class MemoryShare;
    std::uint64_t total_;
    std::uint64_t taken_ = 0;
};

/// A part that was taken from a budget, given back when this object ends.
class MemoryShare {
  public:
    /// Nothing.
    MemoryShare() = default;
    /// Takes `bytes`, of which MemoryBudget::left() has enough.
    MemoryShare(MemoryBudget& budget, std::uint64_t bytes) noexcept : budget_(&budget), bytes_(bytes) {
        budget.taken_ += bytes;
    }
    ~MemoryShare() {
        if (budget_ != nullptr) budget_->taken_ -= bytes_;
    }
    /// Moves; the other one holds nothing any more.
    MemoryShare(MemoryShare&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}
    /// Exchanges both parts.
    MemoryShare& operator=(MemoryShare&& other) noexcept {
        std::swap(budget_, other.budget_);
        std::swap(bytes_, other.bytes_);
        return *this;
    }

  private:
    MemoryBudget* budget_ = nullptr;
    std::uint64_t bytes_ = 0;
};

/// What a claim of this capacity takes (bytes): its segment, and what the servo keeps for its scene.
std::uint64_t claim_bytes(const protocol::ClaimCapacity& capacity) noexcept;
/// A quarter of the memory that the machine, or the container, has (bytes).
std::uint64_t default_memory_budget();

}  // namespace knurl::servo
