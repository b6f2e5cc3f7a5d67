#include "diagnostics.hpp"

#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ros_messages.h"

namespace knurl::dds {

namespace {

constexpr std::uint8_t ok = 0, warn = 1, error = 2, stale = 3;

/// One status, with the texts that its C struct points to.
struct Status {
    std::uint8_t level = ok;
    std::string name, message, hardware;
    std::vector<std::pair<std::string, std::string>> values;
    std::vector<diagnostic_msgs_msg_dds__KeyValue_> pairs;

    diagnostic_msgs_msg_dds__DiagnosticStatus_ wire() {
        for (auto& [key, value] : values) pairs.push_back({.key = key.data(), .value = value.data()});
        diagnostic_msgs_msg_dds__DiagnosticStatus_ made{};
        made.level = level;
        made.name = name.data();
        made.message = message.data();
        made.hardware_id = hardware.data();
        made.values._maximum = made.values._length = static_cast<std::uint32_t>(pairs.size());
        made.values._buffer = pairs.data();
        return made;
    }
};

Status status_of(const ServoEntry& servo, const DeviceEntry& device) {
    Status made{.name = fmt::format("knurl {}: {}", servo.name, device.name),
                .message = device.state,
                .hardware = device.profile,
                .values = {},
                .pairs = {}};
    if (!device.faults.empty()) {
        made.level = error;
        made.message = "fault: " + device.faults;
    } else if (device.state == "disconnected") {
        made.level = stale;
    } else if (device.measured_rate > 0 && device.measured_rate < 0.95 * device.rate) {
        made.level = warn;
        made.message = fmt::format("{:.0f} Hz in place of {:.0f}", device.measured_rate, device.rate);
    }
    made.values = {{"rate", fmt::format("{:.1f}", device.measured_rate)},
                   {"cycles", fmt::format("{}", device.cycles)},
                   {"late cycles", fmt::format("{}", device.late_cycles)},
                   {"force", fmt::format("{:.3f}", device.force)},
                   {"holders", fmt::format("{}", device.holders)}};
    return made;
}

}  // namespace

Diagnostics::Diagnostics(Domain& domain, const RobotOptions& options) {
    const auto said = options.rates.find("diagnostics");
    const double rate = said == options.rates.end() ? default_rates().at("diagnostics") : said->second;
    if (rate <= 0) return;
    interval_ = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate));
    const std::string topic =
        options.remap.contains("diagnostics") ? dds_topic(options, "diagnostics") : "rt/diagnostics";
    writer_ = domain.writer(topic, diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                            {.message = "diagnostic_msgs/msg/DiagnosticArray"});
}

void Diagnostics::write(const ServoEntry& servo) {
    const auto now = std::chrono::steady_clock::now();
    dds_publication_matched_status_t readers{};
    if (!writer_ || now < due_ ||
        dds_get_publication_matched_status(writer_.get(), &readers) != DDS_RETCODE_OK ||
        readers.current_count == 0)
        return;
    due_ = now + interval_;
    std::vector<Status> all;
    for (const DeviceEntry& device : servo.devices) all.push_back(status_of(servo, device));
    if (servo.state != "running")
        all.push_back({.level = stale,
                       .name = "knurl " + servo.name,
                       .message = "its servo does not run",
                       .hardware = {},
                       .values = {},
                       .pairs = {}});
    std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> wires;
    for (Status& each : all) wires.push_back(each.wire());
    timespec time{};
    ::clock_gettime(CLOCK_REALTIME, &time);
    std::string no_frame;
    diagnostic_msgs_msg_dds__DiagnosticArray_ message{};
    message.header = {.stamp = {.sec = static_cast<std::int32_t>(time.tv_sec),
                                .nanosec = static_cast<std::uint32_t>(time.tv_nsec)},
                      .frame_id = no_frame.data()};
    message.status._maximum = message.status._length = static_cast<std::uint32_t>(wires.size());
    message.status._buffer = wires.data();
    dds_write(writer_.get(), &message);
}

}  // namespace knurl::dds
