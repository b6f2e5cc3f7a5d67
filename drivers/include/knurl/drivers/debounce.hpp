#pragma once
// Contact bounce: what a button's contacts say while they settle is no edge.

#include <array>
#include <cstdint>
#include <limits>

#include <knurl/drivers/device.hpp>

namespace knurl::drivers {

/// An edge is told at once; for `hold` after it that button is left alone, then its level is followed again.
/// So nothing comes late and nothing is lost: a press shorter than `hold` is told as one that long. Time is
/// the caller's, so the same reads give the same edges.
class Debounce {
  public:
    static constexpr double usual = 5e-3;  // s
    static constexpr double longest = 0.1;

    explicit Debounce(double hold) noexcept : hold_(static_cast<Nanoseconds>(hold * 1e9)) {
        free_from_.fill(std::numeric_limits<Nanoseconds>::min());
    }

    /// The level of every button as it is told, of its level as read.
    std::uint32_t operator()(Nanoseconds now, std::uint32_t raw) noexcept;
    std::uint32_t told() const noexcept { return told_; }

  private:
    Nanoseconds hold_;
    std::uint32_t told_ = 0;
    std::array<Nanoseconds, 32> free_from_;  // of each button
};

}  // namespace knurl::drivers
