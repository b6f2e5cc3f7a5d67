#pragma once
// The raw content of a mesh file: polygons with any number of corners.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/geometry/triangles.hpp>

namespace knurl::meshfile {

struct Soup {
    struct Polygon {
        std::uint32_t corners = 0;  // number in Soup::corners, after those of the previous polygon
        std::uint32_t place = 0;    // the line in a text, else the number of the face, from 1
        std::uint8_t material = 0;
    };

    std::string path, format;
    bool text = false;  // places are lines
    std::vector<knurl::Point3> vertices;
    std::vector<std::uint32_t> corners;
    std::vector<Polygon> polygons;
    std::vector<std::string> material_names;
    std::uint64_t points_and_lines = 0;  // skipped
    std::vector<std::string> notes;      // for people, one line each
};

inline constexpr std::size_t most_materials = 256;

/// Throws std::runtime_error: "PATH: what; what to do".
[[noreturn]] void bad(const std::string& path, const std::string& text);
/// The same at a line of a text, or at a face: "PATH:LINE: ...", "PATH: face N: ...".
[[noreturn]] void bad_at(const Soup& soup, std::uint64_t place, const std::string& text);

/// One reader per format, from the file's bytes. Each reads the whole file correctly or throws, with the
/// place.
Soup read_stl(std::string_view bytes, const std::string& path);
Soup read_obj(std::string_view bytes, const std::string& path);
Soup read_ply(std::string_view bytes, const std::string& path);
/// Tests the bytes only.
bool is_ply(std::string_view bytes);
bool is_stl(std::string_view bytes);

/// Other formats, by Assimp: in a separate process with limited time and memory.
struct ReadLimits {
    int seconds = 30;
    std::uint64_t bytes = std::uint64_t{4} << 30;
};
Soup read_by_assimp(const std::string& path, const ReadLimits& limits = {});

}  // namespace knurl::meshfile
