#pragma once

#include <chrono>
#include <cstdint>

namespace knurl {

/// What lies between an application and its servo. On one box nothing does: all 0. Each report since the
/// first one that came was read, or overwritten unread, or is lost, or late; a network that reorders makes
/// them late.
struct Network {
    /// Reports that never came; one on its way still may.
    std::uint64_t lost = 0;
    /// Reports that came after a newer one, and were dropped.
    std::uint64_t late = 0;
    /// Copies of reports that had come, which were dropped.
    std::uint64_t duplicated = 0;
    /// Batches that were sent again because no answer had come.
    std::uint64_t resent = 0;
    /// Shortest round trip of the last exchanges.
    std::chrono::nanoseconds round_trip{0};
    /// The servo's CLOCK_MONOTONIC minus ours.
    std::chrono::nanoseconds clock_offset{0};
    /// The offset is right within this.
    std::chrono::nanoseconds clock_uncertainty{0};
    /// How much faster the servo's clock runs (s/s).
    double drift = 0;
    /// The drift is right within this (s/s).
    double drift_uncertainty = 0;
    /// True: what is sent is encrypted.
    bool encrypted = false;
};

/// How old something is now, by the servo's clock, and how far that may be off.
struct Age {
    /// The age.
    std::chrono::nanoseconds age{0};
    /// It is right within this.
    std::chrono::nanoseconds uncertainty{0};
};

}  // namespace knurl
