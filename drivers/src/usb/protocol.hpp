#pragma once
// What a driver tells the I/O thread about its device: how it is started, asked and understood. And the words
// that thread and cycle exchange.

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
    std::uint64_t session = 0;  // of which opening it is
};

/// To the device.
struct Orders {
    std::array<std::int16_t, max_joints> efforts = {};  // in the device's own unit
    std::uint32_t flags = 0;                            // the protocol's
    std::uint64_t session = 0;                          // of the reading that they answer
    std::uint64_t acts = 0;                             // ZeroLine::acts() then
};

struct Heard {
    bool reading = false;  // it was brought up to date
    int garbage = 0;       // times that something did not make sense
};

/// All of it runs on one thread, the opener's or the I/O thread.
class Protocol {
  public:
    virtual ~Protocol() = default;

    virtual int interface() const { return 0; }
    virtual bool takes_efforts() const { return true; }
    /// Brings a freshly opened device to where it takes packets, with its motors at zero, and has a first
    /// reading of it. May wait. Throws std::runtime_error: what is wrong and what to do.
    virtual void start(Session& session, Reading& first) = 0;
    /// The packet for these orders; returns its length. Orders{} are zero efforts.
    virtual std::size_t pack(const Orders& orders, std::span<std::uint8_t, packet_bytes> packet) noexcept = 0;
    /// A packet from the device.
    virtual Heard hear(std::span<const std::uint8_t> packet, Reading& reading) noexcept = 0;
};

}  // namespace knurl::drivers::usb
