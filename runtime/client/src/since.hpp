#pragma once
// What happened between two calls of Observer::newest(): from the reports read in between, by any call, and
// from their counters where reports were missed.

#include <cstdint>

#include <knurl/client/client.hpp>

namespace knurl::detail {

class Since {
  public:
    /// Call in order of the reports.
    void add(const Report& report) noexcept {
        if (known_) {
            const std::uint32_t turned = presses_ ^ report.presses;
            const std::uint32_t down = turned | (~buttons_ & report.buttons);
            pressed_ |= down;
            // A button that went down has also come up if it was down before, if it is up again, or if it
            // went down twice.
            released_ |= (buttons_ & ~report.buttons) | (down & (buttons_ | ~report.buttons | ~turned));
            touches_ += report.touches - begun_;  // modulo 2^32
        }
        touched_ |= (report.flags & report_flags::touching) != 0 || touches_ > 0;
        known_ = true;
        buttons_ = report.buttons;
        presses_ = report.presses;
        begun_ = report.touches;
    }

    /// Everything since the previous call; the next interval begins here. `frame`: from the report that was
    /// added last.
    void tell(HandFrame& frame) noexcept {
        frame.pressed = pressed_;
        frame.released = released_;
        frame.touched = touched_;
        frame.touches = touches_;
        frame.skipped = told_cycle_ != 0 && frame.cycle > told_cycle_ ? frame.cycle - told_cycle_ - 1 : 0;
        told_cycle_ = frame.cycle;
        pressed_ = released_ = touches_ = 0;
        touched_ = false;
    }

  private:
    bool known_ = false;  // there is a report with which to compare the next one
    std::uint32_t buttons_ = 0, presses_ = 0, begun_ = 0;
    std::uint32_t pressed_ = 0, released_ = 0, touches_ = 0;
    bool touched_ = false;
    std::uint64_t told_cycle_ = 0;
};

}  // namespace knurl::detail
