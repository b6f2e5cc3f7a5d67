#pragma once

/// @file
/// Large immutable things (a triangle mesh, a height field) travel once. The application writes the source
/// into a memfd of its own, seals it, and offers it over a second connection to the socket, which stays open
/// until it is answered:
///
///     client                     broker                      builder (a process of its own, idle priority)
///     Hello              ->
///                        <-      Welcome
///     AssetOffer + memfd -> looks at it ........... ->  takes it from the client's connection
///     (waits; a hang-up                            <-        the servo's form + notes, or why not
///      cancels)          <-      AssetReady, or Refused
///
/// From AssetReady on the claim's scene knows the number. AssetForget, which is not answered, gives it back:
/// the servo lets go of it as soon as nothing that acts, or still fades, is made of it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <knurl/geometry/mesh.hpp>
#include <knurl/protocol/attach.hpp>

namespace knurl::protocol {

/// Most bytes of one claim's assets, as the servo holds them.
inline constexpr std::uint64_t max_asset_bytes = std::uint64_t{256} << 20;

/// What every source begins with; AssetSource or HeightSource goes on.
struct AssetHead {
    /// "KNLAsset".
    static constexpr std::uint64_t magic_word = 0x7465737341'4c4e4b;
    /// magic_word.
    std::uint64_t magic = magic_word;
    /// Version of the source's format.
    std::uint32_t version = 1;
    /// An AssetKind.
    std::uint32_t kind = 0;
};

/// A mesh's beginning. Behind it, without gaps and in this order: vertices (three doubles each),
/// materials (AssetMaterial), triangles (three std::uint32_t each), and a byte per triangle with
/// `materials_of_triangles`.
struct AssetSource {
    /// Flag: corners as double.
    static constexpr std::uint32_t exact = 1;
    /// Flag: there is a material per triangle.
    static constexpr std::uint32_t materials_of_triangles = 2;
    /// Flag: do not look for faces that cross others.
    static constexpr std::uint32_t no_crossings = 4;
    /// All flags.
    static constexpr std::uint32_t all_flags = 7;
    /// What every source begins with.
    AssetHead head{.kind = static_cast<std::uint32_t>(AssetKind::mesh)};
    /// Number of vertices.
    std::uint64_t vertices = 0;
    /// Number of triangles.
    std::uint64_t triangles = 0;
    /// Number of materials.
    std::uint32_t materials = 0;
    /// Bit mask of the flags above.
    std::uint32_t flags = 0;
    /// SendOptions::weld: share of the mesh's size (1).
    double weld = 1e-6;
};

/// Where a mesh's parts lie (bytes from the beginning of the source).
struct AssetSourceLayout {
    /// Vertices.
    std::uint64_t vertices = 0;
    /// Materials.
    std::uint64_t materials = 0;
    /// Triangles.
    std::uint64_t triangles = 0;
    /// Materials of triangles.
    std::uint64_t triangle_materials = 0;
    /// End of the source.
    std::uint64_t total = 0;
};
/// Where the parts of this source lie. None: its counts are beyond what any memory holds.
std::optional<AssetSourceLayout> layout_of(const AssetSource& source) noexcept;

/// Most materials of an asset.
inline constexpr std::uint32_t max_asset_materials = 256;

/// A height field's beginning. Behind it columns times rows heights as float, row by row, x first.
struct HeightSource {
    /// What every source begins with.
    AssetHead head{.kind = static_cast<std::uint32_t>(AssetKind::height_field)};
    /// Number of heights along x.
    std::uint32_t columns = 0;
    /// Number of heights along y.
    std::uint32_t rows = 0;
    /// Distance along x from one height to the next (m).
    double dx = 0;
    /// Distance along y from one height to the next (m).
    double dy = 0;
    /// Where the first height is, at height 0 (m).
    double corner[3] = {};
    /// Material of all of it.
    AssetMaterial material;
};
/// Bytes of the whole source. None: its counts are beyond what any memory holds.
std::optional<std::uint64_t> bytes_of(const HeightSource& source) noexcept;

static_assert(sizeof(AssetHead) == 16 && sizeof(AssetSource) == 48 && sizeof(AssetMaterial) == 24 &&
              sizeof(HeightSource) == 88);

/// A client offers an asset; the sealed memfd comes with it.
struct AssetOffer {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::asset_offer};
    /// Device of the claim: index in Welcome.
    std::uint32_t device = 0;
    /// Number for the asset, 1 to max_assets, that no asset has yet.
    std::uint32_t number = 0;
    /// Claimed::key of the claim.
    std::uint64_t key = 0;
    /// Bytes of the source.
    std::uint64_t bytes = 0;
};

/// The claim's scene knows the asset.
struct AssetReady {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::asset_ready};
    /// Its number.
    std::uint32_t number = 0;
    /// Its AssetKind.
    std::uint32_t kind = 0;
    /// Bytes as the servo holds it.
    std::uint64_t bytes = 0;
    /// Faces that are left.
    std::uint64_t faces = 0;
    /// Lowest corner of its bounding box (m).
    double low[3] = {};
    /// Highest corner of its bounding box (m).
    double high[3] = {};
    /// What was mended.
    MeshNotes notes;
};

/// SHA-256 of a source.
using AssetDigest = std::array<std::uint8_t, 32>;

/// Sent to whoever records the device (RecordRequest), with the sealed source, before a claim has it. The
/// broker does not wait for a client that does not read.
struct RecordedAsset {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::recorded_asset};
    /// Bytes of the source.
    std::uint64_t bytes = 0;
    /// Digest of the source.
    AssetDigest digest = {};
};

/// A client gives an asset back; there is no answer.
struct AssetForget {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::asset_forget};
    /// Device of the claim: index in Welcome.
    std::uint32_t device = 0;
    /// Number of the asset.
    std::uint32_t number = 0;
    /// Claimed::key of the claim.
    std::uint64_t key = 0;
};

}  // namespace knurl::protocol
