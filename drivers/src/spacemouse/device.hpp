#pragma once
// The driver "spacemouse": a 3Dconnexion cap as a hand with six degrees of freedom and no force.

#include <knurl/drivers/registry.hpp>

namespace knurl::drivers::spacemouse {

Driver driver();

}  // namespace knurl::drivers::spacemouse
