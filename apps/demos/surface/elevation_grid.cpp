// ESRI ASCII grids.

#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "elevation.hpp"
#include "elevation_words.hpp"

namespace surface {
namespace {

constexpr double metres_per_degree = 111195;  // of latitude, mean sphere (6371 km)
constexpr std::array known = {"ncols",    "nrows", "xllcorner", "xllcenter",    "yllcorner", "yllcenter",
                              "cellsize", "dx",    "dy",        "nodata_value", "nodata"};
/// What programs write for missing heights, if the header does not say.
constexpr std::array unstated = {-9999.0, -32768.0, -32767.0, -99999.0};
constexpr double beyond = 1e12;  // no height in any unit
constexpr std::array no_number = {"nan",  "-nan", "+nan", "null", "na", "n/a", "none", "nodata", "no_data",
                                  "void", "*",    "-",    "--",   "?",  "inf", "-inf", "+inf",   "nil"};

bool is_known(const std::string& key) {
    return std::find(known.begin(), known.end(), key) != known.end();
}
bool is_no_number(const std::string& word) {
    return std::find(no_number.begin(), no_number.end(), word) != no_number.end() ||
           word.find("#qnan") != word.npos || word.find("#ind") != word.npos ||
           word.find("#inf") != word.npos || word.starts_with("nan(") || word.starts_with("-nan(");
}

struct Header {
    std::map<std::string, std::string> words;  // of each key

    bool has(const std::string& key) const { return words.count(key) > 0; }
    /// None: the header does not have the key.
    std::optional<double> value(const std::string& name, const std::string& key) const {
        const auto found = words.find(key);
        if (found == words.end()) return std::nullopt;
        const auto value = number_with_comma(found->second);
        if (!value || !std::isfinite(*value))
            throw std::runtime_error(
                fmt::format("{}: the header's {} is \"{}\", not a number; mend that line", name, key,
                            shown(found->second)));
        return value;
    }
    long side(const std::string& name, const std::string& key) const {
        if (!has(key))
            throw std::runtime_error(
                name + ": the header lacks ncols, nrows or cellsize; an ESRI ASCII grid has all three");
        const auto side = whole(words.at(key));
        if (!side)
            throw std::runtime_error(
                fmt::format("{}: the header's {} is \"{}\", not a whole number; mend that line", name, key,
                            shown(words.at(key))));
        return *side;
    }
};

void skip_line(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
}

/// Reads the header: keys and their values in any order, up to the first height.
Header take_header(Words& words, const std::string& name) {
    Header header;
    for (;;) {
        const Words before = words;
        const std::string key = lower(words.next().substr(0, 40));
        if (key.starts_with("//") || key.starts_with(';') || key.starts_with('!')) {
            skip_line(words.rest);
            continue;
        }
        if (!is_known(key)) {
            if (!key.empty() && key.front() >= 'a' && key.front() <= 'z' && !is_no_number(key))
                throw std::runtime_error(
                    fmt::format("{}: the header's \"{}\" is unknown; known are ncols, nrows, xllcorner, "
                                "yllcorner, cellsize, dx, dy, NODATA_value",
                                name, shown(key)));
            words = before;
            return header;
        }
        const std::string canonical = key == "nodata" ? "nodata_value" : key;
        if (header.has(canonical))
            throw std::runtime_error(
                fmt::format("{}: the header says {} twice; leave one of them", name, key));
        header.words[canonical] = lower(words.next().substr(0, 40));
    }
}

/// The side of a cell. The format also allows cells that are not square, which are refused.
double cell_of(const Header& header, const std::string& name) {
    auto cell = header.value(name, "cellsize");
    const auto dx = header.value(name, "dx"), dy = header.value(name, "dy");
    if (dx.has_value() != dy.has_value() || (cell && dx))
        throw std::runtime_error(name + ": the header must say cellsize, or dx and dy; mend it");
    if (dx) {
        if (!(std::abs(*dx - *dy) <= 1e-4 * std::abs(*dx)))
            throw std::runtime_error(fmt::format(
                "{}: cells of dx = {:g} by dy = {:g} are no squares; make them so (gdalwarp -tr {:g} {:g})",
                name, *dx, *dy, *dx, *dx));
        cell = dx;
    }
    if (!cell)
        throw std::runtime_error(
            name + ": the header lacks ncols, nrows or cellsize; an ESRI ASCII grid has all three");
    if (!(*cell > 0)) throw std::runtime_error(name + ": the header's cellsize must be above 0");
    return *cell;
}

/// The values that mean "no height" in this grid.
class Gaps {
  public:
    Gaps(const Header& header) {
        const auto found = header.words.find("nodata_value");
        if (found == header.words.end()) return;
        stated_ = true;
        word_ = found->second;
        value_ = number_with_comma(word_);
    }
    bool is_gap(double value) const {
        if (!std::isfinite(value) || std::abs(value) > beyond) return true;
        // Header and cells may round the value of a gap differently.
        if (value_) return std::abs(value - *value_) <= 1e-5 * std::abs(*value_);
        return !stated_ && is_usual(value);
    }
    /// Programs write it for a missing height, if they state no other.
    static bool is_usual(double value) {
        return std::find(unstated.begin(), unstated.end(), value) != unstated.end();
    }
    bool is_gap(const std::string& word) const { return (stated_ && word == word_) || is_no_number(word); }

