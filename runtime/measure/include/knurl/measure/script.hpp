#pragma once

#include <string>

namespace knurl::measure {

/// A Knurl script as a user would type it: from this program's installation, else "scripts/NAME" of a
/// checkout.
std::string script(const std::string& name);

}  // namespace knurl::measure
