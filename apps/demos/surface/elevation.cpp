#include "elevation.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "elevation_words.hpp"

namespace surface {

void check_sides(const std::string& name, long rows, long columns) {
    if (rows < smallest_side || columns < smallest_side)
        throw std::runtime_error(
            fmt::format("{}: {} row{} of {} sample{}: a surface needs at least {} x {}; give a "
                        "larger cut of the model",
                        name, rows, rows == 1 ? "" : "s", columns, columns == 1 ? "" : "s", smallest_side,
                        smallest_side));
    if (rows > largest_side || columns > largest_side)
        throw std::runtime_error(
            fmt::format("{}: {} x {} samples: at most {} x {} are read; cut out the part that "
                        "is to be felt",
                        name, rows, columns, largest_side, largest_side));
}

std::runtime_error cell_error(const std::string& name, std::size_t index, int columns,
                              const std::string& what) {
    const auto width = static_cast<std::size_t>(columns);
    return std::runtime_error(
        fmt::format("{}: row {}, column {} {}", name, index / width + 1, index % width + 1, what));
}

std::string no_height(std::string_view text) {
    return fmt::format("has no height ({}); fill the gaps first (gdal_fillnodata), or cut them off",
                       shown(text));
}

std::runtime_error too_short(const std::string& name, std::size_t got, std::size_t wanted) {
    return std::runtime_error(fmt::format(
        "{}: is truncated: {} of {} heights are there; write or fetch it again", name, got, wanted));
}

std::optional<double> number_with_comma(std::string_view word) {
    const auto comma = word.find(',');
    if (comma == word.npos) return number(word);
    if (word.find('.') != word.npos || comma == 0 || comma + 1 == word.size()) return std::nullopt;
    std::string point(word);
    point[comma] = '.';
    return number(point);
}

namespace {

double swapped(double count) {
    const auto bits = static_cast<unsigned>(count);
    return static_cast<double>((bits & 255) << 8 | bits >> 8);
}

}  // namespace

bool fits_swapped(const ElevationModel& model, double greatest) {
    return std::all_of(model.counts.begin(), model.counts.end(),
                       [&](double count) { return swapped(count) <= greatest; });
}

void check_byte_order(const ElevationModel& model, const std::string& name) {
    constexpr std::size_t fewest = 64;
    if (model.counts.size() < fewest) return;
    // Mean step between neighbours in a row, relative to the range.
    const auto roughness = [&](auto value_of) {
        double sum = 0, low = value_of(model.counts[0]), high = low, last = low;
        int column = 0;
        for (const double count : model.counts) {
            const double value = value_of(count);
            if (column != 0) sum += std::abs(value - last);
            column = column + 1 < model.columns ? column + 1 : 0;
            low = std::min(low, value), high = std::max(high, value), last = value;
        }
        return high > low ? sum / static_cast<double>(model.counts.size()) / (high - low) : 0;
    };
    const double here = roughness([](double count) { return count; });
    if (here > 0.02 && roughness(swapped) < here / 8)
        throw std::runtime_error(fmt::format(
            "{}: its samples are noise as they stand and smooth with the bytes of each swapped: it was "
            "written little-endian, and the format is big-endian; swap them (dd conv=swab on the samples)",
            name));
}

ElevationModel load_elevation(const std::filesystem::path& file) {
    const std::string name = file.string();
    if (std::filesystem::is_directory(file))
        throw std::runtime_error(name + ": is a folder; name a 16-bit PNG, PGM or ESRI ASCII grid in it");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(name + ": cannot be opened; check the path and that you may read it");
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    ElevationModel model = read_elevation(bytes, name);
    model.name = file.filename().string();
    return model;
}

ElevationModel read_elevation(std::string_view bytes, const std::string& name) {
    if (bytes.empty()) throw std::runtime_error(name + ": is empty; write or fetch it again");

    const auto begins = [&](std::string_view magic) { return bytes.starts_with(magic); };
    std::string_view text = bytes;
    if (begins("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark, of UTF-8
    if (begins("\x89PNG")) return read_png(bytes, name);
    if (text.starts_with("P2") || text.starts_with("P5")) return read_pgm(text, name);
    if (begins("\xff\xfe") || begins("\xfe\xff"))
        throw std::runtime_error(name + ": is UTF-16 text; save it as plain text (ASCII or UTF-8)");
    if (is_esri_grid(text)) return read_esri_grid(text, name);
    throw std::runtime_error(name +
                             ": is no elevation model that is known here; give a 16-bit greyscale PNG, a "
                             "16-bit PGM (P2 or P5) or an ESRI ASCII grid (ncols ...)");
}

}  // namespace surface
