#include <knurl/protocol/asset.hpp>

namespace knurl::protocol {

namespace {
constexpr std::uint64_t most = std::uint64_t{1} << 40;  // of any count: no product overflows
}

std::optional<AssetSourceLayout> layout_of(const AssetSource& source) noexcept {
    if (source.vertices > most || source.triangles > most || source.materials > max_asset_materials)
        return std::nullopt;
    AssetSourceLayout layout;
    std::uint64_t at = sizeof(AssetSource);
    const auto part = [&](std::uint64_t count, std::uint64_t size) {
        const std::uint64_t begin = at;
        at += count * size;
        return begin;
    };
    const bool marked = (source.flags & AssetSource::materials_of_triangles) != 0;
    layout.vertices = part(source.vertices, 3 * sizeof(double));
    layout.materials = part(source.materials, sizeof(AssetMaterial));
    layout.triangles = part(source.triangles, 3 * sizeof(std::uint32_t));
    layout.triangle_materials = part(marked ? source.triangles : 0, 1);
    layout.total = at;
    return layout;
}

std::optional<std::uint64_t> bytes_of(const HeightSource& source) noexcept {
    const std::uint64_t heights = std::uint64_t{source.columns} * source.rows;
    if (heights > most) return std::nullopt;
    return sizeof(HeightSource) + heights * sizeof(float);
}

}  // namespace knurl::protocol
