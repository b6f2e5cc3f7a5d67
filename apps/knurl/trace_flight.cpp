#include "trace_flight.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

namespace knurl::cli {

namespace {

std::vector<std::string> split(const std::string& line, char at) {
    std::vector<std::string> words;
    std::istringstream text(line);
    for (std::string word; std::getline(text, word, at);) words.push_back(word);
    return words;
}

/// The columns that a timeline needs, in any position.
class Columns {
  public:
    explicit Columns(const std::vector<std::string>& names) : size_(names.size()) {
        for (std::size_t i = 0; i < names.size(); ++i) places_[names[i]] = i;
    }
    std::size_t size() const { return size_; }

    template <class T>
    bool take(const std::vector<std::string>& row, const std::string& name, T& value) const {
        const std::string& text = row[place(name)];
        const auto end = text.data() + text.size();
        const auto [stopped, error] = std::from_chars(text.data(), end, value);
        return error == std::errc() && stopped == end;
    }
    std::size_t place(const std::string& name) const {
        const auto found = places_.find(name);
        if (found == places_.end())
            throw std::runtime_error("has no column " + name + "; it is of another version of Knurl");
        return found->second;
    }

  private:
    std::size_t size_;
    std::map<std::string, std::size_t> places_;
};

/// False: a value is not a number.
bool parse(const Columns& columns, const std::vector<std::string>& row, Report& report) {
    std::uint32_t state = 0;
    const auto vector = [&](const std::string& name, Vec3& v) {
        return columns.take(row, name + "x", v.x) && columns.take(row, name + "y", v.y) &&
               columns.take(row, name + "z", v.z);
    };
    const bool all =
        columns.take(row, "cycle", report.cycle) && columns.take(row, "deadline_ns", report.deadline_ns) &&
        columns.take(row, "read_ns", report.read_ns) && columns.take(row, "write_ns", report.write_ns) &&
        vector("scene_f", report.scene_force) && vector("sent_f", report.sent_force) &&
        columns.take(row, "state", state) && columns.take(row, "faults", report.faults) &&
        columns.take(row, "flags", report.flags) && columns.take(row, "late_count", report.late_count);
    report.state = static_cast<DeviceState>(state);
    return all;
}

/// "# servo: default pid 17", "# device: right sim:premium15 1000 Hz", "# cause: SIGKILL"
void take_heading(const std::string& line, Timeline& timeline) {
    const auto value = [&line](std::string_view name) {
        const std::string begin = fmt::format("# {}: ", name);
        return line.starts_with(begin) ? line.substr(begin.size()) : std::string();
    };
    if (const auto cause = value("cause"); !cause.empty()) timeline.cause = cause;
    if (const auto words = split(value("servo"), ' '); !words.empty()) timeline.servo = words[0];
    if (const auto words = split(value("device"), ' '); words.size() == 4) {
        timeline.device = words[0];
        timeline.address = words[1];
        timeline.rate = std::strtod(words[2].c_str(), nullptr);
    }
}

}  // namespace

Timeline read_flight_record(const std::string& path, bool& cut) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
    return read_flight_record(file, path, cut);
}

Timeline read_flight_record(std::istream& file, const std::string& path, bool& cut) {
    const auto wrong = [&path](std::size_t line, const std::string& what) {
        return std::runtime_error(fmt::format("{}:{}: {}", path, line, what));
    };
    Timeline timeline;
    std::optional<Columns> columns;
    std::string line;
    cut = false;
    for (std::size_t number = 1; std::getline(file, line); ++number) {
        if (number == 1 && !line.starts_with("# Knurl flight recorder"))
            throw wrong(1, "this is no flight record; give a flight-*.csv that a guardian saved");
        if (line.starts_with('#')) {
            take_heading(line, timeline);
            continue;
        }
        const bool whole = !file.eof();
        const auto row = split(line, ',');
        if (!columns) {
            columns.emplace(row);
            continue;
        }
        Report report;
        try {
            if (whole && row.size() == columns->size() && parse(*columns, row, report)) {
                if (!timeline.reports.empty() && report.cycle <= timeline.reports.back().cycle)
                    throw std::runtime_error("this cycle is not after the one above");
                timeline.reports.push_back(report);
                continue;
            }
        } catch (const std::runtime_error& error) {
            throw wrong(number, error.what());
        }
        if (file.peek() != std::istream::traits_type::eof()) throw wrong(number, "this is no report");
        cut = true;
    }
    if (timeline.reports.empty()) throw wrong(1, "there is no report in it");
    return timeline;
}

}  // namespace knurl::cli
