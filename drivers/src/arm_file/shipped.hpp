#pragma once
// The files of drivers/arms/, built in. shipped_arms.cpp is made of them by CMake.

#include <span>
#include <string_view>

namespace knurl::drivers {

struct ShippedArm {
    std::string_view name, text;
};
extern const std::span<const ShippedArm> shipped;

/// Where `cmake --install` puts them.
extern const std::string_view installed_arms;

}  // namespace knurl::drivers
