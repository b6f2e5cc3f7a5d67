// [[asset]]: a surface of which shapes are made. Parsed here; the player of the scene builds it.

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "entry.hpp"

namespace knurl::scenefile {

namespace {

constexpr KeyInfo keys[] = {
    {"mesh", "a path", "STL, OBJ or PLY, seen from the folder of the scene file"},
    {"unit", "`mm`, `cm`, `m`, `in`, `um`", "of the mesh's numbers"},
    {"inside", "true, false; false", "closed parts that are wound inside out stay so"},
    {"vertices", "m, a list of [x, y, z]", "in place of a file"},
    {"triangles", "a list of [a, b, c]", "of vertices from 0, counter-clockwise as seen from outside"},
    {"exact", "true, false; false", "of a mesh: its corners as double"},
    {"heights", "m, rows of numbers", "over a grid, row by row, x first"},
    {"spacing", "m, [dx, dy]", "from one height to the next"},
    {"corner", "m, [x, y, z]; the origin", "where the first height is, at height 0"},
};

/// The rows of an array of arrays.
std::vector<const toml::array*> rows_of(const std::string& path, const Value& value, const std::string& what,
                                        std::string_view example) {
    std::vector<const toml::array*> rows;
    const auto* array = value.node->as_array();
    for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
        rows.push_back((*array)[i].as_array());
        if (rows.back() != nullptr) continue;
        fail(path, (*array)[i].source().begin,
             fmt::format("row {} of {} must be an array, not {}; write {} = {}", i + 1, what,
                         type_name((*array)[i]), value.key, example));
    }
    if (rows.empty()) {
        fail(path, value.at,
             fmt::format("{} must be a list of rows, not {}; write {} = {}", what,
                         array != nullptr ? "an empty one" : type_name(*value.node), value.key, example));
    }
    return rows;
}

std::vector<Triangle> triangles(const std::string& path, const Value& value, const std::string& what) {
    std::vector<Triangle> out;
    for (const toml::array* row : rows_of(path, value, what, "[[0, 1, 2], ...]")) {
        Triangle corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto* number = row->size() == 3 ? (*row)[i].as_integer() : nullptr;
            if (number == nullptr || number->get() < 0 ||
                number->get() > std::numeric_limits<std::uint32_t>::max()) {
                fail(path, row->source().begin,
                     fmt::format(
                         "triangle {} of {} must be three numbers of vertices, from 0; write [0, 1, 2]",
                         out.size() + 1, what));
            }
            corners[i] = static_cast<std::uint32_t>(number->get());
        }
        out.push_back(corners);
    }
    return out;
}

void read_heights(const std::string& path, const Value& value, const std::string& what, AssetEntry& asset) {
    const auto rows = rows_of(path, value, what, "[[0, 0.001], [0, 0.002]]");
    asset.grid.rows = static_cast<std::uint32_t>(rows.size());
    asset.grid.columns = static_cast<std::uint32_t>(rows.front()->size());
    for (const toml::array* row : rows) {
        if (row->size() != rows.front()->size()) {
            fail(path, row->source().begin,
                 fmt::format("a row of {} has {} heights, the first has {}; give as many", what, row->size(),
                             rows.front()->size()));
        }
        for (const toml::node& each : *row) {
            const auto height = each.value<double>();
            if (!height || !std::isfinite(*height)) {
                fail(path, each.source().begin,
                     fmt::format("{} must be finite numbers in m, not {}", what, type_name(each)));
            }
            asset.heights.push_back(static_cast<float>(*height));
        }
    }
}

std::vector<Point3> vertices(const std::string& path, const Value& value, const std::string& what) {
    const auto parts = points(path, value, what, "m", 3, std::numeric_limits<std::uint32_t>::max());
    std::vector<Point3> out;
    for (std::size_t i = 0; i < parts.size(); i += 3) out.push_back({parts[i], parts[i + 1], parts[i + 2]});
    return out;
}

