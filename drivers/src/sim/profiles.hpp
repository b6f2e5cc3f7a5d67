#pragma once

#include <string_view>

#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// False if there is no such profile.
bool make_named_profile(std::string_view name, SimProfile& profile);

/// Levers of a profile whose mechanism, centre, workspace and counts are known, from its Jacobian: `lever` at
/// the centre, `largest_lever` over the workspace.
void set_levers(SimProfile& profile);

}  // namespace knurl::drivers
