#pragma once
// A representation as markers in the device's frame.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <knurl/messages/markers.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/reps/kind.hpp>

namespace knurl::messages {

/// Triangles of an asset, in the world of its claim, before the pose of a shape.
struct Triangles {
    std::span<const float> vertices;         // m: x, y, z of each
    std::span<const std::uint32_t> corners;  // three of each triangle
};

/// What is to be drawn.
struct Item {
    Kind kind = 0;
    std::span<const std::byte> params;     // kinds()[kind].size bytes
    protocol::Frame frame;                 // of its claim
    const Triangles* triangles = nullptr;  // of a shape's asset; null: not known
    bool touching = false, fading = false, silent = false, asleep = false;
};

/// Where on the device.
struct Surroundings {
    /// A plane without end is drawn as a patch about its point nearest to here, an effect without place here
    /// (m): the hand, or where it was.
    Vec3 hand;
    /// Radius of the workspace (m): how large a patch is.
    double reach = 0.1;
};

/// Most markers of a representation. A representation's markers are numbered slot x most_parts + part.
inline constexpr std::uint32_t most_parts = 8;
/// Triangles of a marker: 0.9 MB, so that none is more than a peer may leave unread.
inline constexpr std::size_t triangles_of_marker = 12'000;
/// A mesh with more triangles is drawn as the box around it.
inline constexpr std::size_t most_triangles = most_parts * triangles_of_marker;

/// By how far the hand moves until the representation is to be drawn anew (m); infinity: it stands where it is.
double redraw_distance(Kind kind, const Surroundings& around);

/// Its markers, numbered from first_id. None: it has no place and no direction, or its parameters are not of its kind.
std::vector<Marker> draw(const Item& item, const Surroundings& around, const std::string& ns,
                         std::int32_t first_id);

}  // namespace knurl::messages
