// knurl top: what a servo does with its time and its clients with it, live. Read-only: the servo does nothing
// for it.

#include <atomic>
#include <cmath>
#include <csignal>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <knurl/protocol/attach.hpp>

#include "latency_floors.hpp"
#include "servo_text.hpp"
#include "top_rates.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using nlohmann::json;

struct Arguments {
    std::string servo = "default";
    double hertz = 2;
    std::uint64_t looks = 0;  // 0: until interrupted
    bool json = false;
};

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// The screen is ours while this lives.
class Screen {
  public:
    explicit Screen(bool on) : on_(on) {
        if (on_) fmt::print("\033[?1049h\033[?25l");  // another page, no cursor
    }
    ~Screen() {
        if (on_) fmt::print("\033[?25h\033[?1049l");
        std::fflush(stdout);
    }
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;
    void show(const std::string& text) const {
        std::string shown = on_ ? "\033[H" : "";
        for (const char c : text) shown += on_ && c == '\n' ? "\033[K\n" : std::string(1, c);
        if (on_) shown += "\033[J";
        fmt::print("{}", shown);
        std::fflush(stdout);
    }

  private:
    bool on_;
};

std::string text_of(const ClientRates& rates) {
    const ClientView& client = rates.client;
    std::string line = fmt::format("      pid {:<7} {:<24}", client.pid, client.name);
    if (client.observer) return line + " observes\n";
    line += fmt::format(" {:7.1f} updates/s, {:7.3f} ms old when used, {} merged, {} refused, gain {:.2f}",
                        rates.updates, client.age * 1e3, rates.merged, rates.refused, client.gain);
    if (client.silent) line += ", SILENT";
    return line + fmt::format("\n                  {}\n", representations_text(client));
}

std::string text_of(const DeviceRates& rates) {
    const DeviceView& device = rates.device;
    std::string text =
        fmt::format("  {} ({}): {}", device.info.name, device.info.address, state_name(state_of(device)));
    if (faults_of(device) != 0) text += fmt::format(" ({})", fault_names(faults_of(device)));
    text +=
        fmt::format(", {:.1f} of {:g} Hz, force {:.2f} of {:.3g} N, k_max {:.4g} N/m\n", rates.rate,
                    device.info.rate, force_of(device), device.info.peak_force, device.info.max_stiffness);
    if (rates.late_median) {
        text += fmt::format(
            "      begins late by {:.1f} us (median), {:.1f} us at most; {} late, {} overruns; {} late since "
            "the start\n",
            *rates.late_median, *rates.late_max, rates.late, rates.overruns,
            device.counters.at("late_cycles"));
    }
    if (rates.parts) {
        text += "      cycle";
        for (std::size_t i = 0; i < cycle_parts.size(); ++i)
            text += fmt::format("  {} {:.2f}", cycle_parts[i], (*rates.parts)[i]);
        text += fmt::format("  = {:.2f} us, {:.2f} % of the period; the rest is sleep\n", rates.step,
                            rates.busy * 100);
    }
    if (rates.clients.empty()) text += "      nobody holds it\n";
    for (const ClientRates& client : rates.clients) text += text_of(client);
    return text;
}

json json_of(const DeviceRates& rates) {
    const auto number = [](const std::optional<double>& value) { return value ? json(*value) : json(); };
    const DeviceView& device = rates.device;
    json parts = nullptr, clients = json::array();
    if (rates.parts) {
        parts = json::object();
        for (std::size_t i = 0; i < cycle_parts.size(); ++i)
            parts[std::string(cycle_parts[i])] = (*rates.parts)[i];
    }
    for (const ClientRates& client : rates.clients) {
        clients.push_back({{"pid", client.client.pid},
                           {"name", client.client.name},
                           {"role", client.client.observer ? "observer" : "claim"},
                           {"updates", client.updates},
                           {"age_at_use", client.client.age},
                           {"merged", client.merged},
                           {"refused", client.refused},
                           {"gain", client.client.gain},
                           {"silent", client.client.silent}});
    }
    return {{"name", device.info.name},
            {"address", device.info.address},
            {"state", state_name(state_of(device))},
            {"faults", faults_of(device)},
            {"nominal_rate", device.info.rate},
            {"rate", rates.rate},
            {"force", force_of(device)},
            {"late", rates.late},
            {"overruns", rates.overruns},
            {"lateness_median_us", number(rates.late_median)},
            {"lateness_max_us", number(rates.late_max)},
            {"parts_us", parts},
            {"step_us", rates.step},
            {"busy", rates.busy},
            {"clients", clients}};
}

