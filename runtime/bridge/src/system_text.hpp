#pragma once

#include <string>
#include <system_error>

namespace knurl::bridge {

/// The system's text for an errno.
inline std::string system_text(int error) {
    return std::generic_category().message(error);
}

}  // namespace knurl::bridge
