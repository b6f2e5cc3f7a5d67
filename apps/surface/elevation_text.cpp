// PGM and ESRI ASCII grids.

#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "elevation.hpp"

namespace surface {
namespace {

constexpr std::string_view blank = " \t\r\n\f\v";
constexpr double metres_per_degree = 111195;  // of latitude, mean sphere (6371 km)

/// Words of a text, one after the other; empty at its end.
struct Words {
    std::string_view rest;
    bool comments = false;  // PGM: from # to the end of the line

    std::string_view next() {
        for (;;) {
            const auto begin = rest.find_first_not_of(blank);
            if (begin == std::string_view::npos) return rest = {};
            rest.remove_prefix(begin);
            if (!comments || rest.front() != '#') break;
            const auto line = rest.find_first_of("\r\n");
            if (line == std::string_view::npos) return rest = {};
            rest.remove_prefix(line);
        }
        const auto end = std::min(rest.find_first_of(blank), rest.size());
        const auto word = rest.substr(0, end);
        rest.remove_prefix(end);
        return word;
    }
};

std::optional<double> number(std::string_view word) {
    double value = 0;
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

std::optional<long> whole(std::string_view word) {
    const auto value = number(word);
    if (!value || *value != std::floor(*value) || std::abs(*value) > 1e9) return std::nullopt;
    return static_cast<long>(*value);
}

std::runtime_error cell_error(const std::string& name, std::size_t index, int columns,
                              const std::string& what) {
    const auto width = static_cast<std::size_t>(columns);
    return std::runtime_error(
        fmt::format("{}: row {}, column {} {}", name, index / width + 1, index % width + 1, what));
}

std::runtime_error too_short(const std::string& name, std::size_t got, std::size_t wanted) {
    return std::runtime_error(fmt::format(
        "{}: is truncated: {} of {} heights are there; write or fetch it again", name, got, wanted));
}

std::string lower(std::string_view word) {
    std::string out(word);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

}  // namespace

ElevationModel read_pgm(std::string_view bytes, const std::string& name) {
    Words words{.rest = bytes.substr(2), .comments = true};
    const auto columns = whole(words.next()), rows = whole(words.next()), greatest = whole(words.next());
    if (!columns || !rows || !greatest)
        throw std::runtime_error(name +
                                 ": this PGM's header is no width, height and largest value; write it again");
    check_sides(name, *rows, *columns);
    if (*greatest < 256 || *greatest > 65535)
        throw std::runtime_error(
            fmt::format("{}: this PGM's largest value is {}: 8 bits would be felt as stairs; "
                        "export it with 16 bits (256 to 65535)",
                        name, *greatest));

    ElevationModel model{.rows = static_cast<int>(*rows), .columns = static_cast<int>(*columns)};
    const auto wanted = static_cast<std::size_t>(*rows) * static_cast<std::size_t>(*columns);
    model.counts.reserve(wanted);
    if (bytes[1] == '5') {
        if (words.rest.empty()) throw too_short(name, 0, wanted);
        const auto data = words.rest.substr(1);  // one blank ends the header
        if (data.size() < 2 * wanted) throw too_short(name, data.size() / 2, wanted);
        for (std::size_t i = 0; i < wanted; ++i)
            model.counts.push_back(static_cast<unsigned char>(data[2 * i]) * 256 +
                                   static_cast<unsigned char>(data[2 * i + 1]));
    } else {
        for (std::size_t i = 0; i < wanted; ++i) {
            const auto word = words.next();
            if (word.empty()) throw too_short(name, i, wanted);
            const auto value = whole(word);
            if (!value || *value < 0 || *value > *greatest)
                throw cell_error(name, i, model.columns,
                                 fmt::format("is \"{}\", not a whole number from 0 to {}; mend that cell",
                                             word, *greatest));
            model.counts.push_back(static_cast<double>(*value));
        }
    }
    return model;
}

ElevationModel read_esri_grid(std::string_view bytes, const std::string& name) {
    Words words{.rest = bytes};
    std::optional<long> columns, rows;
    std::optional<double> cell, nodata;
    double south = 0;
    for (;;) {
        const Words before = words;
        const std::string key = lower(words.next());
        if (key.empty() || key[0] < 'a' || key[0] > 'z' || key == "nan" || key == "inf") {
            words = before;  // the first height
            break;
        }
        const auto word = words.next();
        const auto value = number(word);
        if (!value)
            throw std::runtime_error(
                fmt::format("{}: the header's {} is \"{}\", not a number; mend that line", name, key, word));
        if (key == "ncols")
            columns = whole(word);
        else if (key == "nrows")
            rows = whole(word);
        else if (key == "cellsize")
            cell = value;
        else if (key == "nodata_value")
            nodata = value;
        else if (key == "yllcorner" || key == "yllcenter")
            south = *value;
        else if (key != "xllcorner" && key != "xllcenter")
            throw std::runtime_error(
                fmt::format("{}: the header's \"{}\" is unknown; known are ncols, nrows, xllcorner, "
                            "yllcorner, cellsize, NODATA_value",
                            name, key));
    }
    if (!columns || !rows || !cell)
        throw std::runtime_error(
            name + ": the header lacks ncols, nrows or cellsize; an ESRI ASCII grid has all three");
    if (!(*cell > 0)) throw std::runtime_error(name + ": the header's cellsize must be above 0");
    check_sides(name, *rows, *columns);

    ElevationModel model{.rows = static_cast<int>(*rows), .columns = static_cast<int>(*columns)};
    const auto wanted = static_cast<std::size_t>(*rows) * static_cast<std::size_t>(*columns);
    model.counts.reserve(wanted);
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto word = words.next();
        if (word.empty()) throw too_short(name, i, wanted);
        const auto value = number(word);
        if (!value)
            throw cell_error(name, i, model.columns,
                             fmt::format("is \"{}\", not a number; mend that cell", word));
        if (!std::isfinite(*value) || (nodata && *value == *nodata))
            throw cell_error(name, i, model.columns,
                             "has no height (" + std::string(word) +
                                 "); fill the gaps first (gdal_fillnodata), or cut them off");
        model.counts.push_back(*value);
    }
    if (!words.next().empty())
        throw std::runtime_error(fmt::format(
            "{}: has more than the {} heights that nrows x ncols says; mend the header", name, wanted));
    model.metres_per_count = 1;
    if (*cell < 0.1 && std::abs(south) <= 90) {  // so fine a cell is in degrees, not in metres
        const double north = south + *cell * static_cast<double>(*rows);
        const double latitude = 0.5 * (south + north) * M_PI / 180;
        model.metres_per_cell = *cell * metres_per_degree * std::sqrt(std::cos(latitude));  // of equal area
        model.scale_source = "the grid's cellsize, taken as degrees";
    } else {
        model.metres_per_cell = cell;
        model.scale_source = "the grid's cellsize, taken as metres";
    }
    return model;
}

}  // namespace surface
