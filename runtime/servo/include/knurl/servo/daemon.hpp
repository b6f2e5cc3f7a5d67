#pragma once

/// @file
/// knurld: devices, their loops, the broker and the guardian put together.

#include <knurl/servo/config.hpp>

namespace knurl::servo {

/// Runs a servo until a signal ends it. Returns 0: a signal ended it and every device was ramped down; 1: it
/// had to end otherwise. Throws std::runtime_error (one line: what, where, what to do) if it cannot start;
/// nothing is left behind then.
int run_daemon(const DaemonConfig& config);

/// What a servo would run with this configuration, for people: a line for itself and one for each device.
/// Reads arm and motion files, touches no hardware. Throws ConfigError for what could not run on any machine.
std::string plan_of(const DaemonConfig& config);

/// knurld's command line over its configuration file.
struct CommandLine {
    /// What to run.
    DaemonConfig config;
    /// True: --help or --version was answered, and nothing is to be run.
    bool answered = false;
    /// True: --check-config; what would be run is to be printed.
    bool check_only = false;
};
/// Reads the command line. Throws ConfigError.
CommandLine parse_command_line(int argc, const char* const* argv);

/// main() of knurld. A test build adds its drivers to drivers::drivers() before it calls this.
int knurld_main(int argc, const char* const* argv);

}  // namespace knurl::servo
