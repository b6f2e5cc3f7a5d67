#include "elevation.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

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

ElevationModel load_elevation(const std::filesystem::path& file) {
    const std::string name = file.string();
    if (std::filesystem::is_directory(file))
        throw std::runtime_error(name + ": is a folder; name a 16-bit PNG, PGM or ESRI ASCII grid in it");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(name + ": cannot be opened; check the path and that you may read it");
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    if (bytes.empty()) throw std::runtime_error(name + ": is empty; write or fetch it again");

    const auto begins = [&](std::string_view magic) { return std::string_view(bytes).starts_with(magic); };
    ElevationModel model;
    if (begins("\x89PNG"))
        model = read_png(bytes, name);
    else if (begins("P2") || begins("P5"))
        model = read_pgm(bytes, name);
    else if (const auto at = bytes.find_first_not_of(" \t\r\n");
             at != std::string::npos && (bytes[at] == 'n' || bytes[at] == 'N') && bytes.size() > at + 5 &&
             (bytes[at + 1] == 'c' || bytes[at + 1] == 'C' || bytes[at + 1] == 'r' || bytes[at + 1] == 'R'))
        model = read_esri_grid(bytes, name);  // begins with ncols or nrows
    else
        throw std::runtime_error(name +
                                 ": is no elevation model that is known here; give a 16-bit greyscale PNG, a "
                                 "16-bit PGM (P2 or P5) or an ESRI ASCII grid (ncols ...)");
    model.name = file.filename().string();
    return model;
}

}  // namespace surface
