#pragma once
// The driver "falcon".

#include <knurl/drivers/registry.hpp>

#include "usb/session.hpp"

namespace knurl::drivers::falcon {

inline constexpr usb::DeviceId ids[] = {{0x0403, 0xcb48}};

Driver driver();

}  // namespace knurl::drivers::falcon
