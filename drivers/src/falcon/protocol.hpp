#pragma once
// A Falcon on USB: FTDI chip, boot, run. Facts as published with libnifalcon, FTDI AN232B-04 and TI's boot
// ROM guide.

#include <optional>

#include "falcon/firmware.hpp"
#include "falcon/packet.hpp"
#include "usb/protocol.hpp"

namespace knurl::drivers::falcon {

inline constexpr std::int16_t most_counts = 4096;  // of motor effort

/// Orders::flags are info bits: LEDs. Homing is the protocol's own business.
class Protocol final : public usb::Protocol {
  public:
    /// Without a firmware a Falcon must be running already.
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
    bool heard_ = false;  // it has said whether it is homed
    bool homed_ = false;
};

}  // namespace knurl::drivers::falcon
