#pragma once
// Elevation models as files: 16-bit PNG, PGM (P2, P5) and ESRI ASCII grids, distinguished by their first
// bytes.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace surface {

struct ElevationModel {
    int rows = 0, columns = 0;
    std::vector<double> counts = {};  // as the file has them, row by row from the north
    // The file's scale; absent: not stated.
    std::optional<double> metres_per_count = {}, metres_per_cell = {};
    std::string scale_source = {};        // where the scale comes from, for people
    std::string name = {};                // the file's name without its folder
    std::vector<std::string> notes = {};  // what was read differently from the file; one line each
};

inline constexpr int smallest_side = 4;     // samples: a bicubic patch
inline constexpr int largest_side = 16384;  // samples

/// Throws std::runtime_error: file, what is wrong and where in it, what to do.
ElevationModel load_elevation(const std::filesystem::path& file);

/// The same from a file's bytes. `name` begins its errors.
ElevationModel read_elevation(std::string_view bytes, const std::string& name);

/// One reader per format, from a file's bytes. `name` begins their errors.
ElevationModel read_png(std::string_view bytes, const std::string& name);
ElevationModel read_pgm(std::string_view bytes, const std::string& name);
ElevationModel read_esri_grid(std::string_view bytes, const std::string& name);
/// Tests the bytes only.
bool is_esri_grid(std::string_view bytes);

/// Throws unless rows and columns are within the bounds above.
void check_sides(const std::string& name, long rows, long columns);
/// Throws if 16-bit samples are noise as they are, but smooth with swapped bytes.
void check_byte_order(const ElevationModel& model, const std::string& name);
/// With swapped bytes, is no sample above `greatest`?
bool fits_swapped(const ElevationModel& model, double greatest);

/// "NAME: row R, column C WHAT", from 1; of the `index`th height.
std::runtime_error cell_error(const std::string& name, std::size_t index, int columns,
                              const std::string& what);
/// The text of cell_error() for a cell without a height; `text` is its content.
std::string no_height(std::string_view text);
std::runtime_error too_short(const std::string& name, std::size_t got, std::size_t wanted);

/// A number, possibly with a decimal comma, as some programs write by their locale. None: no number.
std::optional<double> number_with_comma(std::string_view word);

/// PNG text keys by which a model states its scale (scripts/dem_to_png.py writes them).
inline constexpr const char* key_metres_per_count = "knurl:metres_per_count";
inline constexpr const char* key_metres_per_cell = "knurl:metres_per_cell";

}  // namespace surface
