// Any bytes as knurld's configuration: refused in one line, or all values are within their ranges.

#include <cstdint>
#include <string>

#include <knurl/protocol/name.hpp>
#include <knurl/servo/config.hpp>

#include "refusal.hpp"

using namespace knurl;
using fuzz::require;

namespace {

bool within(const servo::Range& range, double value) {
    return value >= range.low && value <= range.high;
}

void check_device(const servo::DeviceConfig& device) {
    namespace ranges = servo::ranges;
    // A device without a name gets the name of its profile.
    require((device.name.empty() || protocol::is_name(device.name)) && !device.address.empty(),
            "a device has an address, and its name is one");
    require(device.rate == 0 || within(ranges::rate, device.rate), "a device has a rate");
    constexpr servo::SupervisorLimits widest;
    const servo::SupervisorLimits& limits = device.limits;
    require(limits.thermal_time <= widest.thermal_time && limits.speed_fault <= widest.speed_fault &&
                limits.power <= widest.power && limits.ramp_up >= widest.ramp_up &&
                limits.arm_speed <= widest.arm_speed && limits.workspace_margin <= widest.workspace_margin,
            "limits are only tightened");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string path = "c.toml";
    bool read = false;
    try {
        const servo::DaemonConfig config =
            servo::parse_config({reinterpret_cast<const char*>(data), size}, path);
        read = true;
        servo::check(config);
        require(protocol::is_name(config.name), "a servo has a name");
        require(config.rate == 0 || within(servo::ranges::rate, config.rate), "a servo has a rate");
        require(within(servo::ranges::priority, config.priority) &&
                    within(servo::ranges::guardian_stall, config.guardian_stall),
                "numbers are within their ranges");
        require(!config.devices.empty(), "a servo has a device");
        for (const servo::DeviceConfig& device : config.devices) check_device(device);
    } catch (const servo::ConfigError& error) {
        // check() also serves the command line, so it names no file.
        fuzz::check_refusal(error.what(), read ? "" : path + ":");
    }
    return 0;
}
