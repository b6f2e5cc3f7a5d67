// Any bytes as the description of an arm: it is refused in one line, or its figures are valid and its
// kinematics are finite at the stated centre.

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/drivers/serial_chain.hpp>

#include "refusal.hpp"

using namespace knurl;
using fuzz::require;

namespace {

void check_arm(const drivers::ArmFile& arm) {
    require(!arm.name.empty() && arm.joints() >= 1 && arm.joints() <= drivers::max_joints &&
                arm.actuated() <= arm.joints(),
            "an arm has a name and axes");
    for (const drivers::ArmFigure& figure : arm.figures)
        require(!figure.name.empty() && !figure.source.empty(), "a figure has a source");
    require(std::isfinite(arm.workspace_radius) && arm.workspace_radius > 0, "a workspace has a radius");
    require(std::isfinite(arm.rate) && arm.rate > 0, "an arm has a rate");
    const drivers::SerialChain chain(arm.table);
    drivers::TipPose pose;
    drivers::Jacobian jacobian;
    require(chain.forward({arm.centre.data(), arm.joints()}, pose, jacobian) && pose.position.allFinite() &&
                pose.orientation.coeffs().allFinite() && jacobian.allFinite(),
            "the tip is somewhere");
}

void check_link(const drivers::LinkConfig& link) {
    require(link.sensed_joints >= 1 && link.actuated_joints <= link.sensed_joints, "a link has joints");
    for (const double number :
         {link.workspace_radius, link.nominal_rate, link.peak_force, link.continuous_force, link.peak_torque,
          link.damping, link.rotational_damping, link.lag, link.measured_max_stiffness, link.apparent_mass,
          link.watchdog_time})
        require(std::isfinite(number) && number >= 0, "figures of a link are numbers");
    for (const double number : link.radians_per_count) require(std::isfinite(number), "a count is an angle");
    for (const double number : link.effort_limit) require(number >= 0, "a motor has a limit");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const drivers::ArmFile arm =
            drivers::parse_arm({reinterpret_cast<const char*>(data), size}, "a.toml");
        check_arm(arm);
        check_link(drivers::link_of(arm));
        std::vector<std::string> assumed;
        drivers::sim_profile_of(arm, &assumed);
        for (const std::string& line : assumed) fuzz::check_refusal(line, "");
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "a.toml:", 800);
    }
    return 0;
}
