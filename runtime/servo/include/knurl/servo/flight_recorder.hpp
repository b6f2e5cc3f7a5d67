#pragma once
// The last few thousand reports of a servo that died, as a file that a person or a program can read.

#include <cstddef>
#include <string>

namespace knurl::servo {

/// Writes what is readable in a device's report memory (protocol::device_layout) to
/// `directory`/flight-SERVO-DEVICE-<UTC>.csv: comment lines (build, cause, device), one line of column names,
/// one line per report, oldest first, doubles so that they survive. The file appears whole or not at all.
/// Makes the directory. Returns the path; throws std::runtime_error.
std::string write_flight_record(const std::string& directory, const std::byte* device_segment,
                                const std::string& cause);

}  // namespace knurl::servo
