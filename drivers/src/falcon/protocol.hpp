#pragma once
// A Falcon on USB: FTDI chip, boot, run. The facts are as published with libnifalcon, FTDI AN232B-04 and TI's
// boot ROM guide.

#include <optional>

#include "falcon/firmware.hpp"
#include "falcon/packet.hpp"
#include "usb/protocol.hpp"

namespace knurl::drivers::falcon {

inline constexpr std::int16_t most_counts = 4096;  // of motor effort

/// Orders::flags are info bits: LEDs. The protocol handles homing itself.
class Protocol final : public usb::Protocol {
  public:
    /// Without a firmware the Falcon must already be running.
    Protocol(std::optional<Firmware> firmware, bool event_character)
        : firmware_(std::move(firmware)), event_character_(event_character) {}

    void start(usb::Session& session, usb::Reading& first) override;
    std::size_t pack(const usb::Orders& orders,
                     std::span<std::uint8_t, usb::packet_bytes> packet) noexcept override;
    usb::Heard hear(std::span<const std::uint8_t> packet, usb::Reading& reading) noexcept override;

  private:
    bool run(usb::Session& session, usb::Reading& first, int attempts);

    std::optional<Firmware> firmware_;
    bool event_character_;
    Reader reader_;
    bool heard_ = false;  // it has reported its homing state
    bool homed_ = false;
};

}  // namespace knurl::drivers::falcon
