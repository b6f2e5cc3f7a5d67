#pragma once
// What knurld is told, by a TOML file, a command line, or both (the command line wins). SI units throughout.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/drivers/link_config.hpp>
#include <knurl/servo/supervisor.hpp>

namespace knurl::servo {

struct DeviceConfig {
    std::string name;       // what claim() calls it; empty: the profile's
    std::string address;    // "sim:premium15"
    std::string hand_file;  // motion of a simulated hand; empty: it rests at the centre
    std::uint64_t seed = 1;
    double rate = 0;          // Hz, of its own loop; 0: the servo's
    SupervisorLimits limits;  // tightened, never widened
};

enum class Idle {
    sleep,  // the CPU may halt between cycles: saves power, wakes 20-50 us late
    poll,   // /dev/cpu_dma_latency is held at 0: idle CPUs poll, wake-ups come ten times sooner, for power
};

inline constexpr double default_rate = 1000;  // Hz

struct DaemonConfig {
    std::string name = "default";  // of the servo: clients connect to "knurl:NAME"
    // Hz, of the devices that say nothing else; 0: default_rate, or what a device's description says if that
    // is less
    double rate = 0;
    int cpu = -1;  // the servo threads' and the waker's; -1: the last one that we may use
    // SCHED_FIFO, of the fastest servo thread, slower ones below it; waker 20 and broker 30 below; 0: not
    // real time
    int priority = 80;
    Idle idle = Idle::sleep;
    double spin = 0;                // s: the last part of each sleep is spun instead
    double guardian_stall = 20e-3;  // s without a cycle after which the guardian zeroes the device
    std::string socket_group;       // who may connect besides the owner; empty: the process's own group
    std::vector<DeviceConfig> devices;
};

/// What a number may be. One table for the file and the command line.
struct Range {
    std::string_view key;
    double low = 0, high = 0;
    std::string_view unit;
};
namespace ranges {
inline constexpr Range rate{"rate", 500, 20'000, "Hz"};
inline constexpr Range cpu{"cpu", 0, 1023, ""};
inline constexpr Range priority{"priority", 0, 94, ""};  // 1-30 would leave no room for waker and broker
inline constexpr int lowest_priority = 31;
// A FIFO thread that never sleeps is stopped 50 ms each second (real-time throttling): spin a small part
// only.
inline constexpr Range spin{"spin", 0, 200e-6, "s"};
inline constexpr double spin_share = 0.5;  // of the period, at most
inline constexpr Range guardian_stall{"guardian_stall", 20e-3, 1, "s"};
inline constexpr Range seed{"seed", 0, 9.2e18, ""};
}  // namespace ranges

/// One line: where ("file:line:column" or the option), what was wrong, what is allowed.
class ConfigError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Throws ConfigError.
DaemonConfig load_config(const std::string& path);
/// The same from text; `path` is what errors call it.
DaemonConfig parse_config(std::string_view text, const std::string& path);
/// "sim:premium15" or "right=sim:premium15". Throws ConfigError.
DeviceConfig parse_device_argument(std::string_view argument);
/// Throws ConfigError unless `value` is within `range`; `where` begins the line.
void require_within(const Range& range, double value, std::string_view where);
/// Throws ConfigError unless `name` can be a servo's or device's: it becomes part of file names.
void require_name(std::string_view name, std::string_view where);
/// A servo's name, also as clients say it ("knurl:lab"). Throws as require_name() does.
std::string servo_name(std::string_view said, std::string_view where);
/// What no single key shows: a spin longer than the period allows, no device, two of one name.
void check(const DaemonConfig& config);
/// What needs the device's own figures: limits above what it can do. `where` names the device.
void check_limits(const SupervisorLimits& limits, const drivers::LinkConfig& link, std::string_view where);
/// Every key of the file with unit and range, one a line, for --help.
std::string config_help();

}  // namespace knurl::servo
