#pragma once

/// @file
/// Contact bounce: what a button's contacts say while they settle is no edge.

#include <array>
#include <cstdint>
#include <limits>

#include <knurl/drivers/device.hpp>

namespace knurl::drivers {

/// Follows the contacts of buttons. It reports an edge at once; for `hold` after it that button's contacts
/// are ignored, then its level is followed again. So no edge comes late and none is lost: a press shorter
/// than `hold` becomes one that long. Time is the caller's, so the same reads give the same edges.
class Debounce {
  public:
    /// Usual `hold` (s).
    static constexpr double usual = 5e-3;
    /// Longest `hold` (s).
    static constexpr double longest = 0.1;

    /// `hold`: time for which contacts are ignored after an edge (s).
    explicit Debounce(double hold) noexcept : hold_(static_cast<Nanoseconds>(hold * 1e9)) {
        free_from_.fill(std::numeric_limits<Nanoseconds>::min());
    }

    /// Level of every button (a bit each), from its level as read at the time `now`.
    std::uint32_t operator()(Nanoseconds now, std::uint32_t raw) noexcept;
    /// Level of every button as reported last.
    std::uint32_t told() const noexcept { return told_; }

  private:
    Nanoseconds hold_;
    std::uint32_t told_ = 0;
    std::array<Nanoseconds, 32> free_from_;  // of each button
};

}  // namespace knurl::drivers
