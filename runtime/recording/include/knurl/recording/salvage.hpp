#pragma once
// What the guardian saved of a servo that died, as a recording.

#include <string>

#include <knurl/recording/mcap.hpp>

namespace knurl::recording {

/// `from`: a flight recorder's file, or a directory: its newest one. Returns a line about it. Throws
/// std::runtime_error.
std::string salvage(const std::string& from, const std::string& to, Existing existing);

}  // namespace knurl::recording
