#pragma once

#include <string>

#include "trace_timeline.hpp"

namespace knurl::cli {

/// What the guardian of a servo that died has saved: all reports, no parts. A last line that is not whole is
/// left out, and said in `cut`. Throws std::runtime_error with the line where it is no such file.
Timeline read_flight_record(const std::string& path, bool& cut);

}  // namespace knurl::cli
