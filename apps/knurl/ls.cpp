// knurl ls: servos, devices, clients, representations, who holds what.

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/json/json.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/view/text.hpp>

#include "domain.hpp"
#include "top_terminal.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using json = knurl::Json;

void print_client(const ClientView& client) {
    const std::string who = client.name.empty() ? "" : " " + client.name;
    if (client.observer) {
        fmt::print("    pid {}{} observes\n", client.pid, who);
        return;
    }
    fmt::print("    pid {}{} holds it{}: {}", client.pid, who, client.shared ? " (shared)" : "",
               representations_text(client));
    if (client.update_rate > 0) {
        fmt::print(", {:.4g} updates/s, {:.3g} ms old when used", client.update_rate, client.age * 1e3);
    }
    fmt::print(", gain {:.2f}", client.gain);
    if (client.refused > 0) fmt::print(", {} updates refused", client.refused);
    if (!client.armed && client.has_representations())
        fmt::print(", not armed: nothing of it is felt (its program has to call arm())");
    if (client.silent)
        fmt::print(", silent: its force fades ({})", client.commits > 0
                                                         ? "its program does not call commit() any more"
                                                         : "its program has never called commit()");
    fmt::print("\n");
}

void print_device(const DeviceView& device) {
    const auto& info = device.info;
    fmt::print("  {} ({}, {:g} Hz): {}", info.name, info.address, info.rate, state_name(state_of(device)));
    if (faults_of(device) != 0) {
        const std::string servo = info.servo;
        fmt::print(" ({}; clear it with: knurl reset {}{})", fault_names(faults_of(device)), info.name,
                   servo == "default" ? "" : " --servo " + servo);
    }
    fmt::print(", k_max {:.4g} N/m, force {:.2f} of {:.3g} N, {} of {} cycles late\n", info.max_stiffness,
               force_of(device), info.peak_force, device.counters.at("late_cycles"),
               device.counters.at("cycles"));
    if (device.clients.empty()) fmt::print("    nobody holds it\n");
    for (const auto& client : device.clients) print_client(client);
}

bool any_unseen(const std::vector<ServoView>& servos) {
    return std::any_of(servos.begin(), servos.end(), [](const ServoView& servo) { return servo.unseen; });
}

int print_text(const std::vector<ServoView>& servos) {
    std::size_t alive = 0;
    for (const auto& servo : servos) {
        if (servo.dead) {
            fmt::print(
                "knurl:{}: dead, its socket was left behind ({}); the next servo of that name takes it "
                "over\n",
                servo.name, servo.socket);
            continue;
        }
        if (servo.unseen) {  // a folder has no name
            fmt::print(stderr, "knurl ls: {}{}\n", servo.name == "?" ? "" : "knurl:" + servo.name + ": ",
                       servo.problem);
            continue;
        }
        if (!servo.problem.empty()) {
            fmt::print("knurl:{}: {}\n", servo.name, servo.problem);
            continue;
        }
        ++alive;
        fmt::print("knurl:{}: pid {}\n", servo.name, servo.pid);
        for (const auto& device : servo.devices) print_device(device);
    }
    if (any_unseen(servos)) return 1;
    if (alive == 0) {
        fmt::print("no servo is running (looked in {}); start one with: knurld --device sim:premium15\n",
                   fmt::join(protocol::servo_directories(), " and "));
    }
    return 0;
}

json json_of(const ClientView& client) {
    json representations = json::object();
    for (std::size_t kind = 0; kind < client.present.size(); ++kind) {
        representations[std::string(kinds()[kind].name)] = client.present[kind];
    }
    return {{"pid", client.pid},
            {"name", client.name},
            {"role", client.observer ? "observer" : "claim"},
            {"shared", client.shared},
            {"armed", client.armed},
            {"silent", client.silent},
            {"update_rate", client.update_rate > 0 ? json(client.update_rate) : json()},
            {"age_at_use_s", client.age > 0 ? json(client.age) : json()},
            {"gain", client.gain},
            {"updates", client.commits},
            {"updates_refused", client.refused},
            {"updates_merged", client.merged},
            {"reports_missed", client.missed},
            {"representations", representations}};
}

json json_of(const DeviceView& device) {
    const auto& info = device.info;
    json clients = json::array();
    json holders = json::array();
    for (const auto& client : device.clients) {
        clients.push_back(json_of(client));
        if (!client.observer) holders.push_back(client.pid);
    }
    return {{"name", info.name},
            {"address", info.address},
            {"profile", info.profile},
            {"serial", *info.serial == '\0' ? json() : json(info.serial)},
            {"rate", info.rate},
            {"state", state_name(state_of(device))},
            {"faults", faults_of(device)},
            {"k_max", info.max_stiffness},
            {"peak_force", info.peak_force},
            {"force", force_of(device)},
            {"peak_torque", info.peak_torque},
            {"renders_torque", info.renders_torque != 0},
            {"senses_orientation", info.senses_orientation != 0},
            {"held_by", holders},
            {"counters", device.counters},
            {"clients", clients}};
}

int print_domain(std::uint64_t domain, bool as_json) {
    const std::vector<Json> servos = servos_of_domain(domain);
    commandline::print(as_json ? json_of_domain(domain, servos, 2)
                               : shown(text_of_domain(domain, servos), false));
    return 0;
}

int print_json(const std::vector<ServoView>& servos) {
    json list = json::array();
    for (const auto& servo : servos) {
        json devices = json::array();
        for (const auto& device : servo.devices) devices.push_back(json_of(device));
        list.push_back({{"name", servo.name},
                        {"address", "knurl:" + servo.name},
                        {"socket", servo.socket},
                        {"pid", servo.pid > 0 ? json(servo.pid) : json()},
                        {"alive", servo.problem.empty()},
                        {"problem", servo.problem.empty() ? json() : json(servo.problem)},
                        {"devices", devices}});
    }
    // Names come from other processes and need not be UTF-8.
    fmt::print("{}\n", json{{"servos", list}}.dump(2));
    return any_unseen(servos) ? 1 : 0;
}

}  // namespace

void add_ls(commandline::Command& program) {
    auto& verb = program.verb("ls", "Servos, devices, clients, representations, who holds what");
    auto as_json = std::make_shared<bool>(false);
    verb.flag("--json", *as_json, "the same for programs (SI units)");
    auto domain = std::make_shared<std::optional<std::uint64_t>>();
    verb.option("--domain", *domain, "the servos of all hosts that knurl-dds announces in this DDS domain")
        .within(0, 232);
    verb.footer(
        "Without any servo it says so and succeeds: an empty list is an answer.\n"
        "Where it may not look it says so, and ends with 1.");
    verb.action([as_json, domain] {
        if (*domain) return print_domain(**domain, *as_json);
        return *as_json ? print_json(look_at_all()) : print_text(look_at_all());
    });
}

}  // namespace knurl::cli
