#pragma once

/// @file
/// Assets: shapes that are sent once and then named (reps/shape.hpp).

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// A surface as heights over a regular grid (knurl/geometry/height_field.hpp): 2.1 bytes of the servo's
/// memory a triangle, where a mesh takes 96.
struct Heights {
    /// Size and place of the grid.
    HeightGrid grid;
    /// Heights (m), row by row, x first; columns times rows of them. They are sent as float. Those in double
    /// are sent as differences from their middle, so that hills far above sea level keep their digits.
    std::variant<std::span<const float>, std::span<const double>> heights;
    /// What the material makes of the representation's stiffness, damping and friction.
    AssetMaterial material = {};
};

/// How triangles are sent.
struct SendOptions {
    /// Corners as double: 32 bytes more a triangle, and exact to 1e-11 m instead of 1e-7 of the mesh's size.
    bool exact = false;
    /// Length of one unit of the vertices (m); 1e-3 for millimetres.
    double scale = 1;
    /// Vertices nearer to each other than this become one, as a share of the mesh's size (1).
    double weld = 1e-6;
    /// Looks for faces that cross others (0.6 s per million): without it a hand may pass under a crossing
    /// sheet.
    bool find_crossings = true;
    /// Materials of the triangles; empty: all triangles feel as the representation says.
    std::vector<AssetMaterial> materials = {};
};

/// What the servo made of a mesh or height field.
struct SentShape {
    /// Number of the asset, for Shape::asset.
    std::uint32_t asset = 0;
    /// Faces that are left after mending.
    std::uint64_t faces = 0;
    /// Bytes of the servo's memory that it takes.
    std::uint64_t bytes = 0;
    /// Lowest corner of its bounding box, in its own frame (m).
    Vec3 low = {};
    /// Highest corner of its bounding box, in its own frame (m).
    Vec3 high = {};
    /// What was mended of the triangles.
    MeshNotes notes;
};

namespace detail {
class SendingState;
}

/// A shape on its way to the servo. The servo's machine builds its form of it beside everything else: about 1
/// us per triangle and more, after the transport over a network if there is one. Belongs to the thread of its
/// claim. Its destructor calls the sending off, unless done() has given the answer.
class Sending {
  public:
    /// Made by Claim::begin_sending.
    explicit Sending(std::shared_ptr<detail::SendingState> state);
    /// Moves; the other one holds nothing any more.
    Sending(Sending&&) noexcept = default;
    /// Moves; the other one holds nothing any more.
    Sending& operator=(Sending&&) noexcept = default;
    ~Sending();

    /// Returns what the servo made of the shape; none: not yet. Waits for at most `wait`. Throws Error once
    /// if the shape was refused: what was wrong, at which triangle, what to do.
    std::optional<SentShape> done(std::chrono::nanoseconds wait = std::chrono::nanoseconds(0));
    /// A descriptor for poll, epoll or any loop: readable when done() has an answer.
    int fd() const;

  private:
    std::shared_ptr<detail::SendingState> state_;
};

}  // namespace knurl
