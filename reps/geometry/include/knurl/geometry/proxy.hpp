#pragma once

/// @file
/// The point of a surface that holds the hand back: the nearest one that can be reached from where it was,
/// without going through anything. The god-object of Zilles and Salisbury (IROS 95), found by walking over
/// the faces' neighbours; inside of it is behind a face.

#include <cstdint>

#include <Eigen/Core>

#include <knurl/geometry/asset.hpp>

namespace knurl {

/// The servo's memory of one probe on one surface, in the surface's own frame.
struct Proxy {
    /// The proxy (m): on the surface while it is touched, else the hand.
    double at[3] = {};
    /// The hand in the last cycle (m).
    double last[3] = {};
    /// Lowest corner of a box that is known to be empty (m), from the asset's middle; low > high: none.
    float low[3] = {};
    /// Highest corner of that box (m).
    float high[3] = {};
    /// Face on which the proxy lies.
    std::uint32_t face = 0;
    /// How the proxy stands to the surface.
    enum class Phase : std::uint8_t {
        /// It has not met the hand yet.
        fresh = 0,
        /// It is the hand.
        free = 1,
        /// It lies on the surface.
        touching = 2,
        /// It lies on the surface, and the active set holds it.
        tangled = 3,
    };
    /// How the proxy stands to the surface.
    Phase phase = Phase::fresh;
    /// Cycles since the last search for an empty box.
    std::uint8_t since = 0;
    /// Radius for which the empty box holds: the upper half of a float (m).
    std::uint16_t kept = 0;
};

/// The foot of the probe on the surface.
struct Foot {
    /// Point of the surface (m).
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    /// Unit normal, from the hand to where it may go.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    /// Depth of the probe's surface along the normal (m), >= 0.
    double depth = 0;
    /// Face, in the asset's own order.
    std::uint32_t face = 0;
    /// Triangle, as it was given.
    std::uint32_t triangle = 0;
    /// Material of the face.
    std::uint8_t material = 0;
};

/// How much one cycle looked at. It is bounded in every cycle by the limits below.
struct Work {
    /// Faces of the walk.
    std::uint32_t faces = 0;
    /// Nodes of the search tree.
    std::uint32_t nodes = 0;
    /// Pieces of sweeps.
    std::uint32_t pieces = 0;
    /// Sweeps.
    std::uint32_t sweeps = 0;
    /// Checks that a way leads through no face.
    std::uint32_t guards = 0;
    /// Faces that were looked at around corners.
    std::uint32_t fans = 0;
    /// Sweeps of the active set.
    std::uint32_t tangles = 0;
};
/// Most faces of a walk.
inline constexpr std::uint32_t max_walk_faces = 64;
/// Most faces around a vertex.
inline constexpr std::uint32_t max_fan = 64;
/// Most sweeps.
inline constexpr std::uint32_t max_sweeps = 7;
/// Most pieces of a sweep.
inline constexpr std::uint32_t max_pieces = 16;
/// Most nodes of the search tree.
inline constexpr std::uint32_t max_nodes = 2048;
/// Most faces around corners.
inline constexpr std::uint32_t max_fans = 512;
/// Most sweeps of the active set.
inline constexpr std::uint32_t max_tangles = 16 * 5;

/// One cycle of a probe whose centre is at `hand` (m, the asset's frame) and whose radius is `radius` (m).
/// True: it touches, and `foot` says where. A fresh proxy that begins behind a face is not pushed out: it is
/// free until it has come to the front. noexcept, allocates nothing, work within the limits above.
bool follow(const Asset& asset, Proxy& proxy, const Eigen::Vector3d& hand, double radius, Foot& foot,
            Work& work) noexcept;

/// The proxy on another asset that takes the place of `from`'s under the hand: stays where it was as nearly
/// as the new surface allows.
void adopt(const Asset& asset, Proxy& proxy, const Eigen::Vector3d& hand, Work& work) noexcept;

/// Share of the way from `from` to `to` (m, the asset's frame) at which it first meets the front of a face;
/// 2: it meets none. Where it meets none, a face that is turned towards `side` counts if the way leads past
/// it by `reach` (m) at most. `foot` says what it meets. Work within the limits above.
double first_front(const Asset& asset, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double reach,
                   const Eigen::Vector3d& side, Foot& foot, Work& work) noexcept;

/// Of the faces within `within` (m) of a place the one that faces `normal` most; of several, the nearest.
/// False: there is none whose normal has a cosine of `least` with it.
bool facing_near(const Asset& asset, const Eigen::Vector3d& place, double within,
                 const Eigen::Vector3d& normal, double least, Foot& foot, Work& work) noexcept;

/// The angle-weighted mean normal at a foot, interpolated over its face (force shading; Morgenbesser and
/// Srinivasan 1996). Never decides contact.
Eigen::Vector3d shaded_normal(const Asset& asset, const Foot& foot) noexcept;

}  // namespace knurl
