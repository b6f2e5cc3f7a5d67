#pragma once

#include <string>
#include <system_error>

namespace knurl::bridge {

/// What the system says of an errno.
inline std::string system_text(int error) {
    return std::generic_category().message(error);
}

}  // namespace knurl::bridge
