#pragma once
// What a remote update may take until it is in effect, and how many kept to it.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/measure/measure.hpp>

#include "latency_paths.hpp"

namespace knurl::cli {

/// An update that comes at a random phase waits for the servo's next cycle, one at most; before that it goes
/// one way by UDP and wakes whoever hands it on. A fifth of those two is granted for all else that is done.
struct RemoteBound {
    static constexpr double grace = 1.2;

    /// Updates in use (their cycle began) within period + grace x (median UDP one way + median wake-up). The
    /// floors' own samples are taken each before a wait of 0 to 1 cycle: their tail is the machine's.
    measure::Bound use{.name = "update.remote_to_use", .unit = "us"};
    std::size_t write_within = 0;  // of these updates: also written to the motors
};

struct FloorMedians {
    double udp_one_way = 0, wake = 0;  // ns
};

/// None where nothing was updated, or a floor has no sample. `medians` are those of the table, which may have
/// seen more than the samples here. `gaps`: of a witness, while it was measured.
std::optional<RemoteBound> remote_bound(const PathSamples& paths, std::span<const double> udp_one_way,
                                        std::span<const double> wake, const FloorMedians& medians,
                                        Nanoseconds period, std::span<const measure::Gap> gaps);

/// In a line or two.
std::string to_text(const RemoteBound& bound);

}  // namespace knurl::cli
