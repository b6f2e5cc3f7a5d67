#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <type_traits>

#include <fmt/format.h>

#include <knurl/recording/recording.hpp>
#include <knurl/recording/salvage.hpp>
#include <knurl/servo/flight_recorder.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::recording {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_heading = 256;  // bytes

std::string newest_in(const std::string& directory) {
    std::string newest;
    fs::file_time_type when;
    for (const auto& file : fs::directory_iterator(directory)) {
        const std::string name = file.path().filename().string();
        if (!name.starts_with("flight-") || file.path().extension() != ".csv") continue;
        if (!newest.empty() && file.last_write_time() < when) continue;
        when = file.last_write_time();
        newest = file.path().string();
    }
    if (newest.empty())
        throw std::runtime_error(directory + ": no flight-*.csv there: no servo of this user has died");
    return newest;
}

/// The columns are a report's members in the same order: see servo::report_columns.
bool parse_row(std::string_view row, Report& report) {
    auto* to = reinterpret_cast<std::byte*>(&report);
    const auto take = [&](auto value) {
        const std::string_view cell = row.substr(0, row.find(','));
        row.remove_prefix(std::min(row.size(), cell.size() + 1));
        const auto parsed = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        std::memcpy(to, &value, sizeof value);
        to += sizeof value;
        return parsed.ec == std::errc() && parsed.ptr == cell.data() + cell.size();
    };
    bool good = take(std::uint64_t{});
    for (int i = 0; i < 3; ++i) good = good && take(std::int64_t{});
    while (good && to != reinterpret_cast<std::byte*>(&report) + offsetof(Report, state))
        good = take(double{});
    for (int i = 0; i < 4; ++i) good = good && take(std::uint32_t{});
    return good && take(std::uint64_t{}) && take(std::uint32_t{}) && take(std::uint32_t{}) && row.empty() &&
           report.state <= DeviceState::fault;
}

/// "# build: 0.1.0 layout 0123": the words after the colon.
std::istringstream words_of(const std::string& line) {
    return std::istringstream(line.substr(line.find(':') + 1));
}

}  // namespace

FlightRecord read_flight_record(std::istream& text, const std::string& path) {
    FlightRecord flight;
    RecordingInfo& info = flight.info;
    int number = 0;
    const auto fail = [&](const std::string& what) {
        throw std::runtime_error(fmt::format("{}:{}: {}", path, number, what));
    };
    std::string line, skipped;
    while (++number, std::getline(text, line) && line.starts_with("#")) {
        if (line.starts_with("# build:")) words_of(line) >> info.version >> skipped >> std::hex >> info.wire;
        if (line.starts_with("# servo:")) words_of(line) >> info.servo;
        if (line.starts_with("# device:")) words_of(line) >> info.device >> info.address >> info.options.rate;
        if (line.starts_with("# cause: ")) info.cause = line.substr(line.find(':') + 2);
    }
    // Programs print them, and a file may hold any character.
    for (std::string* said : {&info.version, &info.servo, &info.device, &info.address, &info.cause})
        *said = words::printable(*said, longest_heading);
    if (info.device.empty() || line != servo::report_columns)
        fail(
            "is no flight record of this version; give what the guardian saved, "
            "flight-SERVO-DEVICE-TIME.csv");
    while (++number, std::getline(text, line))
        if (!parse_row(line, flight.reports.emplace_back()))
            fail("is no report: the file was changed, or cut off");
    return flight;
}

std::string salvage(const std::string& from, const std::string& to, Existing existing) {
    std::error_code ignored;
    const std::string path = fs::is_directory(from, ignored) ? newest_in(from) : from;
    std::ifstream file(path);
    if (!file) throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
    const FlightRecord flight = read_flight_record(file, path);

    RecordingWriter out(to, flight.info, existing);
    for (const Report& report : flight.reports) {
        out.report(report);
        if (out.full()) out.flush();
    }
    if (!out.finish()) throw std::runtime_error(out.problem());
    return fmt::format("{}: {} reports of {}, device '{}' ({}): {}; shapes that were felt are not in it", to,
                       flight.reports.size(), path, flight.info.device, flight.info.address,
                       flight.info.cause);
}

}  // namespace knurl::recording
