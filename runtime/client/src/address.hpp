#pragma once

#include <string>

namespace knurl::detail {

/// "knurl:NAME" or "NAME" -> NAME. Throws Error for a remote address (this build has no bridge) and for a
/// name that can be no servo's.
std::string servo_name(const std::string& address);

}  // namespace knurl::detail
