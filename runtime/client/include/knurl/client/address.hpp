#pragma once

/// @file
/// What can be the address of a servo.

#include <string>

namespace knurl {

/// Throws Error, one line, for what can be the address of no servo, whether one runs there or not: for
/// programs that refuse a command line before they begin.
void check_address(const std::string& address);

}  // namespace knurl
