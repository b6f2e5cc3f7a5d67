#pragma once

/// @file
/// The last few thousand reports of a servo that died, as a file that a person or a program can read.

#include <cstddef>
#include <string>
#include <string_view>

#include <knurl/protocol/report.hpp>

namespace knurl::servo {

/// The names of a report's columns, with commas between: its members in the order in which they lie in
/// memory.
extern const std::string_view report_columns;
/// One line of these columns, doubles with 17 digits: they come back to the bit.
std::string report_row(const Report& report);

/// Writes what is readable in a device's report memory (protocol::device_layout) to
/// `directory`/flight-SERVO-DEVICE-TIME.csv, the time in UTC: comment lines (build, cause, device), one line
/// of column names, one line per report, oldest first, doubles so that they survive. The file appears
/// complete or not at all; on a full disk it has as many of the newest reports as there is room for, and says
/// so. Makes the directory. Returns the path; throws std::runtime_error.
std::string write_flight_record(const std::string& directory, const std::byte* device_segment,
                                const std::string& cause);

}  // namespace knurl::servo
