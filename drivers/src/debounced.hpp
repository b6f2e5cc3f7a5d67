#pragma once
// A device whose buttons do not bounce, made of any.

#include <memory>

#include <knurl/drivers/debounce.hpp>

namespace knurl::drivers {

/// The device itself where `hold` is 0, or where it has no buttons: then nothing stands between.
std::unique_ptr<Device> debounced(std::unique_ptr<Device> device, double hold);

}  // namespace knurl::drivers
