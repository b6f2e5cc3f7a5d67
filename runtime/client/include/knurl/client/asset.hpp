#pragma once
// Shapes that are sent once and felt from then on (reps/shape.hpp).

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
    HeightGrid grid;
    /// m, row by row, x first; columns times rows. They are sent as float: those in double from their middle,
    /// so that hills far above sea level keep their digits.
    std::variant<std::span<const float>, std::span<const double>> heights;
    AssetMaterial material = {};
};

/// How triangles are sent.
struct SendOptions {
    /// Corners as double: 32 bytes more a triangle, and exact to 1e-11 m instead of 1e-7 of the mesh's size.
    bool exact = false;
    double scale = 1;    // m per unit of the vertices
    double weld = 1e-6;  // of the mesh's size: vertices nearer than that are one
    /// Looks for faces that cross others (0.6 s per million): without it a hand may pass under a crossing
    /// sheet.
    bool find_crossings = true;
    /// Of the triangles' materials; none: all feel as the representation says.
    std::vector<AssetMaterial> materials = {};
};

/// What the servo made of it.
struct SentShape {
    std::uint32_t asset = 0;   // for Shape::asset
    std::uint64_t faces = 0;   // that are left
    std::uint64_t bytes = 0;   // of the servo's memory
    Vec3 low = {}, high = {};  // m, its box, in its own frame
    MeshNotes notes;           // what was mended of triangles
};

namespace detail {
class SendingState;
}

/// A shape on its way: the servo's machine builds its form of it beside everything else, about 1 us per
/// triangle and more, after its way over the network if there is one. Belongs to the thread of its claim. Its
/// end before done() says so calls it off.
class Sending {
  public:
    explicit Sending(std::shared_ptr<detail::SendingState> state);
    Sending(Sending&&) noexcept = default;
    Sending& operator=(Sending&&) noexcept = default;
    ~Sending();

    /// None: not yet. Throws Error once if it was refused: what was wrong, at which triangle, what to do.
    std::optional<SentShape> done(std::chrono::nanoseconds wait = std::chrono::nanoseconds(0));
    /// For poll, epoll, any loop: readable when done() has an answer.
    int fd() const;

  private:
    std::shared_ptr<detail::SendingState> state_;
};

}  // namespace knurl
