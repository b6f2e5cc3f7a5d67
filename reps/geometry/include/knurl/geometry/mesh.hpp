#pragma once

/// @file
/// A triangle mesh in the form that the servo walks on, and its builder: takes the time that it takes,
/// allocates, throws. Never called from real-time code.
///
/// ~~~{.unparsed}
///   Triangles ──> finite? indices? ──> weld ──> drop zero-area and duplicate faces ──> pair edges (radially
///   where more than two meet) ──> orient ──> split vertices with two fans, and fans of more than 64 ──> BVH,
///   faces in its order ──> mark faces that others cross ──> where there are any, or parts that touch: cut
///   them there, drop what lies inside of a body, and again from pairing on
/// ~~~
///
/// What can be mended is mended, and counted in MeshNotes; other mistakes are refused with the numbers of the
/// triangles and the reason.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include <knurl/geometry/asset.hpp>
#include <knurl/geometry/triangles.hpp>

namespace knurl {

/// One line that says what is wrong, at which triangle, and what to do.
struct MeshError : std::runtime_error {
    using std::runtime_error::runtime_error;
};
/// MeshBuild::go_on said no.
struct MeshCancelled : MeshError {
    using MeshError::MeshError;
};

/// How a mesh is built.
struct MeshBuild {
    /// Corners as double: 32 bytes more a face, and 1e-11 m instead of 1e-7 of the mesh's size.
    bool exact = false;
    /// Vertices nearer to each other than this become one, as a share of the mesh's size (1). 0: only those
    /// that are equal.
    double weld = 1e-6;
    /// Memory of the result and of building it (bytes); a mesh that needs more is refused before it is taken.
    std::size_t budget = std::size_t{256} << 20;
    /// Looks for faces that cross others: 0.6 s per million. Without it a hand may pass under a crossing
    /// sheet.
    bool find_crossings = true;
    /// Cuts faces where they cross, drops what is inside of bodies then, and shuts gaps between parts, so
    /// that what touches holds the hand like one. As far as the budget allows it, and if find_crossings.
    bool unite = true;
    /// Bodies whose walls are that near to each other touch, as a share of the mesh's size (1).
    double gap = 1e-4;
    /// Called after every slice of at most some milliseconds; false ends the building with MeshCancelled.
    std::function<bool()> go_on = {};
};

/// What the builder found and mended.
struct MeshNotes {
    /// Triangles as given.
    std::uint64_t triangles_given = 0;
    /// Vertices as given.
    std::uint64_t vertices_given = 0;
    /// Vertices that were not finite, or 1e7 m away or more; their faces are dropped.
    std::uint64_t vertices_not_finite = 0;
    /// Vertices beyond 1000 times the others' spread; their faces are dropped.
    std::uint64_t vertices_far = 0;
    /// Vertices that became one with another.
    std::uint64_t vertices_welded = 0;
    /// Faces that were dropped with such a vertex.
    std::uint64_t faces_dropped = 0;
    /// Faces without area, which are dropped.
    std::uint64_t faces_degenerate = 0;
    /// Faces that were given twice; the second is dropped.
    std::uint64_t faces_duplicate = 0;
    /// Faces that were wound against their neighbours, and were turned.
    std::uint64_t faces_turned = 0;
    /// Edges with one face.
    std::uint64_t edges_open = 0;
    /// Edges with more than two faces.
    std::uint64_t edges_non_manifold = 0;
    /// Vertices that were split, since the faces around them are several fans, or one of more than 64 faces.
    std::uint64_t vertices_split = 0;
    /// Faces that others cross.
    std::uint64_t faces_crossed = 0;
    /// Vertices that were moved to shut gaps and steps between bodies.
    std::uint64_t vertices_moved = 0;
    /// Faces that were cut where others cross or touch them.
    std::uint64_t faces_cut = 0;
    /// Faces that this added.
    std::uint64_t faces_added = 0;
    /// Faces and pieces that were then inside of a body, or lay on others, and were dropped.
    std::uint64_t faces_inside = 0;
    /// Parts that hang together.
    std::uint64_t parts = 0;
    /// 1: faces meet and could not be cut soundly. The mesh is built as it was given, and a hand may find a
    /// way in between bodies that touch.
    std::uint64_t not_united = 0;
};

/// Estimate of the memory that building such a mesh takes in all (bytes), for MeshBuild::budget. Without the
/// cuts: where faces cross, these take at most what the budget leaves.
std::size_t mesh_budget(std::size_t vertices, std::size_t triangles, bool exact) noexcept;

struct MeshData;  // src/mesh_data.hpp

/// A triangle mesh, as an asset.
class Mesh final : public Asset {
  public:
    /// Throws MeshError, std::bad_alloc.
    explicit Mesh(const Triangles& given, const MeshBuild& how = {});
    /// One that was written by write(): asset_of. Throws MeshError.
    Mesh(std::span<const std::byte> block, std::shared_ptr<const void> keeper);
    ~Mesh() override;

    /// As of Asset.
    std::size_t bytes() const noexcept override;
    /// As of Asset.
    std::size_t faces() const noexcept override;
    /// As of Asset.
    std::size_t block_bytes() const noexcept override;
    /// As of Asset.
    void write(std::span<std::byte> block) const override;
    /// As of Asset.
    DrawnTriangles drawn() const override;
    /// What the builder found and mended.
    const MeshNotes& notes() const noexcept;
    /// The form that the proxy walks on.
    const MeshData& data() const noexcept { return *data_; }

  private:
    std::unique_ptr<MeshData> data_;
};

}  // namespace knurl
