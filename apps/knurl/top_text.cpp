#include "top_text.hpp"

#include <fmt/format.h>

#include <knurl/json/json.hpp>
#include <knurl/view/text.hpp>

#include "top_terminal.hpp"

namespace knurl::cli {

namespace {

using json = knurl::Json;

/// "12 merged (+3)": in total, and in this time.
std::string counted(std::uint64_t all, std::uint64_t now, std::string_view what) {
    std::string text = fmt::format("{} {}", all, what);
    if (now > 0) text += fmt::format(" (+{})", now);
    return text;
}

/// Likewise for errors: marked while they continue.
std::string counted_wrong(std::uint64_t all, std::uint64_t now, std::string_view what) {
    const std::string text = counted(all, now, what);
    return "  " + (now > 0 ? wrong(text) : text);
}

std::string text_of(const ClientRates& rates) {
    const ClientView& client = rates.client;
    std::string line = fmt::format("    pid {:<7} {:<20}", client.pid, client.name);
    if (client.observer)
        return line + "  observes" + counted_wrong(client.missed, rates.missed, "missed") + "\n";
    line += fmt::format("  {:7.1f} updates/s", rates.updates);
    line += client.age > 0 ? fmt::format("  {:8.3f} ms old at use", client.age * 1e3) : "  age unknown";
    line += "  " + counted(client.merged, rates.merged, "merged") +
            counted_wrong(client.refused, rates.refused, "refused") +
            counted_wrong(client.missed, rates.missed, "missed");
    line += fmt::format("  gain {:.2f}", client.gain);
    const auto scaled = [&line](double scale, const char* what) {
        if (scale < 1) line += fmt::format("  {} x{:.2f}", what, scale);
    };
    scaled(client.scales.contacts, "surfaces");
    scaled(client.scales.effects, "effects");
    scaled(client.scales.damping, "damping");
    if (client.silent) line += "  " + wrong("SILENT");
    if (client.shed) line += "  " + wrong("SHED: the cycles have no time for it");
    return line + "  " + representations_text(client) + "\n";
}

json json_of(const ClientRates& rates) {
    const ClientView& client = rates.client;
    return {{"pid", client.pid},
            {"name", client.name},
            {"role", client.observer ? "observer" : "claim"},
            {"update_rate", rates.updates},
            {"age_at_use_s", client.age > 0 ? json(client.age) : json()},
            {"updates_merged", client.merged},
            {"updates_refused", client.refused},
            {"reports_missed", client.missed},
            {"updates_merged_now", rates.merged},
            {"updates_refused_now", rates.refused},
            {"reports_missed_now", rates.missed},
            {"gain", client.gain},
            {"scales",
             {{"surfaces", client.scales.contacts},
              {"effects", client.scales.effects},
              {"damping", client.scales.damping}}},
            {"silent", client.silent},
            {"shed", client.shed}};
}

}  // namespace

std::string text_of(const DeviceRates& rates) {
    const DeviceView& device = rates.device;
    std::string state(state_name(state_of(device)));
    if (faults_of(device) != 0) state += ": " + fault_names(faults_of(device));
    const bool off = state_of(device) == DeviceState::fault || state_of(device) == DeviceState::disconnected;
    std::string text =
        fmt::format("{} ({})  {}", device.info.name, device.info.address, off ? wrong(state) : state);
    constexpr double all_of_them = 0.99;  // of the cycles; the rest lies in the moment of the look
    const std::string rate = fmt::format("{:.1f} of {:g} Hz", rates.rate, device.info.rate);
    text += fmt::format("  {}  force {:.2f} of {:.3g} N  k_max {:.4g} N/m\n",
                        rates.rate < all_of_them * device.info.rate ? wrong(rate) : rate, force_of(device),
                        device.info.peak_force, device.info.max_stiffness);
    text += "    lateness";
    if (rates.late_median) text += fmt::format("  median {:.1f} us", *rates.late_median);
    if (rates.late_max) text += fmt::format("  at most {:.1f} us", *rates.late_max);
    text += counted_wrong(device.counters.at("late_cycles"), rates.late, "late cycles") +
            counted_wrong(device.counters.at("overruns"), rates.overruns, "overruns") + "\n";
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
    const auto seconds = [](const std::optional<double>& us) { return us ? json(*us / 1e6) : json(); };
    const DeviceView& device = rates.device;
    json parts = nullptr, clients = json::array();
    if (rates.parts) {
        parts = json::object();
        for (std::size_t i = 0; i < cycle_parts.size(); ++i)
            parts[std::string(cycle_parts[i])] = (*rates.parts)[i] / 1e6;
        parts["sleep"] = rates.sleep / 1e6;
    }
    for (const ClientRates& client : rates.clients) clients.push_back(json_of(client));
    return {{"name", device.info.name},
            {"address", device.info.address},
            {"state", state_name(state_of(device))},
            {"faults", faults_of(device)},
            {"rate", device.info.rate},
            {"measured_rate", rates.rate},
            {"force", force_of(device)},
            {"late_cycles_now", rates.late},
            {"overruns_now", rates.overruns},
            {"late_p50_s", seconds(rates.late_median)},
            {"late_max_s", seconds(rates.late_max)},
            {"parts_s", parts},
            {"step_s", rates.parts ? json(rates.step / 1e6) : json()},
            {"busy", rates.busy},
            {"clients", clients}};
}

}  // namespace knurl::cli
