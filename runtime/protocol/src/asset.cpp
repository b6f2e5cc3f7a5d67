#include <knurl/protocol/asset.hpp>

namespace knurl::protocol {

std::optional<AssetSourceLayout> layout_of(const AssetSource& source) noexcept {
    constexpr std::uint64_t most = std::uint64_t{1} << 40;  // of anything: no product overflows
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

}  // namespace knurl::protocol
