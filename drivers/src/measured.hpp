#pragma once
// Figures of one's own device, in place of those that its driver states.

#include <memory>
#include <string>

#include <knurl/drivers/device.hpp>

namespace knurl::drivers {

/// The device with the figures of a file that `knurl device calibrate` wrote: mass, damping and lag, from which the
/// stiffness of walls follows. Throws std::runtime_error "FILE: what; what to do".
std::unique_ptr<Device> measured(std::unique_ptr<Device> device, const std::string& file);
/// Only reads the file.
void check_measured(const std::string& file);

}  // namespace knurl::drivers
