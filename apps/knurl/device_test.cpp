// knurl device test ADDRESS: what a device does, compared with its description.

#include <algorithm>
#include <atomic>
#include <csignal>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/view/servo_view.hpp>

#include "device_trial.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using json = knurl::Json;

/// "p50 12, p99 -, max 40 us" of samples in s.
std::string spread(const std::vector<double>& samples, int digits) {
    const measure::Result all = measure::summarise("", "s", samples);
    const auto us = [&](const std::optional<double>& s) {
        return s ? fmt::format("{:.{}f}", *s * 1e6, digits) : "-";
    };
    return fmt::format("p50 {}, p99 {}, max {} us", us(all.p50), us(all.p99), us(all.max));
}

json spread_for_programs(const std::vector<double>& samples) {
    if (samples.empty()) return nullptr;
    const measure::Result all = measure::summarise("", "s", samples);
    const auto or_null = [](const std::optional<double>& s) { return s ? json(*s) : json(); };
    return {{"p50_s", or_null(all.p50)}, {"p99_s", or_null(all.p99)}, {"max_s", all.max}};
}

double degrees(double cosine) {
    return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
}

/// One device has several stiffnesses; each is printed with its meaning. `with_hand`: the device as knurld
/// would see it, held by a hand; else null.
void print_walls(const Trial& trial, const drivers::LinkConfig* with_hand) {
    const WallTrial& wall = trial.wall;
    fmt::print("  stiffest wall    {:.0f} N/m{} measured, {}\n", wall.stiffness,
               wall.bounded ? " or more" : "",
               wall.held ? "in the hand that its address asks for" : "nobody's hand on it");
    const double alone = promised_alone(trial.link, trial.rate);
    if (trial.link.measured_max_stiffness > 0)
        fmt::print("  stated wall      {:.0f} N/m (max_stiffness), to which knurld clamps\n",
                   trial.link.measured_max_stiffness);
    if (alone > 0)
        fmt::print("  promised alone   {:.0f} N/m by its own damping, b / (T/2 + tau){}\n", alone,
                   wall.held ? "" : fmt::format("; {:g} of that or more passes", bounds::wall));
    const drivers::LinkConfig& held = with_hand != nullptr ? *with_hand : trial.link;
    if (held.grip_damping > 0)
        fmt::print("  promised held    {:.0f} N/m, the hand's {:g} N s/m added{}: what knurld clamps to\n",
                   servo::max_stiffness(held, trial.rate), held.grip_damping,
                   wall.held ? fmt::format("; {:g} of that or more passes", bounds::wall) : "");
    else if (trial.link.measured_max_stiffness == 0)
        fmt::print("  promised held    not known: a hand adds its damping; what knurld clamps to is {}\n",
                   alone > 0 ? "that of the device alone" : fmt::format("{:.0f} N/m", wall.predicted));
}

