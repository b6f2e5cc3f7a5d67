#pragma once
// What a remote update may take until it is in effect, and how many kept to it.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "latency_paths.hpp"

namespace knurl::cli {

/// An update that comes at a random phase waits for the servo's next cycle, one at most; before that it goes
/// one way by UDP and wakes whoever hands it on. A fifth of those two is granted for all else that is done.
struct RemoteBound {
    static constexpr double grace = 1.2;

    double limit = 0;              // ns: period + grace x (median UDP one way + median wake-up)
    std::size_t n = 0;             // updates
    std::size_t use_within = 0;    // of these, how many were in use within it (the cycle began),
    std::size_t write_within = 0;  // and how many also written to the motors
    /// The share of the floors' own samples that would have kept it, each before a wait of 0 to 1 cycle:
    /// their tail is the machine's.
    double floors_within = 0;
    std::size_t stalled = 0;  // not in use within it, but the machine stood still meanwhile
};

/// None where a floor has too few samples for a median, or nothing was updated. `gaps`: of a witness, while
/// it was measured.
std::optional<RemoteBound> remote_bound(const PathSamples& paths, std::span<const double> udp_one_way,
                                        std::span<const double> wake, Nanoseconds period,
                                        std::span<const measure::Gap> gaps);

/// In a line or two.
std::string to_text(const RemoteBound& bound);

}  // namespace knurl::cli
