#include "top_text.hpp"

#include <fmt/format.h>
#include <json.hpp>

#include "servo_text.hpp"

namespace knurl::cli {

namespace {

using json = knurl::Json;

/// "12 merged (+3)": in all, and in this time.
std::string counted(std::uint64_t all, std::uint64_t now, std::string_view what) {
    std::string text = fmt::format("  {} {}", all, what);
    if (now > 0) text += fmt::format(" (+{})", now);
    return text;
}

std::string text_of(const ClientRates& rates) {
    const ClientView& client = rates.client;
    std::string line = fmt::format("    pid {:<7} {:<20}", client.pid, client.name);
    if (client.observer) return line + "  observes" + counted(client.missed, rates.missed, "missed") + "\n";
    line += fmt::format("  {:7.1f} updates/s", rates.updates);
    line += client.age > 0 ? fmt::format("  {:8.3f} ms old at use", client.age * 1e3) : "  age unknown";
    line += counted(client.merged, rates.merged, "merged") +
            counted(client.refused, rates.refused, "refused") +
            counted(client.missed, rates.missed, "missed");
    line += fmt::format("  gain {:.2f}", client.gain);
    if (client.silent) line += "  SILENT";
    return line + "  " + representations_text(client) + "\n";
}

json json_of(const ClientRates& rates) {
    const ClientView& client = rates.client;
    return {{"pid", client.pid},
            {"name", client.name},
            {"role", client.observer ? "observer" : "claim"},
            {"updates", rates.updates},
            {"age_at_use_us", client.age > 0 ? json(client.age * 1e6) : json()},
            {"merged", rates.merged},
            {"refused", rates.refused},
            {"missed", rates.missed},
            {"merged_in_all", client.merged},
            {"refused_in_all", client.refused},
            {"missed_in_all", client.missed},
            {"gain", client.gain},
            {"silent", client.silent}};
}

}  // namespace

std::string text_of(const DeviceRates& rates) {
    const DeviceView& device = rates.device;
    std::string text =
        fmt::format("{} ({})  {}", device.info.name, device.info.address, state_name(state_of(device)));
    if (faults_of(device) != 0) text += fmt::format(": {}", fault_names(faults_of(device)));
    text +=
        fmt::format("  {:.1f} of {:g} Hz  force {:.2f} of {:.3g} N  k_max {:.4g} N/m\n", rates.rate,
                    device.info.rate, force_of(device), device.info.peak_force, device.info.max_stiffness);
    text += "    lateness";
    if (rates.late_median) text += fmt::format("  median {:.1f} us", *rates.late_median);
    if (rates.late_max) text += fmt::format("  at most {:.1f} us", *rates.late_max);
    text += counted(device.counters.at("late_cycles"), rates.late, "late cycles") +
            counted(device.counters.at("overruns"), rates.overruns, "overruns") + "\n";
    if (rates.parts) {
        text += "    cycle us";
        for (std::size_t i = 0; i < cycle_parts.size(); ++i)
            text += fmt::format("  {} {:.2f}", cycle_parts[i], (*rates.parts)[i]);
        text += fmt::format("  sleep {:.1f}  busy {:.2f} ({:.2f} %)\n", rates.sleep, rates.step,
                            rates.busy * 100);
    }
    if (rates.clients.empty()) text += "    nobody holds it\n";
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
        parts["sleep"] = rates.sleep;
    }
    for (const ClientRates& client : rates.clients) clients.push_back(json_of(client));
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

}  // namespace knurl::cli
