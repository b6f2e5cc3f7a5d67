#pragma once
// The far end of the emulated cable: one kind of USB device, as its host controller sees it.

#include <climits>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace knurl::drivers::usb_emulator {

/// Answers of a model besides a number of bytes or a negative errno: not now, ask again.
inline constexpr int nak = INT_MIN;

struct Setup {
    std::uint8_t type = 0, request = 0;
    std::uint16_t value = 0, index = 0, length = 0;
};

struct Identity {
    std::uint16_t vendor = 0, product = 0;
    std::string name;
    std::uint8_t interface_class = 0xff;
    bool interrupt_endpoints = false;     // else bulk
    std::vector<std::uint8_t> endpoints;  // addresses, all of 64 bytes
    std::string kernel_driver;            // bound to interface 0 when it is plugged in; empty: none
};

/// Device, configuration, interface and endpoint descriptors as sysfs shows them: one configuration, one
/// interface. USB 2.0, tables 9-8 to 9-13.
std::vector<std::uint8_t> descriptors(const Identity& identity);

/// All calls come with the bus's lock held, never two at once.
class Model {
  public:
    virtual ~Model() = default;

    /// So many requests meet an endpoint that stalls; each halts it until the halt is cleared.
    int stalls_in = 0, stalls_out = 0;

    virtual const Identity& identity() const = 0;
    /// Bytes moved, or -EPIPE to stall.
    virtual int control(const Setup& setup, std::span<std::uint8_t> data) = 0;
    /// Bytes taken, `nak`, or a negative errno.
    virtual int out(std::uint8_t endpoint, std::span<const std::uint8_t> packet) = 0;
    /// Bytes put into `room`, `nak`, or a negative errno.
    virtual int in(std::uint8_t endpoint, std::span<std::uint8_t> room) = 0;
    /// A millisecond of the bus has passed: the start of frame `number`.
    virtual void frame(std::uint64_t number) = 0;
    /// Power is on: everything that it was told before unplugging is forgotten.
    virtual void power_on() = 0;
};

}  // namespace knurl::drivers::usb_emulator
