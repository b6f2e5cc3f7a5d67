#pragma once
// The bound on the time until a remote update takes effect, and how many updates met it.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/measure/measure.hpp>

#include "latency_paths.hpp"

namespace knurl::cli {

/// An update that arrives at a random phase waits for the servo's next cycle, at most one cycle. Before that
/// it takes one way by UDP and wakes the relaying thread. All other work may add a fifth of those two.
struct RemoteBound {
    static constexpr double grace = 1.2;

    /// Updates in use (their cycle began) within period + grace x (median UDP one way + median wake-up). Each
    /// floor's sample is taken before a wait of 0 to 1 cycle, so their tail belongs to the machine.
    measure::Bound use{.name = "update.remote_to_use", .unit = "us"};
    std::size_t write_within = 0;  // those of them also written to the motors in time
};

struct FloorMedians {
    double udp_one_way = 0, wake = 0;  // ns
};

/// None without updates, or if a floor has no sample. `medians` are the table's, which may include more
/// samples than those here. `gaps`: from a witness during the measurement.
std::optional<RemoteBound> remote_bound(const PathSamples& paths, std::span<const double> udp_one_way,
                                        std::span<const double> wake, const FloorMedians& medians,
                                        Nanoseconds period, std::span<const measure::Gap> gaps);

/// In a line or two.
std::string to_text(const RemoteBound& bound);

}  // namespace knurl::cli
