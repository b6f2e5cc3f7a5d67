#pragma once
// Judges only what reached the device: the efforts and the times that the device's own process recorded.

#include <cstdint>
#include <string>
#include <vector>

#include "../drivers/shared_sim/layout.hpp"

namespace knurl::chaos {

using drivers::shared_sim::Event;
using drivers::shared_sim::Record;

double force_of(const Record& record);  // N, its magnitude
inline bool is_write(const Record& record) {
    return record.event == Event::servo_write || record.event == Event::guardian_write;
}

/// Checks what must always hold: each force is finite and at most the device's peak, and between two writes
/// that arrived it rises by at most what the slew limit allows in that time and one more cycle. Returns one
/// line per violation.
std::vector<std::string> check_always(const std::vector<Record>& log, double peak_force, double slew,
                                      double period);

/// The first moment at or after `from` (ns) at which the force is zero and from which on it stays zero to the
/// end of the log; -1: there is none.
std::int64_t zero_since(const std::vector<Record>& log, std::int64_t from);

/// Largest force written at or after `from`.
double largest_force(const std::vector<Record>& log, std::int64_t from);

/// Smallest and largest force in effect from `from` on: the last write before it counts as well.
struct Span {
    double smallest = 0, largest = 0;
};
Span force_span(const std::vector<Record>& log, std::int64_t from);

/// A description for the reader of a failure: when the force was smallest since `from`, who wrote it, and
/// for how long the effort did not change before (the log has changes only: the servo may have repeated an
/// effort).
std::string how_it_fell(const std::vector<Record>& log, std::int64_t from);

}  // namespace knurl::chaos
