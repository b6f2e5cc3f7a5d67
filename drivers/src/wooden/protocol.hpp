#pragma once
// Reports of the Polhem controller, 64 bytes each way, int16, low byte first:
//   in:  encoder[6], info
//   out: motor[3] mA, command (0: none), attribute[3]
// Facts as in the published source of WoodenHaptics; nothing was tried on a device.

#include <chrono>

#include "usb/protocol.hpp"

namespace knurl::drivers::wooden {

inline constexpr std::size_t motors = 3;
inline constexpr std::size_t encoders = 6;
inline constexpr double most_milliamperes = 32767;

class Protocol final : public usb::Protocol {
  public:
    void start(usb::Session& session, usb::Reading& first) override {
        std::array<std::uint8_t, usb::packet_bytes> packet{};
        constexpr std::chrono::milliseconds patience{100};
        constexpr int asks = 10;
        for (int i = 0; i < asks; ++i) {
            session.write(std::span(packet.data(), pack({}, packet)), patience);
            const std::size_t n = session.read(packet, patience);
            if (hear(std::span(packet.data(), n), first).reading) return;
        }
        throw std::runtime_error(
            session.info().address() +
            " does not answer as a Polhem controller does; any Teensy with "
            "RawHID looks the same on USB: name another with wooden:SERIAL, or load its program");
    }

    std::size_t pack(const usb::Orders& orders,
                     std::span<std::uint8_t, usb::packet_bytes> packet) noexcept override {
        std::ranges::fill(packet, std::uint8_t{0});
        for (std::size_t i = 0; i < motors; ++i) {
            const auto word = static_cast<std::uint16_t>(orders.efforts[i]);
            packet[2 * i] = static_cast<std::uint8_t>(word & 0xff);
            packet[2 * i + 1] = static_cast<std::uint8_t>(word >> 8);
        }
        return usb::packet_bytes;
    }

    usb::Heard hear(std::span<const std::uint8_t> packet, usb::Reading& reading) noexcept override {
        if (packet.size() != usb::packet_bytes) return {.garbage = 1};
        for (std::size_t i = 0; i < encoders; ++i)
            reading.counts[i] = static_cast<std::int16_t>(packet[2 * i] | packet[2 * i + 1] << 8);
        reading.calibrated = true;
        return {.reading = true};
    }
};

}  // namespace knurl::drivers::wooden
