#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/servo/asset_build.hpp>

namespace knurl::servo {

namespace {

using protocol::AssetHead;
using protocol::AssetSource;
using protocol::HeightSource;
using Bytes = std::span<const std::byte>;

[[noreturn]] void refuse(const std::string& text) {
    throw std::runtime_error("asset: " + text);
}

template <class Header>
Header header_of(Bytes bytes, const char* of) {
    Header header;
    if (bytes.size() < sizeof header) refuse(fmt::format("{} bytes are no {}; send one", bytes.size(), of));
    std::memcpy(&header, bytes.data(), sizeof header);
    return header;
}

template <class T>
std::span<const T> part(Bytes bytes, std::uint64_t at, std::uint64_t count) {
    return {reinterpret_cast<const T*>(bytes.data() + at), count};
}

void require_sane(AssetMaterial material, std::size_t index) {
    const auto share = [&](double value, const char* name, double most) {
        if (!(value >= 0 && value <= most))
            refuse(fmt::format("material {}: {} = {:g}; give a share of the representation's, 0 to {:g}",
                               index, name, value, most));
    };
    share(material.stiffness, "stiffness", 1);
    share(material.damping, "damping", 1e3);
    share(material.friction, "friction", 1e3);
}

BuiltAsset mesh_of(Bytes bytes, std::uint64_t budget) {
    const auto header = header_of<AssetSource>(bytes, "mesh");
    if ((header.flags & ~AssetSource::all_flags) != 0)
        refuse(fmt::format("a mesh with flags {:#x} is not known here; build both from the same version",
                           header.flags));
    const auto layout = protocol::layout_of(header);
    if (!layout || layout->total != bytes.size())
        refuse(fmt::format(
            "{} vertices, {} triangles and {} materials do not make {} bytes; it is cut off, or its "
            "counts are wrong",
            header.vertices, header.triangles, header.materials, bytes.size()));
    Triangles triangles{.vertices = part<Point3>(bytes, layout->vertices, header.vertices),
                        .triangles = part<Triangle>(bytes, layout->triangles, header.triangles)};
    if ((header.flags & AssetSource::materials_of_triangles) != 0)
        triangles.materials = part<std::uint8_t>(bytes, layout->triangle_materials, header.triangles);
    const auto materials = part<AssetMaterial>(bytes, layout->materials, header.materials);
    for (std::size_t i = 0; i < materials.size(); ++i) require_sane(materials[i], i);

    const MeshBuild how{.exact = (header.flags & AssetSource::exact) != 0,
                        .weld = header.weld,
                        .budget = budget,
                        .find_crossings = (header.flags & AssetSource::no_crossings) == 0};
    auto mesh = std::make_unique<Mesh>(triangles, how);
    mesh->materials.assign(materials.begin(), materials.end());
    BuiltAsset built;
    built.ready.notes = mesh->notes();
    built.asset = std::move(mesh);
    return built;
}

BuiltAsset field_of(Bytes bytes, std::uint64_t budget) {
    const auto header = header_of<HeightSource>(bytes, "height field");
    if (protocol::bytes_of(header) != bytes.size())
        refuse(fmt::format("{} by {} heights do not make {} bytes; it is cut off, or its counts are wrong",
                           header.columns, header.rows, bytes.size()));
    require_sane(header.material, 0);
    const HeightGrid grid{.columns = header.columns,
                          .rows = header.rows,
                          .dx = header.dx,
                          .dy = header.dy,
                          .corner = {header.corner[0], header.corner[1], header.corner[2]}};
    const auto heights =
        part<float>(bytes, sizeof(HeightSource), std::uint64_t{header.columns} * header.rows);
    BuiltAsset built{.asset = std::make_unique<HeightField>(heights, grid, std::uint8_t{0}, budget),
                     .ready = {}};
    built.asset->materials = {header.material};
    return built;
}

BuiltAsset of_kind(Bytes bytes, std::uint64_t budget) {
    const auto head = header_of<AssetHead>(bytes, "shape");
    if (head.magic != AssetHead::magic_word || head.version != 1)
        refuse(
            "not made by this version of the library; build the application and the servo from the same "
            "version");
    switch (head.kind) {
        case static_cast<std::uint32_t>(AssetKind::mesh):
            return mesh_of(bytes, budget);
        case static_cast<std::uint32_t>(AssetKind::height_field):
            return field_of(bytes, budget);
        default:
            refuse(fmt::format("kind {} is not known here; build both from the same version", head.kind));
    }
}

}  // namespace

BuiltAsset build_asset(std::span<const std::byte> source, std::uint64_t budget) {
    if (reinterpret_cast<std::uintptr_t>(source.data()) % alignof(AssetSource) != 0)
        refuse("its source is not aligned to 8 bytes; copy it to memory that is");
    BuiltAsset built = of_kind(source, budget);
    const Asset& asset = *built.asset;
    built.ready.kind = static_cast<std::uint32_t>(asset.kind);
    built.ready.bytes = asset.bytes();
    built.ready.faces = asset.faces();
    for (int i = 0; i < 3; ++i) {
        built.ready.low[i] = asset.low[i];
        built.ready.high[i] = asset.high[i];
    }
    return built;
}

}  // namespace knurl::servo
