#pragma once
// A report as messages of ROS 2, in CDR. `stamp_ns`: CLOCK_REALTIME of the report's read.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <knurl/protocol/report.hpp>

namespace knurl::messages {

using Bytes = std::vector<std::byte>;

/// Of the report as it is: knurl_msgs/Report.
Bytes report_message(const Report& report);
/// The tip, in the device's frame.
Bytes pose_message(std::string_view device, std::int64_t stamp_ns, const Report& report);
/// Force and torque on the hand, as sent, in the device's frame.
Bytes wrench_message(std::string_view device, std::int64_t stamp_ns, const Report& report);
/// Velocity and angular velocity of the tip, in the device's frame.
Bytes twist_message(std::string_view device, std::int64_t stamp_ns, const Report& report);
/// The first `joints` positions of joints.
Bytes joints_message(std::string_view device, std::int64_t stamp_ns, const Report& report,
                     std::uint32_t joints);
/// 32 buttons, no axes.
Bytes joy_message(std::string_view device, std::int64_t stamp_ns, const Report& report);

/// A device's base -> hand.
struct HandTransform {
    std::string_view device;
    std::int64_t stamp_ns = 0;
    const Report* report = nullptr;
};
Bytes transforms_message(std::span<const HandTransform> transforms);

/// diagnostic_msgs/DiagnosticStatus.
struct Diagnostic {
    enum Level : std::uint8_t { ok = 0, warn = 1, error = 2, stale = 3 };
    Level level = ok;
    std::string name, message, hardware_id;
    std::vector<std::pair<std::string, std::string>> values;
};
Bytes diagnostics_message(std::int64_t stamp_ns, std::span<const Diagnostic> diagnostics);

}  // namespace knurl::messages
