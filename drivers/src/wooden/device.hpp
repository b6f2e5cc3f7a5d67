#pragma once
// The driver "wooden": WoodenHaptics with the Polhem controller.

#include <knurl/drivers/registry.hpp>

namespace knurl::drivers::wooden {

/// What every Teensy with the RawHID sketch calls itself.
Driver driver();

}  // namespace knurl::drivers::wooden
