#include <fmt/format.h>

#include <knurl/protocol/report_names.hpp>
#include <knurl/view/text.hpp>

namespace knurl::view {

std::string_view state_name(DeviceState state) {
    const auto index = static_cast<std::size_t>(state);
    return index < protocol::state_names.size() ? protocol::state_names[index].name : "unknown";
}

std::string fault_names(std::uint32_t mask) {
    std::string text;
    for (const protocol::ReportName& fault : protocol::fault_names)
        if ((mask & fault.value) != 0) text.append(text.empty() ? "" : ", ").append(fault.name);
    return text;
}

DeviceState state_of(const DeviceView& device) {
    return device.report ? device.report->state : DeviceState::disconnected;
}

std::uint32_t faults_of(const DeviceView& device) {
    return device.report ? device.report->faults : 0;
}

double force_of(const DeviceView& device) {
    return device.report ? to_eigen(device.report->sent_force).norm() : 0;
}

std::string representations_text(const ClientView& client) {
    std::string text;
    for (std::size_t kind = 0; kind < client.present.size(); ++kind) {
        if (client.present[kind] == 0) continue;
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", client.present[kind], kinds()[kind].name);
    }
    return text.empty() ? "nothing to feel" : text;
}

}  // namespace knurl::view
