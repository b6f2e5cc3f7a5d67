#pragma once
// Makes a recording from what the guardian saved when a servo died.

#include <istream>
#include <string>
#include <vector>

#include <knurl/protocol/report.hpp>
#include <knurl/recording/mcap.hpp>
#include <knurl/recording/recording.hpp>

namespace knurl::recording {

/// What the guardian saved.
struct FlightRecord {
    RecordingInfo info;
    std::vector<Report> reports;
};

/// The flight recorder's file. Throws std::runtime_error "PATH:LINE: what".
FlightRecord read_flight_record(std::istream& text, const std::string& path);

/// `from`: a flight recorder's file, or a directory: its newest one. Returns a one-line summary. Throws
/// std::runtime_error.
std::string salvage(const std::string& from, const std::string& to, Existing existing);

}  // namespace knurl::recording
