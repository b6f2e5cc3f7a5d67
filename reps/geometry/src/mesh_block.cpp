// A mesh as one piece of memory, for another process of the same build: header, faces, exact faces, nodes.
// Each part begins on a cache line.

#include <cstring>

#include <knurl/geometry/mesh.hpp>

#include "mesh_data.hpp"

namespace knurl {

namespace {

struct BlockHeader {
    static constexpr std::uint64_t magic_word = 0x6b636f6c'626c4e4b;  // "KNlblock"
    std::uint64_t magic = magic_word;
    std::uint64_t faces = 0, exact_faces = 0, nodes = 0, exact = 0, open = 0;
    double origin[3] = {}, size = 0, low[3] = {}, high[3] = {};
    MeshNotes notes;
};

struct Layout {
    std::size_t faces, exact_faces, nodes, total;
    explicit Layout(const BlockHeader& h) {
        std::size_t at = 0;
        const auto part = [&](std::size_t bytes) {
            const std::size_t begin = at;
            at += (bytes + 63) / 64 * 64;
            return begin;
        };
        part(sizeof(BlockHeader));
        faces = part(h.faces * sizeof(Face));
        exact_faces = part(h.exact_faces * sizeof(ExactFace));
        nodes = part(h.nodes * sizeof(MeshNode));
        total = at;
    }
};

BlockHeader header_of(const Mesh& mesh) {
    const MeshData& data = mesh.data();
    BlockHeader header{.faces = data.faces.size(),
                       .exact_faces = data.exact_faces.size(),
                       .nodes = data.nodes.size(),
                       .exact = data.exact,
                       .open = data.open,
                       .size = data.size,
                       .notes = data.notes};
    for (int k = 0; k < 3; ++k) {
        header.origin[k] = data.origin[k];
        header.low[k] = mesh.low[k];
        header.high[k] = mesh.high[k];
    }
    return header;
}

}  // namespace

std::size_t Mesh::block_bytes() const noexcept {
    return Layout(header_of(*this)).total;
}

void Mesh::write(std::span<std::byte> block) const {
    const BlockHeader header = header_of(*this);
    const Layout layout(header);
    if (block.size() != layout.total)
        throw MeshError("the mesh's block takes " + std::to_string(layout.total) + " bytes, not " +
                        std::to_string(block.size()) + "; ask block_bytes()");
    const auto put = [&](std::size_t at, const void* from, std::size_t bytes) {
        if (bytes > 0) std::memcpy(block.data() + at, from, bytes);
    };
    put(0, &header, sizeof header);
    put(layout.faces, data_->faces.data(), data_->faces.size_bytes());
    put(layout.exact_faces, data_->exact_faces.data(), data_->exact_faces.size_bytes());
    put(layout.nodes, data_->nodes.data(), data_->nodes.size_bytes());
}

Mesh::Mesh(std::span<const std::byte> block, std::shared_ptr<const void> keeper)
    : Asset(AssetKind::mesh), data_(std::make_unique<MeshData>()) {
    constexpr std::uint64_t most = std::uint64_t{1} << 32;  // of any count: no product overflows
    BlockHeader header;
    if (block.size() >= sizeof header) std::memcpy(&header, block.data(), sizeof header);
    if (block.size() < sizeof header || header.magic != BlockHeader::magic_word || header.faces > most ||
        header.exact_faces > most || header.nodes > most || header.nodes == 0 ||
        header.faces + header.exact_faces == 0 || Layout(header).total != block.size() ||
        reinterpret_cast<std::uintptr_t>(block.data()) % 64 != 0)
        throw MeshError("the mesh's block is not of this build; build the mesh anew");
    const Layout layout(header);
    MeshData& data = *data_;
    // Never written to: the spans are mutable for the builder only.
    auto* bytes = const_cast<std::byte*>(block.data());
    data.faces = {reinterpret_cast<Face*>(bytes + layout.faces), header.faces};
    data.exact_faces = {reinterpret_cast<ExactFace*>(bytes + layout.exact_faces), header.exact_faces};
    data.nodes = {reinterpret_cast<MeshNode*>(bytes + layout.nodes), header.nodes};
    data.size = header.size;
    data.exact = header.exact != 0;
    data.open = header.open != 0;
    data.notes = header.notes;
    data.keeper = std::move(keeper);
    for (int k = 0; k < 3; ++k) {
        data.origin[k] = header.origin[k];
        low[k] = header.low[k];
        high[k] = header.high[k];
    }
}

}  // namespace knurl
