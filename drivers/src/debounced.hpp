#pragma once
// Wraps any device so that its buttons do not bounce.

#include <memory>

#include <knurl/drivers/debounce.hpp>

namespace knurl::drivers {

/// Returns the device itself if `hold` is 0 or it has no buttons.
std::unique_ptr<Device> debounced(std::unique_ptr<Device> device, double hold);

}  // namespace knurl::drivers
