#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include <knurl/protocol/name.hpp>
#include <knurl/servo/config.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>
#include <knurl/words/toml.hpp>

namespace knurl::servo {

namespace {

// Limits may only be tightened: one end of each range is the default. Three limits default to the device's
// own figures. check_limits compares these once the device is open.
struct LimitKey {
    Range range;
    double SupervisorLimits::*member;
};
constexpr SupervisorLimits widest;
constexpr std::array limit_keys{
    LimitKey{{"peak_force", 1e-3, 1000, "N"}, &SupervisorLimits::peak_force},
    LimitKey{{"continuous_force", 1e-3, 1000, "N"}, &SupervisorLimits::continuous_force},
    LimitKey{{"peak_torque", 1e-6, 100, "N m"}, &SupervisorLimits::peak_torque},
    LimitKey{{"thermal_time", 0.1, widest.thermal_time, "s"}, &SupervisorLimits::thermal_time},
    LimitKey{{"slew", 2000, 100'000, "N/s"}, &SupervisorLimits::slew},  // a lower limit feeds energy into the
                                                                        // hand
    LimitKey{{"slew_fault_time", 1e-3, widest.slew_fault_time, "s"}, &SupervisorLimits::slew_fault_time},
    LimitKey{{"speed_damping_from", 0.01, widest.speed_damping_from, "m/s"},
             &SupervisorLimits::speed_damping_from},
    LimitKey{{"speed_fault", 0.05, widest.speed_fault, "m/s"}, &SupervisorLimits::speed_fault},
    LimitKey{{"power", 0.1, widest.power, "W"}, &SupervisorLimits::power},
    LimitKey{{"ramp_up", widest.ramp_up, 10, "s"}, &SupervisorLimits::ramp_up},
    LimitKey{{"ramp_down", 0.05, 0.1, "s"}, &SupervisorLimits::ramp_down},
    LimitKey{{"arm_speed", 0.01, widest.arm_speed, "m/s"}, &SupervisorLimits::arm_speed},
    LimitKey{{"workspace_margin", 1, widest.workspace_margin, "times the radius"},
             &SupervisorLimits::workspace_margin},
};

/// A word of the file or of the command line, in which any character may stand.
std::string shown(std::string_view word) {
    constexpr std::size_t longest = 60;
    return words::printable(word, longest);
}

std::string allowed(const Range& range) {
    return fmt::format("{:g} to {:g}{}{}", range.low, range.high, range.unit.empty() ? "" : " ", range.unit);
}

/// Reads one table and names the place in the file in its errors.
class Reader {
  public:
    Reader(const std::string& path, std::string prefix) : path_(path), prefix_(std::move(prefix)) {}

    std::string at(const toml::source_region& source) const {
        return fmt::format("{}:{}:{}", path_, source.begin.line, source.begin.column);
    }
    std::string at(const toml::node& node) const { return at(node.source()); }

    double number(const toml::node& node, const Range& range) const {
        const auto value = node.value<double>();
        if (!value || !node.is_number()) {
            throw wrong_type(node, range.key,
                             fmt::format("a number{}{}", range.unit.empty() ? "" : " in ", range.unit));
        }
        require_within(range, *value, fmt::format("{}: {}", at(node), prefix_));
        return *value;
    }
    std::int64_t whole(const toml::node& node, const Range& range) const {
        const auto value = node.value_exact<std::int64_t>();
        if (!value) throw wrong_type(node, range.key, "a whole number");
        require_within(range, static_cast<double>(*value), fmt::format("{}: {}", at(node), prefix_));
        return *value;
    }
    std::string text(const toml::node& node, std::string_view key) const {
        const auto value = node.value_exact<std::string>();
        if (!value) throw wrong_type(node, key, "a string");
        return *value;
    }
    std::string name(const toml::node& node, std::string_view key) const {
        const std::string value = text(node, key);
        require_name(value, fmt::format("{}: {}{}", at(node), prefix_, key));
        return value;
    }
    const toml::table& table(const toml::node& node, std::string_view key) const {
        if (const toml::table* found = node.as_table()) return *found;
        throw wrong_type(node, key, "a table");
    }
    ConfigError unknown(const toml::key& key, const std::vector<std::string_view>& known) const {
        return ConfigError(fmt::format(
            "{}: unknown key \"{}{}\"; {}", at(key.source()), prefix_, shown(key.str()),
            words::did_you_mean(key.str(), known, fmt::format("known here: {}", fmt::join(known, ", ")))));
    }
    ConfigError wrong_type(const toml::node& node, std::string_view key, std::string_view wanted) const {
        return ConfigError(
            fmt::format("{}: {}{} must be {}, not {}", at(node), prefix_, key, wanted, kind(node)));
    }

  private:
    static std::string_view kind(const toml::node& node) {
        switch (node.type()) {
            case toml::node_type::table:
                return "a table";
            case toml::node_type::array:
                return "an array";
            case toml::node_type::string:
                return "a string";
            case toml::node_type::integer:
                return "a whole number";
            case toml::node_type::floating_point:
                return "a number";
            case toml::node_type::boolean:
                return "true or false";
            default:
                return "a date or time";
        }
    }

    const std::string& path_;
    std::string prefix_;  // of keys in messages: "device.limits."
};

SupervisorLimits read_limits(const toml::table& table, const std::string& path) {
    const Reader read(path, "device.limits.");
    SupervisorLimits limits;
    for (auto&& [key, node] : table) {
        const std::string_view name = key.str();  // clang 14 cannot capture structured bindings
        const auto found = std::find_if(limit_keys.begin(), limit_keys.end(),
                                        [name](const LimitKey& k) { return k.range.key == name; });
        if (found == limit_keys.end()) {
            std::vector<std::string_view> known;
            for (const LimitKey& k : limit_keys) known.push_back(k.range.key);
            throw read.unknown(key, known);
        }
        limits.*found->member = read.number(node, found->range);
    }
    return limits;
}

DeviceConfig read_device(const toml::table& table, const std::string& path) {
    const Reader read(path, "device.");
    DeviceConfig device;
    for (auto&& [key, node] : table) {
        const std::string_view name = key.str();
        if (name == "name")
            device.name = read.name(node, name);
        else if (name == "address")
            device.address = read.text(node, name);
        else if (name == "hand")
            device.hand_file = read.text(node, name);
        else if (name == "seed")
            device.seed = static_cast<std::uint64_t>(read.whole(node, ranges::seed));
        else if (name == "rate")
            device.rate = read.number(node, ranges::rate);
        else if (name == "limits")
            device.limits = read_limits(read.table(node, name), path);
        else
            throw read.unknown(key, {"name", "address", "hand", "seed", "rate", "limits"});
    }
    if (device.address.empty()) {
        throw ConfigError(fmt::format(
            "{}: this device has no address; write, say, address = \"sim:premium15\"", read.at(table)));
    }
    return device;
}

Idle read_idle(const Reader& read, const toml::node& node) {
    const std::string value = read.text(node, "idle");
    if (value == "sleep") return Idle::sleep;
    if (value == "poll") return Idle::poll;
    throw ConfigError(
        fmt::format("{}: idle = \"{}\"; allowed: \"sleep\", \"poll\"", read.at(node), shown(value)));
}

DaemonConfig read_daemon(const toml::table& table, const std::string& path) {
    const Reader read(path, "");
    DaemonConfig config;
    for (auto&& [key, node] : table) {
        const std::string_view name = key.str();
        if (name == "name")
            config.name = servo_name(read.text(node, name), fmt::format("{}: name", read.at(node)));
        else if (name == "rate")
            config.rate = read.number(node, ranges::rate);
        else if (name == "cpu")
            config.cpu = static_cast<int>(read.whole(node, ranges::cpu));
        else if (name == "priority")
            config.priority = static_cast<int>(read.whole(node, ranges::priority));
        else if (name == "spin")
            config.spin = read.number(node, ranges::spin);
        else if (name == "guardian_stall")
            config.guardian_stall = read.number(node, ranges::guardian_stall);
        else if (name == "memory")
            config.memory = read.number(node, ranges::memory);
        else if (name == "socket_group")
            config.socket_group = read.text(node, name);
        else if (name == "idle")
            config.idle = read_idle(read, node);
        else if (name == "device") {
            const toml::array* devices = node.as_array();
            if (devices == nullptr) throw read.wrong_type(node, name, "an array of tables: write [[device]]");
            for (const toml::node& device : *devices) {
                config.devices.push_back(read_device(read.table(device, name), path));
            }
        } else {
            throw read.unknown(key, {"name", "rate", "cpu", "priority", "idle", "spin", "guardian_stall",
                                     "memory", "socket_group", "device"});
        }
    }
    return config;
}

}  // namespace

void require_within(const Range& range, double value, std::string_view where) {
    // Written so that NaN fails, too.
    if (!(value >= range.low && value <= range.high)) {
        throw ConfigError(fmt::format("{}{} = {:g}{}{}; allowed: {}", where, range.key, value,
                                      range.unit.empty() ? "" : " ", range.unit, allowed(range)));
    }
}

void require_name(std::string_view name, std::string_view where) {
    if (!protocol::is_name(name)) {
        throw ConfigError(
            fmt::format("{} = \"{}\": a name has 1 to {} of the characters a-z A-Z 0-9 _ . - and does "
                        "not begin with a dot",
                        where, shown(name), protocol::name_bytes - 1));
    }
}

std::string servo_name(std::string_view said, std::string_view where) {
    constexpr std::string_view prefix = "knurl:";
    const std::string_view name = said.starts_with(prefix) ? said.substr(prefix.size()) : said;
    require_name(name, where);
    return std::string(name);
}

DeviceConfig parse_device_argument(std::string_view argument) {
    DeviceConfig device;
    const std::size_t equals = argument.find('=');
    // "=" behind a colon belongs to an option: sim:premium15,grip=0.5.
    if (equals < argument.find(':')) {
        device.name = argument.substr(0, equals);
        require_name(device.name, "--device: name");
        argument.remove_prefix(equals + 1);
    }
    if (argument.empty()) {
        throw ConfigError(
            "--device: no address; write --device sim:premium15 or --device right=sim:premium15");
    }
    device.address = argument;
    return device;
}

DaemonConfig parse_config(std::string_view text, const std::string& path) {
    try {
        return read_daemon(words::parse_toml(text, path), path);
    } catch (const words::TomlError& error) {
        throw ConfigError(error.what());
    }
}

DaemonConfig load_config(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    if (!file || !(text << file.rdbuf())) {
        throw ConfigError(fmt::format("{}: cannot be read (or is empty); --config takes a TOML file", path));
    }
    return parse_config(text.str(), path);
}

void check(const DaemonConfig& config) {
    require_name(config.name, "name");
    if (config.rate != 0) require_within(ranges::rate, config.rate, "");
    require_within(ranges::spin, config.spin, "");
    require_within(ranges::guardian_stall, config.guardian_stall, "");
    if (config.memory != 0) require_within(ranges::memory, config.memory, "");
    require_within(ranges::priority, config.priority, "");
    if (config.cpu != -1) require_within(ranges::cpu, config.cpu, "");
    if (config.priority != 0 && config.priority < ranges::lowest_priority) {
        throw ConfigError(
            fmt::format("priority = {}; allowed: {} to {:g} (waker and broker run 20 and 30 below the "
                        "servo), or 0 for no real time at all",
                        config.priority, ranges::lowest_priority, ranges::priority.high));
    }
    double fastest = config.rate != 0 ? config.rate : default_rate;
    for (const DeviceConfig& device : config.devices) fastest = std::max(fastest, device.rate);
    const double longest = ranges::spin_share / fastest;
    if (config.spin > longest) {
        throw ConfigError(
            fmt::format("spin = {:g} s; allowed at {:g} Hz: up to {:g} s, half of the period (a real-time "
                        "thread that never sleeps is stopped by the kernel)",
                        config.spin, fastest, longest));
    }
    if (config.devices.empty()) {
        throw ConfigError("no device; write --device sim:premium15, or [[device]] in the --config file");
    }
    if (config.devices.size() > protocol::max_devices) {
        throw ConfigError(
            fmt::format("{} devices; one servo takes up to {}: start a second one with another --name",
                        config.devices.size(), protocol::max_devices));
    }
    for (auto a = config.devices.begin(); a != config.devices.end(); ++a) {
        for (auto b = a + 1; b != config.devices.end(); ++b) {
            if (!a->name.empty() && a->name == b->name) {
                throw ConfigError(
                    fmt::format("two devices are called \"{}\"; name one of them otherwise: --device "
                                "left={}",
                                a->name, b->address));
            }
        }
    }
}

void check_limits(const SupervisorLimits& limits, const drivers::LinkConfig& link, std::string_view where) {
    const auto require = [&](std::string_view key, double value, double most, std::string_view unit) {
        if (value > most) {
            throw ConfigError(
                fmt::format("{}: limits.{} = {:g} {} is more than its {:g} {}; limits can only be "
                            "tightened",
                            where, key, value, unit, most, unit));
        }
    };
    require("peak_force", limits.peak_force, link.peak_force, "N");
    require("peak_torque", limits.peak_torque, link.peak_torque, "N m");
    const double peak = limits.peak_force > 0 ? limits.peak_force : link.peak_force;
    require("continuous_force", limits.continuous_force, peak, "N");
    if (limits.speed_damping_from > limits.speed_fault && limits.speed_fault < widest.speed_fault) {
        throw ConfigError(
            fmt::format("{}: limits.speed_fault = {:g} m/s lies below speed_damping_from = {:g} m/s; "
                        "lower that too, so that damping comes before the fault",
                        where, limits.speed_fault, limits.speed_damping_from));
    }
}

std::string config_help() {
    std::string help = "Keys of the --config file (TOML, SI units):\n";
    const auto line = [&](std::string_view key, std::string_view rest) {
        help += fmt::format("  {:<36} {}\n", key, rest);
    };
    line("name", "of the servo, \"default\"");
    for (const Range& range : {ranges::rate, ranges::cpu, ranges::priority, ranges::spin,
                               ranges::guardian_stall, ranges::memory}) {
        line(range.key, allowed(range));
    }
    line("idle", "\"sleep\" or \"poll\"");
    line("socket_group", "group that may connect besides the owner");
    line("[[device]] name", "what claim() calls it; else the profile's name");
    line("[[device]] address", "\"sim:premium15\"");
    line("[[device]] hand", "motion of a simulated hand, CSV t,x,y,z[,qw,qx,qy,qz]");
    line("[[device]] seed", "of a simulated device's noise");
    line("[[device]] rate", "of this device's loop, if not the servo's");
    for (const LimitKey& key : limit_keys) {
        const bool of_device = key.member == &SupervisorLimits::peak_force ||
                               key.member == &SupervisorLimits::continuous_force ||
                               key.member == &SupervisorLimits::peak_torque;
        line(fmt::format("[device.limits] {}", key.range.key),
             of_device ? fmt::format("up to the device's own, {}", key.range.unit) : allowed(key.range));
    }
    return help;
}

}  // namespace knurl::servo
