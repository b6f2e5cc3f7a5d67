#pragma once

#include <istream>
#include <string>

#include "trace_timeline.hpp"

namespace knurl::cli {

/// Reads what the guardian of a dead servo has saved: all reports, no parts. An incomplete last line is left
/// out and reported in `cut`. Throws std::runtime_error with the line if it is no such file.
Timeline read_flight_record(const std::string& path, bool& cut);
/// The same from any text; `path` begins its errors.
Timeline read_flight_record(std::istream& file, const std::string& path, bool& cut);

}  // namespace knurl::cli
