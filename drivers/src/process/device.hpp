#pragma once
// The drivers dhd:, hd: and inverse: as the servo sees them: words of a mapping, and a bell.

#include <memory>
#include <string_view>

#include <knurl/drivers/registry.hpp>

namespace knurl::drivers::process {

/// Force Dimension's delta, omega, sigma and lambda.
Driver dhd_driver();
/// 3D Systems' Touch, Touch X, PHANToM.
Driver hd_driver();
/// Haply's Inverse3.
Driver inverse_driver();

}  // namespace knurl::drivers::process