  private:
    bool stated_ = false;
    std::string word_;
    std::optional<double> value_;
};

/// Values that usually mean "no height", although the header states another or none: merged grids may contain
/// them. One of them is a height if others are close to it.
class UsualGaps {
  public:
    void take(std::size_t index, double value) {
        if (!Gaps::is_usual(value))
            lowest_ = std::min(lowest_, value);
        else if (!first_)
            first_ = index;
    }
    /// The first of them, if it lies far below all other heights.
    std::optional<std::size_t> gap(const std::vector<double>& heights) const {
        if (!first_ || !std::isfinite(lowest_)) return std::nullopt;
        const double value = heights[*first_];
        return lowest_ - value > -0.5 * value ? first_ : std::nullopt;
    }

  private:
    std::optional<std::size_t> first_;
    double lowest_ = INFINITY;  // over all other heights
};

/// How many cells have a decimal comma, how many a point.
struct DecimalSigns {
    std::size_t commas = 0, points = 0;

    void take(std::string_view word) {
        commas += word.find(',') != word.npos;
        points += word.find('.') != word.npos;
    }
    bool mixed() const { return commas > 0 && points > 0; }
};

/// A cell as a number, which is no gap.
double height_of(std::string_view word, std::size_t index, const Gaps& gaps, const ElevationModel& model,
                 const std::string& name) {
    const auto value = number_with_comma(word);
    if (value ? gaps.is_gap(*value) : gaps.is_gap(lower(shown(word))))
        throw cell_error(name, index, model.columns, no_height(word));
    if (!value)
        throw cell_error(name, index, model.columns,
                         fmt::format("is \"{}\", not a number; mend that cell", shown(word)));
    return *value;
}

/// Reads all heights that follow the header.
void read_heights(Words& words, const Gaps& gaps, ElevationModel& model, const std::string& name) {
    const auto wanted = static_cast<std::size_t>(model.rows) * static_cast<std::size_t>(model.columns);
    model.counts.reserve(std::min(wanted, words.rest.size()));
    DecimalSigns signs;
    UsualGaps usual;
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto word = words.next();
        if (word.empty()) throw too_short(name, i, wanted);
        const double height = height_of(word, i, gaps, model, name);
        signs.take(word);
        if (signs.mixed())
            throw cell_error(name, i, model.columns,
                             fmt::format("is \"{}\", but others have a decimal {}; write all with points",
                                         word, word.find(',') != word.npos ? "point" : "comma"));
        usual.take(i, height);
        model.counts.push_back(height);
    }
    if (const auto gap = usual.gap(model.counts))
        throw cell_error(name, *gap, model.columns, no_height(fmt::format("{:g}", model.counts[*gap])));
    if (!words.next().empty())
        throw std::runtime_error(fmt::format(
            "{}: has more than the {} heights that nrows x ncols says; mend the header", name, wanted));
    if (signs.commas > 0)
        model.notes.push_back(fmt::format("{} heights have a decimal comma; read as a point", signs.commas));
}

/// Detects swapped numbers of rows and columns, which would skew the heights.
void check_lines(std::string_view text, const ElevationModel& model, const std::string& name) {
    if (model.rows == model.columns) return;
    long lines = 0;
    while (!text.empty()) {
        const auto end = std::min(text.find_first_of("\r\n"), text.size());
        Words words{.rest = text.substr(0, end), .comments = true};
        text.remove_prefix(std::min(end + 1, text.size()));
        long n = 0;
        while (!words.next().empty()) ++n;
        if (n == 0) continue;
        if (n != model.rows) return;
        ++lines;
    }
    if (lines == model.columns)
        throw std::runtime_error(fmt::format(
            "{}: ncols is {} and nrows {}, but there are {} lines of {} heights; swap the two in the header",
            name, model.columns, model.rows, lines, model.rows));
}

/// Mean difference between neighbouring heights, relative to the cell's side.
double mean_slope(const ElevationModel& model, double cell) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < model.counts.size(); ++i)
        sum += std::abs(model.counts[i + 1] - model.counts[i]);
    return sum / static_cast<double>(model.counts.size()) / cell;
}

