#include "asset_source.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::detail {

namespace {

[[noreturn]] void bad(const std::string& text) {
    throw Error(Error::Kind::bad_parameters, "send: " + text);
}

/// Memory of so many bytes, written by `fill`.
AssetMemory sealed(std::uint64_t bytes, const std::function<void(std::byte*)>& fill) {
    try {
        shm::Segment memory = shm::Segment::create("knurl-source", bytes);
        fill(memory.data());
        return {.memory = shm::Segment::seal(std::move(memory)), .bytes = bytes};
    } catch (const std::runtime_error& error) {
        throw Error(Error::Kind::refused, detail::format("send: no memory for the shape ({})", error.what()));
    }
}

bool is_height(double z) {
    return std::abs(z) < 1e7;  // m; the builder refuses larger values and names them
}

double middle_of(std::span<const double> heights) {
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const double z : heights)
        if (is_height(z)) least = std::min(least, z), most = std::max(most, z);
    return least <= most ? (least + most) / 2 : 0;
}

float as_float(double z) {
    return is_height(z) ? static_cast<float>(z) : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

AssetMemory source_of(const Triangles& mesh, const SendOptions& options) {
    if (!(options.scale > 0 && std::isfinite(options.scale)))
        bad(detail::format("scale = {}; give metres per unit of the vertices, above 0", options.scale));
    if (options.materials.size() > protocol::max_asset_materials)
        bad(detail::format("{} materials; at most {}", options.materials.size(),
                           protocol::max_asset_materials));
    if (!mesh.materials.empty() && mesh.materials.size() != mesh.triangles.size())
        bad(detail::format("{} triangles with {} materials; give one for each, or none",
                           mesh.triangles.size(), mesh.materials.size()));
    protocol::AssetSource header;
    header.vertices = mesh.vertices.size();
    header.triangles = mesh.triangles.size();
    header.materials = static_cast<std::uint32_t>(options.materials.size());
    header.weld = options.weld;
    if (options.exact) header.flags |= protocol::AssetSource::exact;
    if (!mesh.materials.empty()) header.flags |= protocol::AssetSource::materials_of_triangles;
    if (!options.find_crossings) header.flags |= protocol::AssetSource::no_crossings;
    const auto layout = protocol::layout_of(header);
    if (!layout || layout->total > protocol::max_asset_bytes)
        bad(detail::format("{} vertices and {} triangles are {} bytes; a claim may hold {}: send fewer",
                           header.vertices, header.triangles, layout ? layout->total : 0,
                           protocol::max_asset_bytes));
    return sealed(layout->total, [&](std::byte* to) {
        const auto put = [&](std::uint64_t at, const void* from, std::size_t bytes) {
            if (bytes > 0) std::memcpy(to + at, from, bytes);
        };
        put(0, &header, sizeof header);
        if (options.scale == 1) {
            put(layout->vertices, mesh.vertices.data(), mesh.vertices.size_bytes());
        } else {
            auto* x_to = reinterpret_cast<double*>(to + layout->vertices);
            for (const Point3& vertex : mesh.vertices)
                for (const double x : vertex) *x_to++ = options.scale * x;
        }
        put(layout->materials, options.materials.data(), options.materials.size() * sizeof(AssetMaterial));
        put(layout->triangles, mesh.triangles.data(), mesh.triangles.size_bytes());
        put(layout->triangle_materials, mesh.materials.data(), mesh.materials.size());
    });
}

AssetMemory source_of(const Heights& field) {
    const HeightGrid& grid = field.grid;
    const std::size_t given = std::visit([](const auto& heights) { return heights.size(); }, field.heights);
    if (given != std::uint64_t{grid.columns} * grid.rows)
        bad(detail::format("{} columns and {} rows with {} heights; give one for each", grid.columns,
                           grid.rows, given));
    protocol::HeightSource header{.columns = grid.columns,
                                  .rows = grid.rows,
                                  .dx = grid.dx,
                                  .dy = grid.dy,
                                  .corner = {grid.corner.x(), grid.corner.y(), grid.corner.z()},
                                  .material = field.material};
    const auto bytes = protocol::bytes_of(header);
    if (!bytes || *bytes > protocol::max_asset_bytes)
        bad(detail::format("{} by {} heights are {} bytes; a claim may hold {}: send fewer", grid.columns,
                           grid.rows, bytes.value_or(0), protocol::max_asset_bytes));
    const auto* precise = std::get_if<std::span<const double>>(&field.heights);
    const double middle = precise != nullptr ? middle_of(*precise) : 0;
    header.corner[2] += middle;
    return sealed(*bytes, [&](std::byte* to) {
        std::memcpy(to, &header, sizeof header);
        std::visit(
            [&](const auto& heights) {
                auto* z_to = reinterpret_cast<float*>(to + sizeof header);
                for (const auto z : heights) *z_to++ = as_float(z - middle);
            },
            field.heights);
    });
}

}  // namespace knurl::detail
