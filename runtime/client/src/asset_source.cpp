#include "asset_source.hpp"

#include <cmath>
#include <cstring>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::detail {

namespace {

[[noreturn]] void bad(const std::string& text) {
    throw Error(Error::Kind::bad_parameters, "send: " + text);
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
    try {
        shm::Segment memory = shm::Segment::create("knurl-source", layout->total);
        const auto put = [&](std::uint64_t at, const void* from, std::size_t bytes) {
            if (bytes > 0) std::memcpy(memory.data() + at, from, bytes);
        };
        put(0, &header, sizeof header);
        if (options.scale == 1) {
            put(layout->vertices, mesh.vertices.data(), mesh.vertices.size_bytes());
        } else {
            auto* to = reinterpret_cast<double*>(memory.data() + layout->vertices);
            for (const Point3& vertex : mesh.vertices)
                for (const double x : vertex) *to++ = options.scale * x;
        }
        put(layout->materials, options.materials.data(), options.materials.size() * sizeof(AssetMaterial));
        put(layout->triangles, mesh.triangles.data(), mesh.triangles.size_bytes());
        put(layout->triangle_materials, mesh.materials.data(), mesh.materials.size());
        return {.memory = shm::Segment::seal(std::move(memory)), .bytes = layout->total};
    } catch (const std::runtime_error& error) {
        throw Error(Error::Kind::refused, detail::format("send: no memory for the mesh ({})", error.what()));
    }
}

}  // namespace knurl::detail
