#pragma once
// What of a claim's scene watchers have not been shown yet: one bit for each slot. Marking is cheap and bounded; a cycle
// then writes a few of the marked slots as they are.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace knurl::servo {

class Unshown {
  public:
    /// Allocates; nothing afterwards does.
    explicit Unshown(std::size_t slots) : slots_(slots), changed_((slots + 63) / 64) {}

    /// All of it, from the first slot on. Slots are looked at when their turn comes.
    void all() noexcept {
        claim_ = true;
        probes_ = ~std::uint32_t{0};
        swept_ = 0;
        any_ = true;
    }
    void claim() noexcept { claim_ = any_ = true; }
    void probe(std::uint32_t probe) noexcept {
        probes_ |= 1u << probe;
        any_ = true;
    }
    void slot(std::uint32_t slot) noexcept {
        changed_[slot / 64] |= std::uint64_t{1} << slot % 64;
        any_ = true;
    }

    bool any() const noexcept { return any_; }
    bool take_claim() noexcept {
        const bool was = claim_;
        claim_ = false;
        return was;
    }
    /// The next probe; none: all were taken.
    std::optional<std::uint32_t> take_probe() noexcept {
        if (probes_ == 0) return std::nullopt;
        const auto probe = static_cast<std::uint32_t>(std::countr_zero(probes_));
        probes_ &= probes_ - 1;
        return probe;
    }
    struct Slot {
        std::uint32_t slot = 0;
        bool changed = false;  // false: its turn came in the sweep, so an empty one is no news
    };
    /// The next slot; takes `most` slots of the sweep at most. None: all were taken, or the sweep goes on in the next
    /// cycle (any()).
    std::optional<Slot> take_slot(std::uint32_t& most) noexcept {
        for (std::size_t w = 0; w < changed_.size(); ++w) {
            if (changed_[w] == 0) continue;
            const auto bit = static_cast<std::uint32_t>(std::countr_zero(changed_[w]));
            changed_[w] &= changed_[w] - 1;
            return Slot{.slot = static_cast<std::uint32_t>(64 * w) + bit, .changed = true};
        }
        if (swept_ < slots_ && most == 0) return std::nullopt;
        if (swept_ < slots_) {
            --most;
            return Slot{.slot = static_cast<std::uint32_t>(swept_++)};
        }
        any_ = claim_ || probes_ != 0;
        return std::nullopt;
    }

  private:
    std::size_t slots_, swept_ = slots_;
    std::vector<std::uint64_t> changed_;
    std::uint32_t probes_ = 0;
    bool claim_ = false, any_ = false;
};

}  // namespace knurl::servo
