#include <algorithm>
#include <string>
#include <utility>

#include <knurl/measure/measure.hpp>
#include <knurl/view/rates.hpp>

namespace knurl::view {

namespace {

std::uint64_t grown(std::uint64_t before, std::uint64_t now) {
    return now > before ? now - before : 0;
}

std::uint64_t grown(const DeviceView& before, const DeviceView& now, const std::string& counter) {
    const auto value = [&](const DeviceView& view) {
        const auto found = view.counters.find(counter);
        return found == view.counters.end() ? 0 : found->second;
    };
    return grown(value(before), value(now));
}

void note_lateness(DeviceRates& rates, const std::vector<Report>& seen) {
    std::vector<double> late;  // us
    for (const Report& report : seen)
        late.push_back(static_cast<double>(report.read_ns - report.deadline_ns) * 1e-3);
    if (late.empty()) return;
    const measure::Result result = measure::summarise("lateness", "us", std::move(late));
    rates.late_median = result.p50;
    rates.late_max = result.max;
}

}  // namespace

DeviceRates rates_between(const DeviceView& before, const DeviceView& now, double seconds,
                          const std::vector<Report>& seen) {
    DeviceRates rates;
    rates.device = now;
    rates.rate = static_cast<double>(grown(before, now, "cycles")) / seconds;
    rates.late = grown(before, now, "late_cycles");
    rates.overruns = grown(before, now, "overruns");
    if (const std::uint64_t stamped = grown(before, now, "stamped_cycles"); stamped > 0) {
        rates.parts.emplace();
        for (std::size_t i = 0; i < cycle_parts.size(); ++i) {
            const std::uint64_t time = grown(before, now, std::string(cycle_parts[i]) + "_ns");
            (*rates.parts)[i] = static_cast<double>(time) * 1e-3 / static_cast<double>(stamped);
            rates.step += (*rates.parts)[i];
        }
        rates.busy = rates.step * 1e-6 * now.info.rate;
        if (rates.rate > 0) rates.sleep = std::max(0.0, 1e6 / rates.rate - rates.step);
    }
    note_lateness(rates, seen);
    for (const ClientView& client : now.clients) {
        ClientRates of_client{.client = client};
        for (const ClientView& earlier : before.clients) {
            if (earlier.row != client.row || earlier.pid != client.pid || earlier.observer != client.observer)
                continue;
            of_client.updates = static_cast<double>(grown(earlier.commits, client.commits)) / seconds;
            of_client.merged = grown(earlier.merged, client.merged);
            of_client.refused = grown(earlier.refused, client.refused);
            of_client.missed = grown(earlier.missed, client.missed);
            break;
        }
        rates.clients.push_back(of_client);
    }
    return rates;
}

void keep_parts(const DeviceRates& before, DeviceRates& now) {
    if (now.parts) return;
    now.parts = before.parts;
    now.step = before.step;
    now.sleep = before.sleep;
    now.busy = before.busy;
}

}  // namespace knurl::view
