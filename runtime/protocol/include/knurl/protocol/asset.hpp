#pragma once
// Large immutable things (a triangle mesh, a height field) travel once. The application writes the source
// into a memfd of its own, seals it, and offers it over a second connection to the socket, which stays open
// until it is answered:
//
//   client                     broker                      builder (a process of its own, idle priority)
//   Hello              ->
//                      <-      Welcome
//   AssetOffer + memfd ->              source    ->
//   (waits; a hang-up                            <-        the servo's form + notes, or why not
//    cancels)          <-      AssetReady, or Refused
//
// From AssetReady on the claim's scene knows the number. AssetForget, which is not answered, gives it back:
// the servo lets go of it as soon as nothing that is felt, or still fades, is made of it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <knurl/geometry/mesh.hpp>
#include <knurl/protocol/attach.hpp>

namespace knurl::protocol {

inline constexpr std::uint64_t max_asset_bytes = std::uint64_t{256}
                                                 << 20;  // of one claim, as the servo holds them

/// What every source begins with; AssetSource or HeightSource goes on.
struct AssetHead {
    static constexpr std::uint64_t magic_word = 0x7465737341'4c4e4b;  // "KNLAsset"
    std::uint64_t magic = magic_word;
    std::uint32_t version = 1;
    std::uint32_t kind = 0;  // AssetKind
};

/// A mesh's beginning. Behind it, without gaps and in this order: vertices (three doubles each),
/// materials (AssetMaterial), triangles (three std::uint32_t each), and a byte per triangle with
/// `materials_of_triangles`.
struct AssetSource {
    static constexpr std::uint32_t exact = 1, materials_of_triangles = 2, no_crossings = 4, all_flags = 7;
    AssetHead head{.kind = static_cast<std::uint32_t>(AssetKind::mesh)};
    std::uint64_t vertices = 0, triangles = 0;
    std::uint32_t materials = 0;
    std::uint32_t flags = 0;
    double weld = 1e-6;  // of the mesh's size
};

/// Where its parts lie (bytes from the beginning).
struct AssetSourceLayout {
    std::uint64_t vertices = 0, materials = 0, triangles = 0, triangle_materials = 0, total = 0;
};
/// None: its counts are beyond what any memory holds.
std::optional<AssetSourceLayout> layout_of(const AssetSource& source) noexcept;

inline constexpr std::uint32_t max_asset_materials = 256;

/// A height field's beginning. Behind it columns times rows heights as float, row by row, x first.
struct HeightSource {
    AssetHead head{.kind = static_cast<std::uint32_t>(AssetKind::height_field)};
    std::uint32_t columns = 0, rows = 0;
    double dx = 0, dy = 0;   // m
    double corner[3] = {};   // m, where the first one is, at height 0
    AssetMaterial material;  // of all of it
};
/// Of the whole source. None: its counts are beyond what any memory holds.
std::optional<std::uint64_t> bytes_of(const HeightSource& source) noexcept;

static_assert(sizeof(AssetHead) == 16 && sizeof(AssetSource) == 48 && sizeof(AssetMaterial) == 24 &&
              sizeof(HeightSource) == 88);

struct AssetOffer {
    MessageHeader header{.type = MessageType::asset_offer};
    std::uint32_t device = 0;  // of the claim
    std::uint32_t number = 0;  // 1 to max_assets, that nothing has yet
    std::uint64_t key = 0;     // Claimed::key
    std::uint64_t bytes = 0;   // of the source
};

struct AssetReady {
    MessageHeader header{.type = MessageType::asset_ready};
    std::uint32_t number = 0;
    std::uint32_t kind = 0;
    std::uint64_t bytes = 0;  // as the servo holds it
    std::uint64_t faces = 0;
    double low[3] = {}, high[3] = {};  // m, its box
    MeshNotes notes;
};

using AssetDigest = std::array<std::uint8_t, 32>;  // SHA-256 of a source

/// To whoever records the device (RecordRequest), with the sealed source, before a claim has it. Nobody waits
/// for one that does not read.
struct RecordedAsset {
    MessageHeader header{.type = MessageType::recorded_asset};
    std::uint64_t bytes = 0;
    AssetDigest digest = {};
};

struct AssetForget {
    MessageHeader header{.type = MessageType::asset_forget};
    std::uint32_t device = 0;
    std::uint32_t number = 0;
    std::uint64_t key = 0;
};

}  // namespace knurl::protocol
