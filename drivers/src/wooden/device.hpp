#pragma once
// The driver "wooden": WoodenHaptics with the Polhem controller.

#include <knurl/drivers/registry.hpp>

#include "usb/session.hpp"

namespace knurl::drivers::wooden {

/// What every Teensy with the RawHID sketch calls itself.
inline constexpr usb::DeviceId ids[] = {{0x16c0, 0x0486}};

Driver driver();

}  // namespace knurl::drivers::wooden