void read_spacing(const std::string& path, const Value& value, const std::string& what, HeightGrid& grid) {
    const auto d = numbers(path, value, what, "m", 2);
    if (!(d[0] > 0 && d[1] > 0 && std::isfinite(d[0]) && std::isfinite(d[1])))
        fail(path, value.at, what + " must be above 0 m, and finite");
    grid.dx = d[0];
    grid.dy = d[1];
}

/// Reads a key that only an asset from a file has. False: the key is another. The same for the next two.
bool read_key_of_file(const std::string& path, const Value& value, const std::string& what,
                      AssetEntry& asset) {
    if (value.key == "mesh") {
        asset.mesh = word(path, value, what);
        if (asset.mesh.empty()) fail(path, value.at, what + " is empty; give the path of a mesh");
    } else if (value.key == "unit") {
        asset.unit = word(path, value, what);
    } else if (value.key == "inside") {
        asset.inside = boolean(path, value, what);
    } else {
        return false;
    }
    return true;
}

/// ... only a mesh whose corners are in the scene file.
bool read_key_of_mesh(const std::string& path, const Value& value, const std::string& what,
                      AssetEntry& asset) {
    if (value.key == "vertices") {
        asset.vertices = vertices(path, value, what);
    } else if (value.key == "triangles") {
        asset.triangles = triangles(path, value, what);
    } else {
        return false;
    }
    return true;
}

/// ... only a height field.
bool read_key_of_heights(const std::string& path, const Value& value, const std::string& what,
                         AssetEntry& asset) {
    if (value.key == "heights") {
        read_heights(path, value, what, asset);
    } else if (value.key == "spacing") {
        read_spacing(path, value, what, asset.grid);
    } else if (value.key == "corner") {
        asset.grid.corner = to_eigen(vector(path, value, what, "m"));
    } else {
        return false;
    }
    return true;
}

std::vector<std::string_view> known_keys() {
    std::vector<std::string_view> known;
    for (const KeyInfo& key : keys) known.push_back(key.name);
    return known;
}

/// The forms of which an asset has keys.
struct Forms {
    bool file = false, mesh = false, heights = false;
};

/// It has keys of one form only, and those that this form needs.
bool is_whole(const AssetEntry& asset, const Forms& forms) {
    if (forms.file + forms.mesh + forms.heights != 1) return false;
    if (forms.file) return !asset.mesh.empty();
    if (forms.mesh) return !asset.vertices.empty() && !asset.triangles.empty();
    return !asset.heights.empty() && asset.grid.dx > 0;
}

}  // namespace

std::span<const KeyInfo> asset_keys() noexcept {
    return keys;
}

AssetEntry read_asset(const std::string& path, std::size_t number, const toml::table& table) {
    const std::string called = fmt::format("asset {}", number);
    AssetEntry asset;
    asset.line = table.source().begin.line;
    Forms forms;
    const Value* exact = nullptr;  // a key of both kinds of mesh
    const auto values = values_of(table);
    for (const Value& value : values) {
        const std::string what = fmt::format("{} of {}", value.key, called);
        if (read_key_of_file(path, value, what, asset)) {
            forms.file = true;
        } else if (read_key_of_mesh(path, value, what, asset)) {
            forms.mesh = true;
        } else if (read_key_of_heights(path, value, what, asset)) {
            forms.heights = true;
        } else if (value.key == "exact") {
            asset.exact = boolean(path, value, what);
            exact = &value;
        } else {
            fail_unknown_key(path, value, called, known_keys());
        }
    }
    if (!is_whole(asset, forms)) {
        fail(path, table.source().begin,
             fmt::format(
                 "{} must be one of: a mesh = \"FILE\" with its unit; vertices and triangles; heights and "
                 "their spacing",
                 called));
    }
    if (forms.heights && exact != nullptr)
        fail(path, exact->at, fmt::format("exact of {}: a mesh has it, heights are always so", called));
    return asset;
}

}  // namespace knurl::scenefile
