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

    /// All of it. Slots are looked at when their turn comes.
    void all() noexcept {
        claim_ = true;
        probes_ = ~std::uint32_t{0};
        unswept_ = slots_;
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
    /// The claim itself has not been shown: nothing else of it is, before.
    bool claim_waits() const noexcept { return claim_; }
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
    /// The next slot, in turn, so that none waits for ever behind those that change in each cycle; takes `most` slots of
    /// the sweep at most. None: all were taken, or the sweep goes on in the next cycle (any()).
    std::optional<Slot> take_slot(std::uint32_t& most) noexcept {
        if (unswept_ > 0) {
            if (most == 0) return std::nullopt;
            --most;
            --unswept_;
            return taken(next_ % slots_);
        }
        for (std::size_t n = 0; n <= changed_.size(); ++n) {
            if (next_ >= slots_) next_ = 0;
            const std::uint64_t rest = changed_[next_ / 64] >> next_ % 64;
            if (rest != 0) return taken(next_ + static_cast<std::size_t>(std::countr_zero(rest)));
            next_ = (next_ / 64 + 1) * 64;
        }
        any_ = claim_ || probes_ != 0;
        return std::nullopt;
    }

  private:
    Slot taken(std::size_t slot) noexcept {
        const std::uint64_t bit = std::uint64_t{1} << slot % 64;
        const bool changed = (changed_[slot / 64] & bit) != 0;
        changed_[slot / 64] &= ~bit;
        next_ = slot + 1;
        return {.slot = static_cast<std::uint32_t>(slot), .changed = changed};
    }

    std::size_t slots_, next_ = 0, unswept_ = 0;
    std::vector<std::uint64_t> changed_;
    std::uint32_t probes_ = 0;
    bool claim_ = false, any_ = false;
};

}  // namespace knurl::servo
