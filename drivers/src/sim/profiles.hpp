#pragma once

#include <string_view>

#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// False if there is no such profile.
bool make_named_profile(std::string_view name, SimProfile& profile);

}  // namespace knurl::drivers
