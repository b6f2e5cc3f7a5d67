#pragma once

/// @file
/// Joints for a place of the tip, for any mechanism. At start and in tools, never in a cycle.

#include <optional>

#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// The joints that bring the tip to `position` (m) and, if given, turn it to `orientation`, by damped Newton
/// steps from the posture `from`. Nothing if it does not get within 1e-9 m (1e-6 rad). Joint limits are not
/// looked at.
std::optional<JointArray> reach(const Mechanism& mechanism, const JointArray& from,
                                const Eigen::Vector3d& position,
                                const std::optional<Eigen::Quaterniond>& orientation = {});

}  // namespace knurl::drivers
