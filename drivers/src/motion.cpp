#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <knurl/drivers/motion.hpp>
#include <knurl/words/printable.hpp>

#include "rotation_vector.hpp"

namespace knurl::drivers {

namespace {

constexpr std::array<std::string_view, 8> column_names = {"t", "x", "y", "z", "qw", "qx", "qy", "qz"};

// Beyond these, differences of rows and speeds between them would not be finite.
constexpr double farthest_place = 1e6, latest_time = 1e9;  // m, s
constexpr double least_step = 1e-9;                        // s: the servo's clock
constexpr double shortest_quaternion = 1e-6, longest_quaternion = 1e6;

bool has_length(const Eigen::Quaterniond& orientation) {
    const double length = orientation.norm();
    return length > shortest_quaternion && length < longest_quaternion;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view space = " \t\r";
    const auto first = text.find_first_not_of(space);
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(space) - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> fields;
    while (true) {
        const auto comma = line.find(',');
        fields.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) {
            return fields;
        }
        line.remove_prefix(comma + 1);
    }
}

bool parse_number(std::string_view field, double& value) {
    if (field.starts_with('+')) {
        field.remove_prefix(1);
    }
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    return error == std::errc() && end == field.data() + field.size() && !field.empty();
}

bool is_header(const std::vector<std::string_view>& fields) {
    return fields.size() <= column_names.size() &&
           std::equal(fields.begin(), fields.end(), column_names.begin());
}

}  // namespace

Motion::Motion(std::vector<MotionRow> rows, bool has_orientation)
    : rows_(std::move(rows)), has_orientation_(has_orientation) {
    if (rows_.empty()) {
        throw std::runtime_error("motion: no rows");
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        MotionRow& row = rows_[i];
        const std::string where = "motion: row " + std::to_string(i + 1);
        if (!std::isfinite(row.t) || !row.position.allFinite() || !row.orientation.coeffs().allFinite()) {
            throw std::runtime_error(where + " holds a number that is not finite");
        }
        if (std::abs(row.t) > latest_time || row.position.lpNorm<Eigen::Infinity>() > farthest_place) {
            throw std::runtime_error(where + " is beyond 1e6 m or 1e9 s");
        }
        if (i > 0 && !(row.t - rows_[i - 1].t >= least_step)) {
            throw std::runtime_error(where + ": its time is not after the row before");
        }
        if (!has_length(row.orientation)) {
            throw std::runtime_error(where + ": the length of the quaternion is not 1e-6 to 1e6");
        }
        const double length = row.orientation.norm();
        if (std::abs(length - 1) > 1e-15) {
            row.orientation.coeffs() /= length;
        }
    }
    turn_.reserve(rows_.size() - 1);
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
        turn_.push_back(rotation_vector(rows_[i].orientation, rows_[i + 1].orientation));
    }
}

MotionSample Motion::sample(double t) const noexcept {
    std::size_t hint = rows_.size();
    return sample(t, hint);
}

MotionSample Motion::sample(double t, std::size_t& hint) const noexcept {
    if (!(t >= begin()) || rows_.size() == 1) {
        return {.position = rows_.front().position, .orientation = rows_.front().orientation};
    }
    if (t > end()) {
        return {.position = rows_.back().position, .orientation = rows_.back().orientation};
    }
    // The segment i with rows_[i].t <= t < rows_[i+1].t; the last segment includes its end.
    const std::size_t last = rows_.size() - 2;
    const auto holds = [&](std::size_t i) {
        return i <= last && rows_[i].t <= t && (t < rows_[i + 1].t || i == last);
    };
    if (!holds(hint)) {
        if (holds(hint + 1)) {
            ++hint;
        } else {
            const auto after =
                std::upper_bound(rows_.begin(), rows_.end(), t,
                                 [](double time, const MotionRow& row) { return time < row.t; });
            hint = std::min(static_cast<std::size_t>(after - rows_.begin()) - 1, last);
        }
    }
    const MotionRow& from = rows_[hint];
    const MotionRow& to = rows_[hint + 1];
    const double span = to.t - from.t;
    MotionSample result{.velocity = (to.position - from.position) / span,
                        .angular_velocity = turn_[hint] / span};
    if (t == to.t) {  // only in the last segment; gives the row without rounding
        result.position = to.position;
        result.orientation = to.orientation;
        return result;
    }
    const double share = (t - from.t) / span;
    result.position = from.position + share * (to.position - from.position);
    result.orientation = rotation(share * turn_[hint]) * from.orientation;
    return result;
}

