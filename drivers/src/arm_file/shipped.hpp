#pragma once
// The files of drivers/arms/, built in. CMake generates shipped_arms.cpp from them.

#include <span>
#include <string_view>

namespace knurl::drivers {

struct ShippedArm {
    std::string_view name, text;
};
extern const std::span<const ShippedArm> shipped;

/// The folder into which `cmake --install` puts them.
extern const std::string_view installed_arms;

}  // namespace knurl::drivers
