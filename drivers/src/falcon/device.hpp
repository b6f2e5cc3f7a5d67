#pragma once
// The driver "falcon".

#include <knurl/drivers/registry.hpp>

namespace knurl::drivers::falcon {

Driver driver();

}  // namespace knurl::drivers::falcon
