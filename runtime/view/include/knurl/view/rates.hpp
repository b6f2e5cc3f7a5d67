#pragma once
// What happened between two looks at a servo.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <knurl/view/servo_view.hpp>

namespace knurl::view {

/// Parts of a cycle, in their order, as the servo stamps them (protocol::Count).
inline constexpr std::array<std::string_view, 7> cycle_parts = {"read",      "kinematics", "take",   "scenes",
                                                                "supervise", "write",      "publish"};

struct ClientRates {
    ClientView client;
    double updates = 0;  // taken by the servo, per second; skipped updates are in `merged`
    std::uint64_t merged = 0, refused = 0, missed = 0;
};

struct DeviceRates {
    DeviceView device;
    double rate = 0;  // Hz, measured
    std::uint64_t late = 0, overruns = 0;
    /// us, means over the stamped cycles (one in 64); none: no cycle was stamped in this time.
    std::optional<std::array<double, cycle_parts.size()>> parts;
    double step = 0;   // us, of all parts
    double sleep = 0;  // us, the rest of the measured period
    double busy = 0;   // of the period, 0 to 1
    // us, from deadline to read, of the reports that were seen; the median of 20 or more
    std::optional<double> late_median, late_max;
    std::vector<ClientRates> clients;
};

/// If no cycle was stamped in this time, keeps the parts of the previous look.
void keep_parts(const DeviceRates& before, DeviceRates& now);

/// `seconds` between the looks; `seen`: the reports in between. A device with lower counts than before
/// belongs to another servo: its rates are 0.
DeviceRates rates_between(const DeviceView& before, const DeviceView& now, double seconds,
                          const std::vector<Report>& seen);

}  // namespace knurl::view
