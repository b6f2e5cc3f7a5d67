#pragma once
// What the I/O thread needs to know about a device: how to start it, what to send, how to parse its packets.
// Also the data that thread and cycle exchange.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <knurl/drivers/device.hpp>

#include "usb/session.hpp"

namespace knurl::drivers::usb {

inline constexpr std::size_t packet_bytes = 64;

/// From the device, raw.
struct Reading {
    std::array<std::int32_t, max_joints> counts = {};
    std::uint32_t buttons = 0;
    bool calibrated = false;
    std::uint64_t session = 0;  // number of the opening
};

/// To the device.
struct Orders {
    std::array<std::int16_t, max_joints> efforts = {};  // in the device's own unit
    std::uint32_t flags = 0;                            // the protocol's
    std::uint64_t session = 0;                          // of the reading to which they respond
    std::uint64_t acts = 0;                             // ZeroLine::acts() at that time
};

struct Heard {
    bool reading = false;  // the reading was updated
    int garbage = 0;       // number of malformed parts
};

/// All of it runs on one thread: the opening thread or the I/O thread.
class Protocol {
  public:
    virtual ~Protocol() = default;

    virtual int interface() const { return 0; }
    virtual bool takes_efforts() const { return true; }
    /// Brings a freshly opened device to a state in which it accepts packets, with its motors at zero and a
    /// first reading. May block. Throws std::runtime_error: what is wrong and what to do.
    virtual void start(Session& session, Reading& first) = 0;
    /// The packet for these orders; returns its length. Orders{} are zero efforts.
    virtual std::size_t pack(const Orders& orders, std::span<std::uint8_t, packet_bytes> packet) noexcept = 0;
    /// Parses a packet from the device.
    virtual Heard hear(std::span<const std::uint8_t> packet, Reading& reading) noexcept = 0;
};

}  // namespace knurl::drivers::usb
