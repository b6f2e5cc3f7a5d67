#pragma once
// The driver "wooden": WoodenHaptics with the Polhem controller.

#include <knurl/drivers/registry.hpp>

namespace knurl::drivers::wooden {

Driver driver();

}  // namespace knurl::drivers::wooden
