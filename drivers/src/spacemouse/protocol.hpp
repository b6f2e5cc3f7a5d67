#pragma once
// Reports of a SpaceMouse, low byte first: 1: three int16 of translation, on some models followed by three of
// rotation; 2: rotation; 3: buttons, a bit each. An untouched cap sends nothing.

#include "usb/protocol.hpp"

namespace knurl::drivers::spacemouse {

class Protocol final : public usb::Protocol {
  public:
    bool takes_efforts() const override { return false; }

    void start(usb::Session&, usb::Reading& first) override { first.calibrated = true; }

    std::size_t pack(const usb::Orders&, std::span<std::uint8_t, usb::packet_bytes>) noexcept override {
        return 0;
    }

    /// counts[0..2]: translation, [3..5]: rotation, in the device's axes.
    usb::Heard hear(std::span<const std::uint8_t> packet, usb::Reading& reading) noexcept override {
        if (packet.empty()) return {.garbage = 1};
        const auto words = [&](std::size_t from, std::size_t n) {
            if (packet.size() < 1 + 2 * n) return false;
            for (std::size_t i = 0; i < n; ++i)
                reading.counts[from + i] =
                    static_cast<std::int16_t>(packet[1 + 2 * i] | packet[2 + 2 * i] << 8);
            return true;
        };
        switch (packet[0]) {
            case 1:
                if (words(0, packet.size() >= 13 ? 6 : 3)) return {.reading = true};
                break;
            case 2:
                if (words(3, 3)) return {.reading = true};
                break;
            case 3:
                if (packet.size() < 2) break;
                reading.buttons = 0;
                for (std::size_t i = 1; i < std::min<std::size_t>(packet.size(), 5); ++i)
                    reading.buttons |= std::uint32_t{packet[i]} << (8 * (i - 1));
                return {.reading = true};
            default:
                return {};  // battery, firmware: ignored
        }
        return {.garbage = 1};
    }
};

}  // namespace knurl::drivers::spacemouse
