#pragma once
// Judges nothing but what reached the device: the efforts and the times that its own process recorded.

#include <cstdint>
#include <string>
#include <vector>

#include "../drivers/shared_sim/layout.hpp"

namespace knurl::chaos {

using drivers::shared_sim::Event;
using drivers::shared_sim::Record;

double force_of(const Record& record);  // N, its size
inline bool is_write(const Record& record) {
    return record.event == Event::servo_write || record.event == Event::guardian_write;
}

/// What must hold always: finite; never above the device's peak; and between two writes that both arrived no
/// step up beyond what the slew gate passes in the time, with a cycle's grace. One line per violation.
std::vector<std::string> check_always(const std::vector<Record>& log, double peak_force, double slew,
                                      double period);

/// The first moment at or after `from` (ns) at which the force is zero and from which on it stays zero to the
/// end of the log; -1: there is none.
std::int64_t zero_since(const std::vector<Record>& log, std::int64_t from);

/// Largest force written at or after `from`.
double largest_force(const std::vector<Record>& log, std::int64_t from);

/// Smallest and largest force in effect from `from` on: what was written before it counts as well.
struct Span {
    double smallest = 0, largest = 0;
};
Span force_span(const std::vector<Record>& log, std::int64_t from);

/// For a person: when the force was smallest from `from` on, who wrote that, and for how long the efforts had
/// not changed before it (the log has changes only: the servo may well have written the same again).
std::string how_it_fell(const std::vector<Record>& log, std::int64_t from);

}  // namespace knurl::chaos
