#pragma once
// knurl record --room: devices of several servos, on this host and others, into one file with one time base.

#include <string>
#include <vector>

#include <knurl/recording/mcap.hpp>

namespace knurl::cli {

struct RoomsArguments {
    /// "left=knurl://lab/left", "left=knurl:lab,left".
    std::vector<std::string> rooms;
    std::string file;
    double seconds = 0;  // 0: until interrupted
    recording::Existing existing = recording::Existing::kept;
};

/// Returns the program's exit code. Throws UsageError, or std::runtime_error: a room cannot be reached.
int record_rooms(const RoomsArguments& arguments, int signals);

}  // namespace knurl::cli
