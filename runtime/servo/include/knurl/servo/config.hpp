#pragma once

/// @file
/// Configuration of knurld, by a TOML file, a command line, or both (the command line wins). SI units
/// throughout.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/drivers/link_config.hpp>
#include <knurl/servo/supervisor.hpp>

namespace knurl::servo {

/// A device of a servo.
struct DeviceConfig {
    /// Name by which it is claimed; empty: the profile's.
    std::string name;
    /// Address: "sim:premium15".
    std::string address;
    /// File with the motion of a simulated hand; empty: it rests at the centre.
    std::string hand_file;
    /// Seed of a simulated hand's tremor.
    std::uint64_t seed = 1;
    /// Rate of its own loop (Hz); 0: the servo's.
    double rate = 0;
    /// Limits of the supervisor; they may be tightened, never widened.
    SupervisorLimits limits;
};

/// What idle CPUs do.
enum class Idle {
    /// The CPU may halt between cycles: saves power, wakes 20 to 50 us late.
    sleep,
    /// /dev/cpu_dma_latency is held at 0: idle CPUs poll. Wake-ups come ten times sooner, and cost power.
    poll,
};

/// Rate of a device where nothing else is stated (Hz).
inline constexpr double default_rate = 1000;

/// What knurld runs.
struct DaemonConfig {
    /// Name of the servo: clients connect to "knurl:NAME".
    std::string name = "default";
    /// Rate of the devices that state no other (Hz); 0: default_rate, or the rate of a device's description
    /// if that is less.
    double rate = 0;
    /// CPU of the servo threads and the waker; -1: the last one that the process may use.
    int cpu = -1;
    /// SCHED_FIFO priority of the fastest servo thread; slower ones are below it, the waker 20 and the broker
    /// 30 below; 0: not real time.
    int priority = 80;
    /// What idle CPUs do.
    Idle idle = Idle::sleep;
    /// Last part of each wait that is spun instead of slept (s).
    double spin = 0;
    /// Time without a cycle after which the guardian puts the device to zero (s).
    double guardian_stall = 20e-3;
    /// Memory that the claims and shapes of all clients together may take (MiB); 0: a quarter of the machine's.
    double memory = 0;
    /// Group that may connect besides the owner; empty: the process's own.
    std::string socket_group;
    /// Its devices.
    std::vector<DeviceConfig> devices;
};

/// The range of a number. One table for the file and the command line.
struct Range {
    /// Key of the file.
    std::string_view key;
    /// Least value.
    double low = 0;
    /// Greatest value.
    double high = 0;
    /// Unit.
    std::string_view unit;
};
namespace ranges {
/// Of DaemonConfig::rate and DeviceConfig::rate.
inline constexpr Range rate{"rate", 500, 20'000, "Hz"};
/// Of DaemonConfig::cpu.
inline constexpr Range cpu{"cpu", 0, 1023, ""};
/// Of DaemonConfig::priority; 1 to 30 would leave no room for waker and broker.
inline constexpr Range priority{"priority", 0, 94, ""};
/// Least real-time priority of a servo thread.
inline constexpr int lowest_priority = 31;
/// Of DaemonConfig::spin. A FIFO thread that never sleeps is stopped 50 ms each second (real-time
/// throttling): spin a small part only.
inline constexpr Range spin{"spin", 0, 200e-6, "s"};
/// Largest share of the period that may be spun (1).
inline constexpr double spin_share = 0.5;
/// Of DaemonConfig::guardian_stall.
inline constexpr Range guardian_stall{"guardian_stall", 20e-3, 1, "s"};
/// Of DaemonConfig::memory.
inline constexpr Range memory{"memory", 16, 1 << 20, "MiB"};
/// Of DeviceConfig::seed.
inline constexpr Range seed{"seed", 0, 9.2e18, ""};
}  // namespace ranges

/// One line: where ("file:line:column" or the option), what was wrong, what is allowed.
class ConfigError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Reads a configuration file. Throws ConfigError.
DaemonConfig load_config(const std::string& path);
/// The same from text; `path` is what errors call it.
DaemonConfig parse_config(std::string_view text, const std::string& path);
/// Reads "sim:premium15" or "right=sim:premium15". Throws ConfigError.
DeviceConfig parse_device_argument(std::string_view argument);
/// Throws ConfigError unless `value` is within `range`; `where` begins the line.
void require_within(const Range& range, double value, std::string_view where);
/// Throws ConfigError unless `name` can be a servo's or device's: it becomes part of file names.
void require_name(std::string_view name, std::string_view where);
/// Reads a servo's name, also as clients say it ("knurl:lab"). Throws as require_name() does.
std::string servo_name(std::string_view said, std::string_view where);
/// Checks what no single key shows: a spin longer than the period allows, no device, two of one name. Throws
/// ConfigError.
void check(const DaemonConfig& config);
/// Checks what needs the device's own figures: limits above what it can do. `where` names the device. Throws
/// ConfigError.
void check_limits(const SupervisorLimits& limits, const drivers::LinkConfig& link, std::string_view where);
/// Every key of the file with unit and range, one a line, for --help.
std::string config_help();

}  // namespace knurl::servo
