#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/protocol/bounds.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/servo/daemon.hpp>

#include "asset_workshop.hpp"

namespace knurl::servo {

namespace {

constexpr const char* examples = R"(Examples:
  knurld --device sim:premium15
  knurld --name lab --device left=sim:premium15 --device right=sim:cartesian3 --rate 2000
  knurld --device sim:premium15 --hand stroke.csv
  knurld --config /etc/knurl/lab.toml --idle poll --spin 60e-6
)";

std::string bounds_help() {
    using namespace protocol;
    return fmt::format(
        "Bounds:\n"
        "  {} devices of one servo, {} clients of one device, {} connections, {} of them not yet introduced "
        "({:g} s)\n"
        "  {} claims and observers of one connection\n"
        "  {} representations and {} KiB of parameters of one claim (unless it says less: {} and {} KiB)\n"
        "  {} bytes of parameters of one representation, {} probes, {} joints\n"
        "  {} cells of commands and {} of replies waiting, {} taken in one cycle; {} reports kept\n",
        max_devices, max_clients, broker_bounds::connections, broker_bounds::half_open,
        broker_bounds::hello_seconds, protocol::max_claims_of_connection, max_representations,
        max_batch_bytes / 1024, default_representations, default_batch_bytes / 1024,
        protocol::max_parameter_bytes, max_probes, max_joints, max_command_cells, reply_cells,
        command_cells_per_cycle, report_slots - 1);
}

std::string drivers_help() {
    std::string help = "Devices:\n";
    for (const drivers::Driver& driver : drivers::drivers()) {
        help += fmt::format("  {}:{}\n", driver.scheme, driver.help);
    }
    return help;
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
    CLI::App app("knurld: the servo of Knurl. Owns force-feedback devices and runs their loops.", "knurld");
    DaemonConfig told;
    std::string config_file, hand, idle;
    std::vector<std::string> devices;
    app.option_defaults()->always_capture_default(false);
    const auto* name =
        app.add_option("--name", told.name, "of the servo; clients connect to knurl:NAME (default)");
    app.add_option("--device", devices,
                   "[NAME=]ADDRESS of a device, repeatable; NAME defaults to the profile's")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    const auto* rate = app.add_option(
        "--rate", told.rate, "of the loops, Hz (1000, or less where a device's description says so)");
    const auto* cpu = app.add_option("--cpu", told.cpu, "of the servo threads (the last one allowed)");
    const auto* priority = app.add_option("--priority", told.priority,
                                          "SCHED_FIFO priority of the servo threads, 0: not real time (80)");
    app.add_option("--idle", idle,
                   "sleep, or poll: idle CPUs stay awake, wake-ups come sooner, for power (sleep)");
    const auto* spin = app.add_option("--spin", told.spin, "s: spin the last part of each sleep (0)");
    app.add_option("--hand", hand,
                   "motion of the simulated hands, CSV t,x,y,z[,qw,qx,qy,qz]; begins with each claim");
    app.add_option("--config", config_file, "TOML file; the command line wins over it");
    app.set_version_flag("--version", std::string("knurld ") + KNURL_VERSION);
    app.footer([] { return drivers_help() + "\n" + examples + "\n" + config_help() + "\n" + bounds_help(); });

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& wanted) {  // --help, --version
        app.exit(wanted);
        return {.config = {}, .answered = true};
    } catch (const CLI::ParseError& error) {
        throw ConfigError(fmt::format("{}; see knurld --help", error.what()));
    }

    DaemonConfig config = config_file.empty() ? DaemonConfig{} : load_config(config_file);
    if (name->count() > 0) {
        require_name(told.name, "--name");
        config.name = told.name;
    }
    const auto number = [&](const CLI::Option* option, const Range& range, auto& to, auto value) {
        if (option->count() == 0) return;
        require_within(range, static_cast<double>(value), "--");
        to = value;
    };
    number(rate, ranges::rate, config.rate, told.rate);
    number(cpu, ranges::cpu, config.cpu, told.cpu);
    number(priority, ranges::priority, config.priority, told.priority);
    number(spin, ranges::spin, config.spin, told.spin);
    if (!idle.empty()) {
        if (idle != "sleep" && idle != "poll") {
            throw ConfigError(fmt::format("--idle = \"{}\"; allowed: sleep, poll", idle));
        }
        config.idle = idle == "poll" ? Idle::poll : Idle::sleep;
    }
    if (!devices.empty()) {
        config.devices.clear();
        for (const std::string& device : devices) config.devices.push_back(parse_device_argument(device));
    }
    if (!hand.empty()) {
        for (DeviceConfig& device : config.devices) device.hand_file = hand;
    }
    check(config);
    return {.config = std::move(config), .answered = false};
}

int knurld_main(int argc, const char* const* argv) {
    constexpr int bad_configuration = 2;
    if (argc > 1 && std::string_view(argv[1]) == build_asset_option) return build_asset_main(argc, argv);
    try {
        const CommandLine line = parse_command_line(argc, argv);
        return line.answered ? 0 : run_daemon(line.config);
    } catch (const ConfigError& error) {
        std::fprintf(stderr, "knurld: %s\n", error.what());
        return bad_configuration;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurld: %s\n", error.what());
        return 1;
    }
}

}  // namespace knurl::servo
