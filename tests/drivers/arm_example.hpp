#pragma once
// An arm without a mistake, as a file, and where its tip is.

#include <stdexcept>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include <knurl/drivers/arm_file.hpp>

namespace knurl::drivers::arms {

/// Small; tests make mistakes in it.
inline constexpr std::string_view good = R"(name = "mine"
source = "measured"
position_only = true
coupling = [[1, 0, 0], [0, 1, 0], [0, -1, 1]]

[[row]]
alpha_deg = 90
[[row]]
a = 0.215
[[row]]
theta_deg = -90
a = 0.170

[[axis]]
name = "turret"
limits_deg = [-60, 60]
counts_per_turn = 4000
gear = 10
effort_limit = 1.5
[[axis]]
name = "upper arm"
limits_deg = [-20, 90]
radians_per_count = 1.5e-4
[[axis]]
name = "forearm"
limits = "unknown"

[workspace]
centre_deg = [0, 20, 0]
radius = 0.08
[tip]
peak_force = 8.5
friction = 0.04
friction_source = "a spring balance"
)";

/// The good arm with one piece replaced; the piece must be there.
inline std::string with(const std::string& piece, const std::string& other) {
    std::string text(good);
    const auto at = text.find(piece);
    if (at == std::string::npos) throw std::logic_error("the good arm has no " + piece);
    return text.replace(at, piece.size(), other);
}

/// Tip of a device's joints, from its mechanism.
inline Eigen::Vector3d tip(const ArmFile& arm, const JointArray& q) {
    TipPose pose;
    Jacobian jacobian;
    EXPECT_TRUE(SerialChain(arm.table).forward(q, pose, jacobian));
    return pose.position;
}

}  // namespace knurl::drivers::arms