void print_text(const Trial& trial, const drivers::LinkConfig* with_hand) {
    const RestTrial& rest = trial.rest;
    fmt::print("{}{}{}\n", trial.link.name, trial.link.serial.empty() ? "" : " ", trial.link.serial);
    if (!trial.link.description.empty()) fmt::print("  {}\n", trial.link.description);
    fmt::print("  homing           {}\n", trial.homing.seconds == 0
                                              ? "not needed, or done before"
                                              : fmt::format("done after {:.1f} s", trial.homing.seconds));
    fmt::print("  rate             {:.1f} new samples a second of {:g} asked for; {} stale, {} bad\n",
               rest.sample_rate, trial.rate, rest.stale, rest.bad);
    if (!rest.lateness.empty()) {  // on a virtual clock these times say nothing about the device
        fmt::print("  lateness         {}{}\n", spread(rest.lateness, 0),
                   trial.real_time ? "" : " (no right to real time: as an ordinary process)");
        fmt::print("  read and write   {}\n", spread(rest.transfer, 1));
        if (rest.round_trip.empty())
            fmt::print("  round trip       none: no sample followed an order within 20 ms\n");
        else
            fmt::print("  round trip       {} from an order to the next sample\n",
                       spread(rest.round_trip, 0));
    }
    std::string counts;
    for (const double c : rest.counts_apart) counts += fmt::format("{}{:.0f}", counts.empty() ? "" : ", ", c);
    fmt::print("  noise at rest    {:.1f} um rms, {:.1f} um at most; joints wander by {} counts\n",
               rest.tip_noise * 1e6, rest.tip_apart * 1e6, counts);
    if (trial.pushes.empty()) {
        fmt::print("  force            it takes none\n");
        return;
    }
    for (const PushTrial& push : trial.pushes) {
        fmt::print("  push along {}     {:.0f} degrees off (up to {:.0f} pass), {:.3f} kg moved",
                   axis_name(push), degrees(push.cosine), degrees(bounds::push_cosine), push.mass);
        if (push.size > 0)
            fmt::print(", {:.2f} x the model's force ({:g} to {:g} pass)", push.size, bounds::least_size,
                       bounds::greatest_size);
        fmt::print(", friction {:.2f} N, begins after {:.2f} ms\n", push.friction, push.delay * 1e3);
    }
    for (const PushTrial& turn : trial.turns) {
        fmt::print(
            "  turn about {}     {:.0f} degrees off (up to {:.0f} pass), {:.2g} kg m2 turned, friction "
            "{:.3f} N m\n",
            axis_name(turn), degrees(turn.cosine), degrees(bounds::turn_cosine), turn.mass, turn.friction);
    }
    print_walls(trial, with_hand);
}

json to_json(const Trial& trial, const std::string& address, const std::vector<std::string>& found) {
    const RestTrial& rest = trial.rest;
    json pushes = json::array();
    for (const PushTrial& push : trial.pushes) {
        pushes.push_back({{"axis", axis_name(push)},
                          {"cosine", push.cosine},
                          {"mass", push.mass},
                          {"friction", push.friction},
                          {"delay_s", push.delay},
                          {"size", push.size > 0 ? json(push.size) : json()}});
    }
    json turns = json::array();
    for (const PushTrial& turn : trial.turns) {
        turns.push_back({{"axis", axis_name(turn)},
                         {"cosine", turn.cosine},
                         {"inertia", turn.mass},
                         {"friction", turn.friction}});
    }
    const measure::Machine machine = measure::this_machine();
    return {
        {"device", trial.link.name},
        {"address", address},
        {"serial", trial.link.serial.empty() ? json() : json(trial.link.serial)},
        {"machine", {{"processor", machine.processor}, {"kernel", machine.kernel}, {"date", machine.date}}},
        {"rate", trial.rate},
        {"real_time", trial.real_time},
        {"homing_s", trial.homing.seconds},
        {"rest",
         {{"sample_rate", rest.sample_rate},
          {"fresh", rest.fresh},
          {"stale", rest.stale},
          {"bad", rest.bad},
          {"tip_rms", rest.tip_noise},
          {"tip_max", rest.tip_apart},
          {"turned_max", rest.turned_apart},
          {"joint_counts", rest.counts_apart},
          {"lateness", spread_for_programs(rest.lateness)},
          {"read_and_write", spread_for_programs(rest.transfer)},
          {"round_trip", spread_for_programs(rest.round_trip)}}},
        {"pushes", pushes},
        {"turns", turns},
        {"wall",
         {{"stiffness", trial.wall.stiffness},
          {"held", trial.wall.held},
          {"predicted", trial.wall.predicted},
          {"predicted_alone", promised_alone(trial.link, trial.rate)},
          {"at_least", trial.wall.bounded}}},
        {"findings", found}};
}

struct TestOptions {
    std::string address;
    TrialOptions trial;
    bool as_json = false;
};

