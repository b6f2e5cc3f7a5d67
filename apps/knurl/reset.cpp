// knurl reset: leaves a device's fault, whoever holds it. It enables nothing.

#include <chrono>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/client/client.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/view/servo_view.hpp>
#include <knurl/view/text.hpp>

#include "verbs.hpp"

namespace knurl::cli {

namespace {

using namespace std::chrono_literals;

struct ResetArguments {
    std::string servo = "default", device;
};

/// The device as the servo's memory shows it now.
DeviceView view_of(const ServoWatch& watch, const std::string& name) {
    for (DeviceView& device : watch.look().devices)
        if (device.info.name == name) return std::move(device);
    throw std::runtime_error(fmt::format("there is no device '{}' any more", name));
}

std::string chosen(const ServoView& servo, const std::string& wanted) {
    std::vector<std::string> names;
    for (const DeviceView& device : servo.devices) names.emplace_back(device.info.name);
    return names[chosen_device(servo.name, names, wanted)];
}

std::string holders_of(const DeviceView& device) {
    std::string text;
    for (const ClientView& client : device.clients) {
        if (client.observer) continue;
        text += fmt::format("; pid {}{}{} holds it and has to arm it anew", client.pid,
                            client.name.empty() ? "" : " ", client.name);
    }
    return text;
}

int reset(const ResetArguments& arguments) {
    ConnectOptions options;
    options.name = "knurl reset";
    options.wait = 0ms;
    options.reattach = false;
    const protocol::ServoAddress servo = servo_said(arguments.servo);
    Client client = Client::connect(servo.socket, options);
    const ServoWatch watch(servo.socket);
    const std::string name = chosen(watch.look(), arguments.device);
    const DeviceView before = view_of(watch, name);
    const std::string who = fmt::format("knurl:{}: {}", servo.name, name);
    if (state_of(before) != DeviceState::fault && state_of(before) != DeviceState::disconnected) {
        fmt::print("{} is in no fault ({})\n", who, state_name(state_of(before)));
        return 0;
    }
    Observer observer = client.observe(name);
    client.reset_fault(name);
    // A fault that returns at once is reported now, not to the next user. Reports up to the cycle of the
    // reset still show the old fault, and under load several of them wait here.
    const auto newest = observer.latest();
    const std::uint64_t reset_by = newest ? newest->cycle + 1 : 0;
    constexpr std::uint64_t cycles = 20;
    for (std::uint64_t cycle = 0; cycle < reset_by + cycles;) {
        const auto report = observer.next_report(500ms);
        if (!report)
            throw std::runtime_error(
                who + " has left its fault, but no report came since: the servo has ended or does not run");
        cycle = report->cycle;
        if (cycle > reset_by && report->state == DeviceState::fault)
            throw std::runtime_error(fmt::format("{} left its fault ({}) and is in fault again: {}", who,
                                                 fault_names(faults_of(before)),
                                                 fault_names(report->faults)));
    }
    const DeviceView after = view_of(watch, name);
    fmt::print("{} has left its fault ({}) and is {}{}\n", who, fault_names(faults_of(before)),
               state_name(state_of(after)), holders_of(after));
    return 0;
}

}  // namespace

void add_reset(commandline::Command& program) {
    auto& verb = program.verb("reset", "Clears the fault of a device, whoever holds it");
    auto arguments = std::make_shared<ResetArguments>();
    verb.option("device", arguments->device, "of that servo; only if it has several").type_name("DEVICE");
    verb.servo(arguments->servo, "the servo that has the device").shows_default();
    verb.footer(
        "A device in fault is without force until it is reset: the machine was suspended, the hand was too "
        "fast.\n"
        "Afterwards it is idle; force comes when a program that holds it arms it. While the cause goes on, "
        "or\nthe hand moves, the reset is refused with the reason. Every user who may connect to the servo "
        "may reset;\nover a network nobody may: run it on the servo's own host.");
    verb.action([arguments] { return reset(*arguments); });
}

}  // namespace knurl::cli
