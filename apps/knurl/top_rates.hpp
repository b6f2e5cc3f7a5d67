#pragma once
// What happened between two looks at a servo.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "servo_view.hpp"

namespace knurl::cli {

/// Parts of a cycle, in their order, as the servo stamps them (protocol::Count).
inline constexpr std::array<std::string_view, 7> cycle_parts = {"read",      "kinematics", "take",   "scenes",
                                                                "supervise", "write",      "publish"};

struct ClientRates {
    ClientView client;
    double updates = 0;  // taken by the servo, a second; what it did not take alone is in `merged`
    std::uint64_t merged = 0, refused = 0, missed = 0;
};

struct DeviceRates {
    DeviceView device;
    double rate = 0;  // Hz, measured
    std::uint64_t late = 0, overruns = 0;
    /// us, means of the cycles that were stamped (one in 64); none: none was in this time.
    std::optional<std::array<double, cycle_parts.size()>> parts;
    double step = 0;   // us, of all parts
    double sleep = 0;  // us, the rest of the measured period
    double busy = 0;   // of the period, 0 to 1
    // us, from deadline to read, of the reports that were seen; the median of 20 or more
    std::optional<double> late_median, late_max;
    std::vector<ClientRates> clients;
};

/// Of the parts of a cycle, where none was stamped in this time, what the look before said.
void keep_parts(const DeviceRates& before, DeviceRates& now);

/// `seconds` between the looks; `seen`: the reports that came in between. A device that counts less than
/// before is another servo's: its rates are 0.
DeviceRates rates_between(const DeviceView& before, const DeviceView& now, double seconds,
                          const std::vector<Report>& seen);

}  // namespace knurl::cli
