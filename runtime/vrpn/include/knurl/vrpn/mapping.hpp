#pragma once

/// @file
/// How what a VRPN client says is felt: axes, units, and which of Knurl's representations stands for what.

#include <cstddef>
#include <cstdint>

#include <knurl/gateway/frames.hpp>
#include <knurl/reps/plane.hpp>

namespace knurl::vrpn {

/// Axes, units, and the law by which planes change.
struct Mapping {
    /// From the device's frame to the client's. VRPN's server for a Phantom: x right, y up, z towards the user; metres.
    gateway::Axes axes{{2, 3, 1}};
    /// How a plane that changes reaches the hand within the client's recovery time. One without a recovery time is faded.
    PlaneUpdate update = PlaneUpdate::last_depth;
    /// What one unit of a client's damping is (N s/m): it says 0 to 0.005.
    double damping_unit = 1000;
};

/// Most planes of a client on a device.
inline constexpr std::int32_t most_planes = 16;
/// Longest recovery that is believed (cycles of 1 ms).
inline constexpr std::int32_t most_recovery = 60000;
/// Most objects with meshes of a client on a device.
inline constexpr std::size_t most_objects = 32;
/// Most vertices of all of them.
inline constexpr std::size_t most_vertices = std::size_t{1} << 18;
/// Most triangles of all of them.
inline constexpr std::size_t most_triangles = std::size_t{1} << 18;

}  // namespace knurl::vrpn
