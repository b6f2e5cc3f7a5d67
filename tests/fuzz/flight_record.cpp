// Any text as a flight record, as it is (first byte even) or as rows after a valid header: each of the two
// readers refuses it in one line, or returns reports that stay the same when they are written and read
// again.

#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>

#include <knurl/recording/salvage.hpp>
#include <knurl/servo/flight_recorder.hpp>

#include "refusal.hpp"
#include "trace_flight.hpp"

using namespace knurl;
using fuzz::require;

namespace {

std::string head() {
    return "# Knurl flight recorder: the last reports of a servo that died\n# build: 0.1.0 layout 0123\n"
           "# cause: killed by signal 9\n# servo: mine pid 17\n# device: right sim:premium15 1000 Hz\n" +
           std::string(servo::report_columns) + "\n";
}

std::string rows_of(const std::vector<Report>& reports) {
    std::string text;
    for (const Report& report : reports) text += servo::report_row(report);
    return text;
}

void check_salvage(const std::string& text) {
    std::istringstream stream(text);
    try {
        const recording::FlightRecord flight = recording::read_flight_record(stream, "f.csv");
        require(!flight.info.device.empty(), "a flight record is of a device");
        const std::string rows = rows_of(flight.reports);
        std::istringstream again(head() + rows);
        require(rows_of(recording::read_flight_record(again, "f.csv").reports) == rows,
                "it reads what it writes");
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "f.csv:");
    }
}

void check_trace(const std::string& text) {
    std::istringstream stream(text);
    try {
        bool cut = false;
        const cli::Timeline timeline = cli::read_flight_record(stream, "f.csv", cut);
        require(!timeline.reports.empty(), "a timeline has reports");
        for (std::size_t i = 1; i < timeline.reports.size(); ++i)
            require(timeline.reports[i].cycle > timeline.reports[i - 1].cycle, "cycles are in order");
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "f.csv:");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    std::string text = (data[0] & 1) != 0 ? head() : std::string();
    text.append(reinterpret_cast<const char*>(data + 1), size - 1);
    check_salvage(text);
    check_trace(text);
    return 0;
}