/// Looks again and again until somebody interrupts, or the servo has gone.
int watch(const Arguments& arguments) {
    if (!(arguments.hertz >= 0.1 && arguments.hertz <= 20))
        throw UsageError(fmt::format("--rate is {:g} Hz; give 0.1 to 20", arguments.hertz));
    const std::string socket = protocol::servo_socket(arguments.servo);
    ServoWatch servo(socket);
    ServoView before = servo.look();
    servo.new_reports();
    Nanoseconds then = now_ns();
    std::signal(SIGINT, [](int) { interrupted = true; });
    std::signal(SIGTERM, [](int) { interrupted = true; });
    const Screen screen(::isatty(STDOUT_FILENO) != 0 && !arguments.json);
    for (std::uint64_t look = 0; !interrupted && (arguments.looks == 0 || look < arguments.looks); ++look) {
        timespec pause{
            .tv_sec = static_cast<time_t>(1 / arguments.hertz),
            .tv_nsec = static_cast<long>((1 / arguments.hertz - std::floor(1 / arguments.hertz)) * 1e9)};
        ::nanosleep(&pause, nullptr);  // a signal ends it
        if (interrupted) break;
        const auto reports = servo.new_reports();
        const Nanoseconds now = now_ns();
        ServoView view = servo.look();
        const double seconds = static_cast<double>(now - then) * 1e-9;
        json devices = json::array();
        std::string text = fmt::format("knurl:{}: pid {}, the last {:.2f} s\n", view.name, view.pid, seconds);
        bool still = !view.devices.empty();
        for (std::size_t i = 0; i < view.devices.size(); ++i) {
            const DeviceRates rates = rates_between(before.devices[i], view.devices[i], seconds, reports[i]);
            still = still && rates.rate == 0;
            if (arguments.json)
                devices.push_back(json_of(rates));
            else
                text += text_of(rates);
        }
        if (arguments.json) {
            text = json{{"servo", view.name}, {"pid", view.pid}, {"seconds", seconds}, {"devices", devices}}
                       .dump(-1, ' ', false, json::error_handler_t::replace) +
                   "\n";
        }
        screen.show(text);
        // A stopped servo may go on; one that has ended leaves its memory behind.
        if (still && ::kill(view.pid, 0) != 0)
            throw std::runtime_error(fmt::format(
                "the servo (pid {}) has ended; its flight record is in its state directory", view.pid));
        before = std::move(view);
        then = now;
    }
    return 0;
}

}  // namespace

void add_top(CLI::App& program, Run& run) {
    auto* verb =
        program.add_subcommand("top", "A servo at work, live: where its time goes, what its clients do");
    auto arguments = std::make_shared<Arguments>();
    verb->add_option("servo", arguments->servo, "its name")->capture_default_str()->type_name("NAME");
    verb->add_option("--rate", arguments->hertz, "looks a second")->capture_default_str()->type_name("HZ");
    verb->add_option("--looks", arguments->looks, "end after so many; default: when interrupted")
        ->type_name("N");
    verb->add_flag("--json", arguments->json, "a line of JSON for each look");
    verb->callback([&run, arguments] { run = [arguments] { return watch(*arguments); }; });
}

}  // namespace knurl::cli
