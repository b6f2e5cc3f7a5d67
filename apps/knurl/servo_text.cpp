#include "servo_text.hpp"

#include <iterator>

#include <fmt/format.h>

namespace knurl::cli {

std::string_view state_name(DeviceState state) {
    constexpr std::string_view names[] = {"disconnected", "idle",      "armed", "ramp up",
                                          "active",       "ramp down", "fault"};
    const auto index = static_cast<std::size_t>(state);
    return index < std::size(names) ? names[index] : "unknown";
}

std::string fault_names(std::uint32_t mask) {
    constexpr std::string_view names[] = {"not finite", "slew",        "speed",        "power",
                                          "unplugged",  "bad samples", "encoder jump", "clock jump",
                                          "kinematics", "guardian"};
    std::string text;
    for (std::size_t bit = 0; bit < std::size(names); ++bit) {
        if ((mask >> bit & 1) != 0) text += (text.empty() ? "" : ", ") + std::string(names[bit]);
    }
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

}  // namespace knurl::cli
