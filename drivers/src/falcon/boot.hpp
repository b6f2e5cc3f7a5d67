#pragma once
// Loads a firmware into a Falcon whose ROM waits for it.

#include <string>

#include "falcon/firmware.hpp"
#include "usb/session.hpp"

namespace knurl::drivers::falcon {

inline constexpr int boot_attempts = 5;
inline constexpr const char* rom_is_silent = "its boot ROM does not answer";

/// FTDI, AN232B-04 and the Linux driver ftdi_sio: bmRequestType 0x40, wIndex 0.
enum class Ftdi : std::uint8_t { reset = 0, modem = 1, flow = 2, baud = 3, data = 4, event = 6, latency = 9 };
void ftdi(usb::Session& session, Ftdi request, std::uint16_t value);

inline constexpr std::uint16_t ftdi_purge_in = 1, ftdi_purge_out = 2;

/// One attempt. Empty: loaded. Else the error. Throws usb::Unplugged.
std::string boot(usb::Session& session, const Firmware& firmware);
/// Latency 1 ms, 1.5 Mbaud, empty buffers: the settings for the running firmware.
void set_up_for_running(usb::Session& session, bool event_character);

}  // namespace knurl::drivers::falcon
