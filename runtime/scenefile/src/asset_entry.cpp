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

}  // namespace

std::span<const KeyInfo> asset_keys() noexcept {
    return keys;
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): a table's keys, one after the other
AssetEntry read_asset(const std::string& path, std::size_t number, const toml::table& table) {
    const std::string called = fmt::format("asset {}", number);
    AssetEntry asset;
    asset.line = table.source().begin.line;
    bool spaced = false;
    const Value* of_mesh = nullptr;     // the last key that only a mesh has
    const Value* of_file = nullptr;     // ... only an asset from a file
    const Value* of_heights = nullptr;  // ... only a height field
    const Value* exact = nullptr;       // the key `exact`, of both kinds of mesh
    const auto values = values_of(table);
    for (const Value& value : values) {
        const std::string what = fmt::format("{} of {}", value.key, called);
        if (value.key == "mesh") {
            asset.mesh = word(path, value, what);
            if (asset.mesh.empty()) fail(path, value.at, what + " is empty; give the path of a mesh");
            of_file = &value;
        } else if (value.key == "unit") {
            asset.unit = word(path, value, what);
            of_file = &value;
        } else if (value.key == "inside") {
            asset.inside = boolean(path, value, what);
            of_file = &value;
        } else if (value.key == "vertices") {
            const auto parts = points(path, value, what, "m", 3, std::numeric_limits<std::uint32_t>::max());
            for (std::size_t i = 0; i < parts.size(); i += 3)
                asset.vertices.push_back({parts[i], parts[i + 1], parts[i + 2]});
            of_mesh = &value;
        } else if (value.key == "triangles") {
            asset.triangles = triangles(path, value, what);
            of_mesh = &value;
        } else if (value.key == "exact") {
            asset.exact = boolean(path, value, what);
            exact = &value;
        } else if (value.key == "heights") {
            read_heights(path, value, what, asset);
            of_heights = &value;
        } else if (value.key == "spacing") {
            const auto d = numbers(path, value, what, "m", 2);
            if (!(d[0] > 0 && d[1] > 0 && std::isfinite(d[0]) && std::isfinite(d[1])))
                fail(path, value.at, what + " must be above 0 m, and finite");
            asset.grid.dx = d[0];
            asset.grid.dy = d[1];
            spaced = true;
            of_heights = &value;
        } else if (value.key == "corner") {
            asset.grid.corner = to_eigen(vector(path, value, what, "m"));
            of_heights = &value;
        } else {
            std::vector<std::string_view> known;
            for (const KeyInfo& key : keys) known.push_back(key.name);
            fail_unknown_key(path, value, called, known);
        }
    }
    const int forms = (of_file != nullptr) + (of_mesh != nullptr) + (of_heights != nullptr);
    const bool whole = of_file != nullptr   ? !asset.mesh.empty()
                       : of_mesh != nullptr ? !asset.vertices.empty() && !asset.triangles.empty()
                                            : !asset.heights.empty() && spaced;
    if (forms == 1 && whole && of_heights != nullptr && exact != nullptr)
        fail(path, exact->at, fmt::format("exact of {}: a mesh has it, heights are always so", called));
    if (forms == 1 && whole) return asset;
    fail(
        path, table.source().begin,
        fmt::format("{} must be one of: a mesh = \"FILE\" with its unit; vertices and triangles; heights and "
                    "their spacing",
                    called));
}

}  // namespace knurl::scenefile