namespace {

/// Throws unless the row has as many columns as those before it; 0: it is the first one.
void require_columns(std::size_t has, std::size_t columns, const std::string& where) {
    if ((has == 4 || has == 8) && (columns == 0 || has == columns)) return;
    const std::string expected =
        columns == 0 ? "t,x,y,z or t,x,y,z,qw,qx,qy,qz" : std::to_string(columns) + " columns, as above";
    throw std::runtime_error(where + std::to_string(has) + (has == 1 ? " column; give " : " columns; give ") +
                             expected);
}

/// `where`: of the row, for errors.
MotionRow parse_row(const std::vector<std::string_view>& fields, const std::vector<MotionRow>& before,
                    const std::string& where) {
    std::array<double, 8> values = {0, 0, 0, 0, 1, 0, 0, 0};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string column = where + "column " + std::to_string(i + 1) + " (" +
                                   std::string(column_names[i]) + "): \"" + words::printable(fields[i], 40) +
                                   "\" ";
        if (!parse_number(fields[i], values[i]))
            throw std::runtime_error(column + "is not a number; write seconds and metres, such as 0.25");
        if (!std::isfinite(values[i]))
            throw std::runtime_error(column + "is not finite; leave the row out or interpolate it");
        if (i < 4 && std::abs(values[i]) > (i == 0 ? latest_time : farthest_place))
            throw std::runtime_error(column + (i == 0 ? "is beyond 1e9 s; let the times begin at 0"
                                                      : "is beyond 1e6 m; write metres"));
        if (i == 0 && !before.empty() && !(values[0] > before.back().t))
            throw std::runtime_error(column +
                                     "is not after the row before; sort the rows by time, each once");
        if (i == 0 && !before.empty() && !(values[0] - before.back().t >= least_step))
            throw std::runtime_error(column +
                                     "is less than 1 ns after the row before; leave one of them out");
    }
    const Eigen::Quaterniond orientation(values[4], values[5], values[6], values[7]);
    if (!(orientation.norm() > shortest_quaternion))
        throw std::runtime_error(where + "column 5 (qw): the quaternion has no length; no turn is 1,0,0,0");
    if (!has_length(orientation))
        throw std::runtime_error(where +
                                 "column 5 (qw): the quaternion is longer than 1e6; divide it by its length");
    return {.t = values[0], .position = {values[1], values[2], values[3]}, .orientation = orientation};
}

}  // namespace

Motion parse_motion(std::string_view text, const std::string& name) {
    std::vector<MotionRow> rows;
    std::size_t columns = 0;  // 4 or 8, as in the first row
    std::size_t number = 0;
    bool first = true;
    while (!text.empty()) {
        ++number;
        const auto newline = text.find('\n');
        const std::string_view line = trimmed(text.substr(0, newline));
        text.remove_prefix(newline == std::string_view::npos ? text.size() : newline + 1);
        if (line.empty() || line.starts_with('#')) {
            continue;
        }
        const std::vector<std::string_view> fields = split(line);
        const std::string where = name + ":" + std::to_string(number) + ": ";
        const bool header = first && is_header(fields);
        first = false;
        require_columns(fields.size(), columns, where);
        columns = fields.size();
        if (header) {
            continue;
        }
        rows.push_back(parse_row(fields, rows, where));
    }
    if (rows.empty()) {
        throw std::runtime_error(name + ":" + std::to_string(std::max<std::size_t>(number, 1)) +
                                 ": no rows; give lines of t,x,y,z (s, m), at least one");
    }
    return Motion(std::move(rows), columns == 8);
}

Motion load_motion(const std::string& path) {
    constexpr const char* remedy = "; name a CSV file of t,x,y,z[,qw,qx,qy,qz]";
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        throw std::runtime_error(path + ": cannot read the motion: it is a folder" + remedy);
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw std::runtime_error(path + ": cannot read the motion: " + std::strerror(errno) + remedy);
    }
    std::ostringstream text;
    text << file.rdbuf();
    return parse_motion(text.str(), path);
}

std::optional<std::string> unit_doubt(const Motion& motion) {
    constexpr double reach = 2;  // m
    double farthest = 0;
    for (const MotionRow& row : motion.rows())
        farthest = std::max(farthest, row.position.lpNorm<Eigen::Infinity>());
    if (!(farthest > reach)) return std::nullopt;
    std::ostringstream text;
    text << "the motion goes " << farthest << " m far, but a hand reaches " << reach
         << " m: places are in metres; if these are mm, divide them by 1000";
    return text.str();
}

}  // namespace knurl::drivers
