#pragma once
// The command line of `knurl latency`.

#include <cstdint>
#include <functional>
#include <string>

#include <knurl/commandline/command.hpp>

namespace knurl::cli {

struct LatencyArguments {
    std::string connect;     // empty: a private servo
    std::string echo;        // of the servo's host, "host:port"; empty: one of its own, if that is this host
    std::string serve_echo;  // run only the echo
    std::string device;      // empty: the only one
    std::uint64_t updates = 10'000;
    double seconds = 0;  // duration; 0: until the number of updates is reached
    double rate = 1000;  // Hz, of the private servo
    int servo_cpu = -1;  // -1: the last one that we may use
    int priority = 0;    // SCHED_FIFO of the client's thread; 0: ordinary
    std::uint64_t seed = 1;
    double wait = 2;  // s
    std::string load = "none";
    double percentile = 0;  // an additional percentile; 0: none
    std::string compare;    // an earlier run to compare with; empty: none
    std::string measured;   // a saved run to compare, without a measurement
    bool json = false;
    std::string json_file = "-";  // standard output
};

/// `arguments` is filled in when `verb` is parsed and the returned function is called; it must live until
/// then.
std::function<void()> add_latency_options(commandline::Command& verb, LatencyArguments& arguments);

/// Throws UsageError for contradictory arguments.
void check(const LatencyArguments& arguments);

}  // namespace knurl::cli
