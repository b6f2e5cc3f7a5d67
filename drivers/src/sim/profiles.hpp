#pragma once

#include <string_view>

#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// False if there is no such profile.
bool make_named_profile(std::string_view name, SimProfile& profile);

/// Computes the levers of a profile from its Jacobian: `lever` at the centre, `largest_lever` over the
/// workspace. Needs mechanism, centre, workspace and counts.
void set_levers(SimProfile& profile);

}  // namespace knurl::drivers
