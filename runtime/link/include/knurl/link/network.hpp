#pragma once

#include <chrono>
#include <cstdint>

namespace knurl {

/// What lies between an application and its servo. On one box nothing does: all 0. Each report since the
/// first one that came was read, or overwritten unread, or is lost, or late; a network that reorders makes
/// them late.
struct Network {
    std::uint64_t lost = 0;                         // reports that never came; one on its way still may
    std::uint64_t late = 0;                         // that came after a newer one, and were dropped
    std::uint64_t duplicated = 0;                   // copies of what had come, which were dropped
    std::uint64_t resent = 0;                       // batches sent again because no answer had come
    std::chrono::nanoseconds round_trip{0};         // the shortest of the last exchanges
    std::chrono::nanoseconds clock_offset{0};       // the servo's CLOCK_MONOTONIC minus ours
    std::chrono::nanoseconds clock_uncertainty{0};  // the offset is right within this
    double drift = 0;                               // s/s: how much faster the servo's clock runs
    double drift_uncertainty = 0;                   // s/s: the drift is right within this
    bool encrypted = false;
};

/// How old something is now, by the servo's clock, and how far that may be off.
struct Age {
    std::chrono::nanoseconds age{0};
    std::chrono::nanoseconds uncertainty{0};
};

}  // namespace knurl
