// Any bytes as an asset from an application, a mesh or a height field. The servo's builder makes the asset
// within its budget, or refuses in one line; another process reads the same asset; hands move on it. An
// input has the form (8 bytes), then the source, raw or well-formed; the rest moves the hand.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/servo/asset_build.hpp>

#include "hands.hpp"

using namespace knurl;
using namespace knurl::fuzz;

namespace {

struct Form8 {
    std::uint8_t kind, columns, rows, coordinates, flags, budget, hands, cut;
};

struct Source {
    std::vector<std::uint64_t> words;  // aligned to 8
    std::size_t size = 0;
    std::span<const std::byte> all() const { return std::as_bytes(std::span(words)).first(size); }
    template <class T>
    void put(const T& value) {
        words.resize((size + sizeof value + 7) / 8);
        std::memcpy(reinterpret_cast<std::byte*>(words.data()) + size, &value, sizeof value);
        size += sizeof value;
    }
};

AssetMaterial material(Input& input, bool any) {
    if (any) return {input.next<double>(), input.next<double>(), input.next<double>()};
    return {.stiffness = input.next<std::uint8_t>() / 255.0};
}

/// Copies that many bytes from the input.
void put_bytes(Source& source, Input& input, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) source.put(input.next<std::uint8_t>());
}

void put_field(Source& source, Input& input, const Form8& form) {
    const unsigned how = std::max<unsigned>(form.coordinates & 3, any_float),
                   cell = form.coordinates >> 2 & 3;
    protocol::HeightSource header;
    header.columns = form.columns % 40u;
    header.rows = form.rows % 40u;
    header.dx = form.flags & 8 ? coordinate(input, cell) : 1e-3;
    header.dy = form.flags & 8 ? coordinate(input, cell) : 2e-3;
    for (double& x : header.corner) x = coordinate(input, cell);
    header.material = material(input, form.flags & 1);
    const std::uint32_t heights = header.columns * header.rows;
    if (form.flags & 2) header.columns = input.next<std::uint32_t>();  // counts that are wrong
    source.put(header);
    for (std::uint32_t i = 0; i < heights; ++i) source.put(static_cast<float>(coordinate(input, how)));
}

void put_mesh(Source& source, Input& input, const Form8& form) {
    protocol::AssetSource header;
    header.vertices = form.columns;
    header.triangles = form.rows;
    header.materials = form.flags >> 4 & 3;
    header.flags = form.flags & 8 ? input.next<std::uint8_t>() : 0;
    const std::uint64_t marked = header.flags & protocol::AssetSource::materials_of_triangles ? form.rows : 0;
    if (form.flags & 2) header.triangles = input.next<std::uint64_t>();
    source.put(header);
    for (unsigned i = 0; i < 3u * form.columns; ++i) source.put(coordinate(input, form.coordinates & 3));
    for (unsigned i = 0; i < header.materials; ++i) source.put(material(input, form.flags & 1));
    for (unsigned i = 0; i < 3u * form.rows; ++i)
        source.put(std::uint32_t{input.next<std::uint8_t>()} % (form.columns + 1u));
    put_bytes(source, input, marked);
}

struct alignas(64) Line {
    std::byte bytes[64];
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input input({data, size});
    auto form = input.next<Form8>();
    if ((form.kind & 3) == 1) {
        form.columns = static_cast<std::uint8_t>(count_of(form.columns));
        form.rows = static_cast<std::uint8_t>(count_of(form.rows));
    }
    Source source;
    switch (form.kind & 3) {
        case 0:
            put_bytes(source, input, form.columns);
            break;
        case 1:
            put_mesh(source, input, form);
            break;
        default:
            put_field(source, input, form);
    }
    if (form.cut < 64 && source.size >= form.cut) source.size -= form.cut;  // mostly whole
    const std::uint64_t budget = std::uint64_t{form.budget} << 10;
    try {
        const servo::BuiltAsset built = servo::build_asset(source.all(), budget);
        const Asset& asset = *built.asset;
        require(asset.bytes() <= budget && built.ready.bytes == asset.bytes(),
                "an asset keeps to its budget");
        require(asset.faces() > 0 && built.ready.faces == asset.faces(), "an asset has faces");
        require(asset.low.allFinite() && asset.high.allFinite() &&
                    (asset.low.array() <= asset.high.array()).all(),
                "an asset has a box");
        for (const AssetMaterial& one : asset.materials)
            require(one.stiffness >= 0 && one.stiffness <= 1 && one.damping >= 0 && one.friction >= 0,
                    "a material is one");
        const auto memory = std::make_shared<std::vector<Line>>(asset.block_bytes() / sizeof(Line));
        asset.write(std::as_writable_bytes(std::span(*memory)));
        const auto there = asset_of(std::as_bytes(std::span(*memory)), memory);
        require(there->kind == asset.kind && there->bytes() == asset.bytes() && there->low == asset.low,
                "another process reads the same");
        move_about(*there, input, form.hands & 1 ? 0.01 * (asset.high - asset.low).norm() : 0,
                   asset.kind == AssetKind::mesh ? form.rows : asset.faces());
    } catch (const std::runtime_error& refused) {
        const std::string why = refused.what();
        require(!why.empty() && why.find('\n') == std::string::npos, "a refusal is one line");
    }
    return 0;
}
