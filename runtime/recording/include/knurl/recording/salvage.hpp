#pragma once
// Makes a recording from what the guardian saved when a servo died.

#include <string>

#include <knurl/recording/mcap.hpp>

namespace knurl::recording {

/// `from`: a flight recorder's file, or a directory: its newest one. Returns a one-line summary. Throws
/// std::runtime_error.
std::string salvage(const std::string& from, const std::string& to, Existing existing);

}  // namespace knurl::recording
