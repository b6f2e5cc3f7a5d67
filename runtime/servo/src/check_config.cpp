// knurld --check-config: prints what a servo would run.

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/servo/daemon.hpp>

namespace knurl::servo {

namespace {

/// One device's line; `stated` gets the device's own name, where it is known.
std::string line_of(DeviceConfig& stated, const DaemonConfig& config) {
    std::unique_ptr<drivers::Device> device;
    try {
        device = drivers::open_device(
            stated.address,
            {.hand_file = stated.hand_file, .seed = stated.seed, .io_priority = 0, .check_only = true});
    } catch (const std::runtime_error& error) {
        throw ConfigError(fmt::format("device {}: {}", stated.address, error.what()));
    }
    double rate = stated.rate != 0 ? stated.rate : config.rate;
    if (device) {
        const drivers::LinkConfig& link = device->link();
        if (stated.name.empty()) stated.name = link.name;
        if (rate == 0) rate = std::min(default_rate, link.nominal_rate);
        check_limits(stated.limits, link, fmt::format("device \"{}\"", stated.name));
    }
    return fmt::format("  {} ({}): {}\n", stated.name.empty() ? "named by its profile" : stated.name,
                       stated.address,
                       rate == 0 ? "at its own rate, 1000 Hz at most" : fmt::format("{:g} Hz", rate));
}

}  // namespace

std::string plan_of(const DaemonConfig& stated) {
    DaemonConfig config = stated;
    std::string text =
        fmt::format("knurl:{}: priority {}, {}, {}\n", config.name, config.priority,
                    config.cpu == -1 ? "the last CPU allowed" : fmt::format("CPU {}", config.cpu),
                    config.idle == Idle::poll ? "idle CPUs poll" : "idle CPUs sleep");
    for (DeviceConfig& device : config.devices) text += line_of(device, stated);
    check(config);  // with these names, two devices may have the same name
    return text;
}

}  // namespace knurl::servo