/// A device of a running servo has a name; opening it needs its address.
void require_address(const std::string& address) {
    if (address.find(':') != std::string::npos) return;
    for (const ServoView& servo : look_at_all()) {
        for (const DeviceView& device : servo.devices) {
            if (address == device.info.name) {
                throw UsageError(fmt::format(
                    "\"{}\" is run by the servo \"{}\" (pid {}); end that, then: knurl device test {}",
                    address, servo.name, servo.pid, device.info.address));
            }
        }
    }
    std::string known;
    for (const drivers::Driver& driver : drivers::drivers())
        known += (known.empty() ? "" : ", ") + driver.scheme + ":" + driver.help;
    throw UsageError(fmt::format("\"{}\" is no address; write one of {}", address, known));
}

/// The address with the simulated hand released, unless it has options of the hand. By default the hand holds
/// a simulated device, and its effect is no fault of the device.
std::string without_hand(const std::string& address) {
    constexpr std::string_view of_the_hand[] = {"grip", "hand",   "hand_normal", "hand_damping",
                                                "push", "finger", "tremor",      "live"};
    if (!address.starts_with("sim:")) return address;
    for (std::size_t comma = address.find(','); comma != std::string::npos;) {
        const std::size_t next = address.find(',', comma + 1);
        const std::string option = address.substr(comma + 1, next - comma - 1);
        if (std::ranges::count(of_the_hand, option.substr(0, option.find('='))) != 0) return address;
        comma = next;
    }
    return address + ",grip=0";
}

std::atomic<bool> interrupted = false;  // it may be pushing a real device: first the motors must stop, then
                                        // the program

void heed_interrupts() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        // A signal that was ignored when the program began (nohup) stays ignored.
        if (std::signal(signal, [](int) { interrupted = true; }) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
}

int test(TestOptions options) {
    require_address(options.address);
    if (options.trial.virtual_time && !options.address.starts_with("sim:"))
        throw UsageError("--virtual is for simulated devices: a real one has only this time");
    const std::string address = without_hand(options.address);
    // As knurld would see it, before the hand is released.
    std::optional<drivers::LinkConfig> hand;
    if (address != options.address) hand = drivers::open_device(options.address)->link();
    const std::unique_ptr<drivers::Device> device = drivers::open_device(address);
    if (!options.as_json && address != options.address)
        fmt::print(stderr, "nobody's hand on it: tests {} (grip=0.5 would hold it)\n", address);
    options.trial.stop = &interrupted;
    heed_interrupts();
    const Trial trial = try_device(*device, options.trial, [&](const std::string& line) {
        if (!options.as_json) fmt::print(stderr, "{} ...\n", line);
    });
    const std::vector<std::string> found = findings(trial);
    if (options.as_json) {
        fmt::print("{}\n", to_json(trial, address, found).dump(2));
    } else {
        print_text(trial, hand ? &*hand : nullptr);
        for (const std::string& line : found) fmt::print("  ! {}\n", line);
        if (found.empty()) fmt::print("  as it should be: all of it within the bounds stated\n");
    }
    return found.empty() ? 0 : 1;
}

}  // namespace

void add_device_test(commandline::Command& device) {
    auto& verb = device.verb("test", "Tries a device: noise, rate, force, torque, stiffest wall. It moves!");
    auto options = std::make_shared<TestOptions>();
    verb.option("ADDRESS", options->address, "as for knurld --device: sim:premium15").required();
    verb.option("--rate", options->trial.rate, "Hz (1000)").within(500.0, 20000.0);
    verb.option("--push", options->trial.push, "N, the larger push (1); torques are as large at 50 mm")
        .within(0.1, 5.0);
    verb.option("--homing-time", options->trial.homing_time, "s to wait for homing (60)").within(1.0, 600.0);
    verb.flag("--virtual", options->trial.virtual_time, "a simulated device as fast as it computes");
    verb.flag("--json", options->as_json, "the same for programs (SI units)");
    verb.footer(
        "The device must hang or rest freely, nobody's hand on it; no servo may hold it.\n"
        "A simulated one is let go of (grip=0), unless its address says what the hand does.\n"
        "A percentile with fewer than ten samples above it is left out (null).\n"
        "Exit code 1: something is not as its description says.");
    verb.action([options] { return test(*options); });
}

}  // namespace knurl::cli