/// Is the small cell size in degrees? Then the heights, which are in metres, rise by thousands per unit. A
/// grid that begins at (0, 0) or surrounds it is a local one, in any unit.
bool in_degrees(const ElevationModel& model, double cell, double west, double south) {
    constexpr double finest = 0.1, steepest = 10;
    if (cell >= finest || std::abs(south) > 90 || std::abs(west) > 360) return false;
    const auto local = [&](double low, int count) {
        return std::abs(low) <= cell || std::abs(low + 0.5 * count * cell) <= 2 * cell;
    };
    if (local(west, model.columns) && local(south, model.rows)) return false;
    return mean_slope(model, cell) > steepest;
}

/// The cells are squares whose side is metres or degrees; heights are metres.
void set_scale(const Header& header, double cell, ElevationModel& model, const std::string& name) {
    const auto first_of = [&](const char* one, const char* other) {
        const auto value = header.value(name, one);
        return (value ? value : header.value(name, other)).value_or(0);
    };
    const double west = first_of("xllcorner", "xllcenter"), south = first_of("yllcorner", "yllcenter");
    model.metres_per_count = 1;
    if (in_degrees(model, cell, west, south)) {
        const double north = south + cell * static_cast<double>(model.rows);
        const double latitude = 0.5 * (south + north) * M_PI / 180;
        model.metres_per_cell = cell * metres_per_degree * std::sqrt(std::cos(latitude));  // for equal area
        model.scale_source = "the grid's cellsize, taken as degrees";
        model.notes.push_back(
            fmt::format("the cellsize of {:g} is taken as degrees, the heights as metres", cell));
    } else {
        model.metres_per_cell = cell;
        model.scale_source = "the grid's cellsize, taken as metres";
        if (cell < 0.1)
            model.notes.push_back(
                fmt::format("the cellsize of {:g} is taken as of the heights' unit, not as degrees", cell));
    }
}

}  // namespace

bool is_esri_grid(std::string_view bytes) {
    Words words{.rest = bytes.substr(0, 100'000), .comments = true};
    for (;;) {
        const std::string key = lower(words.next().substr(0, 40));
        if (key.starts_with("//") || key.starts_with(';') || key.starts_with('!')) {
            skip_line(words.rest);
            continue;
        }
        return is_known(key) || (key.starts_with("nc") && key.size() < 12);
    }
}

ElevationModel read_esri_grid(std::string_view bytes, const std::string& name) {
    Words words{.rest = bytes, .comments = true};
    const Header header = take_header(words, name);
    const long columns = header.side(name, "ncols"), rows = header.side(name, "nrows");
    const double cell = cell_of(header, name);
    check_sides(name, rows, columns);

    ElevationModel model{.rows = static_cast<int>(rows), .columns = static_cast<int>(columns)};
    const std::string_view cells = words.rest;
    read_heights(words, Gaps(header), model, name);
    check_lines(cells, model, name);
    set_scale(header, cell, model, name);
    return model;
}

}  // namespace surface
