#pragma once

#include <string>

namespace knurl::measure {

/// A script of Knurl's as people would type it: of the installation that this program belongs to, else
/// "scripts/NAME", of a checkout.
std::string script(const std::string& name);

}  // namespace knurl::measure
