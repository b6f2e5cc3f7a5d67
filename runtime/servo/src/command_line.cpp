#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/protocol/bounds.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/servo/daemon.hpp>

#include "build_queue.hpp"

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
    commandline::Command app("knurld",
                             "knurld: the servo of Knurl. Owns force-feedback devices and runs their loops.");
    DaemonConfig told;
    std::string config_file, checked_file, hand, idle;
    std::vector<std::string> devices;
    const auto& name =
        app.option("--name", told.name, "of the servo; clients connect to knurl:NAME (default)");
    app.option("--device", devices, "[NAME=]ADDRESS of a device, repeatable; NAME defaults to the profile's");
    const auto& rate = app.option("--rate", told.rate,
                                  "of the loops, Hz (1000, or less where a device's description says so)");
    const auto& cpu = app.option("--cpu", told.cpu, "of the servo threads (the last one allowed)");
    const auto& priority = app.option("--priority", told.priority,
                                      "SCHED_FIFO priority of the servo threads, 0: not real time (80)");
    app.option("--idle", idle,
               "sleep, or poll: idle CPUs stay awake, wake-ups come sooner, for power (sleep)");
    const auto& spin = app.option("--spin", told.spin, "s: spin the last part of each sleep (0)");
    app.option("--hand", hand,
               "motion of the simulated hands, CSV t,x,y,z[,qw,qx,qy,qz]; begins with each claim");
    app.option("--config", config_file, "TOML file; the command line wins over it");
    const auto& check_config =
        app.option("--check-config", checked_file,
                   "checks the configuration (FILE, or that of --config and the other options) and the arm "
                   "and motion files that it names, prints what would run, and exits: 0 valid, 2 not")
            .value_may_be_missing()
            .type_name("[FILE]");
    app.footer([] { return drivers_help() + "\n" + examples + "\n" + config_help() + "\n" + bounds_help(); });

    try {
        if (app.parse(argc, argv) == commandline::Command::Answer::nothing)
            return {.config = {}, .answered = true, .check_only = false};
    } catch (const commandline::UsageError& error) {
        throw ConfigError(error.what());
    }

    if (!checked_file.empty()) {
        if (!config_file.empty())
            throw ConfigError("--check-config and --config both name a file; give one of them");
        config_file = checked_file;
    }
    DaemonConfig config = config_file.empty() ? DaemonConfig{} : load_config(config_file);
    if (name.given()) config.name = servo_name(told.name, "--name");
    const auto number = [&](const commandline::Option& option, const Range& range, auto& to, auto value) {
        if (!option.given()) return;
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
    return {.config = std::move(config), .answered = false, .check_only = check_config.given()};
}

int knurld_main(int argc, const char* const* argv) {
    if (argc > 1 && std::string_view(argv[1]) == build_asset_option) return build_asset_main(argc, argv);
    if (argc > 1 && std::string_view(argv[1]) == close_descriptors_option) return close_descriptors_main();
    return commandline::guarded([] { return "knurld"; },
                                [&] {
                                    try {
                                        const CommandLine line = parse_command_line(argc, argv);
                                        if (line.answered) return 0;
                                        if (!line.check_only) return run_daemon(line.config);
                                        commandline::print(plan_of(line.config));
                                        return 0;
                                    } catch (const ConfigError& error) {
                                        throw commandline::UsageError(error.what());
                                    }
                                });
}

}  // namespace knurl::servo
