#pragma once
// The point of a surface that holds the hand back: the nearest one that can be reached from where it was,
// without going through anything. The god-object of Zilles and Salisbury (IROS 95), found by walking over the
// faces' neighbours; inside of it is behind a face.

#include <cstdint>

#include <Eigen/Core>

#include <knurl/geometry/asset.hpp>

namespace knurl {

/// The servo's memory of one probe on one surface, in the surface's own frame.
struct Proxy {
    double at[3] = {};                // m, the proxy: on the surface while it is touched, else the hand
    double last[3] = {};              // m, the hand in the last cycle
    float low[3] = {}, high[3] = {};  // m from the asset's middle: a box known to be empty; low > high: none
    std::uint32_t face = 0;
    enum class Phase : std::uint8_t { fresh = 0, free = 1, touching = 2, tangled = 3 };
    Phase phase = Phase::fresh;  // fresh: it has not met the hand yet; tangled: the active set holds it
    std::uint8_t since = 0;      // cycles since an empty box was last looked for
    std::uint16_t kept = 0;      // the radius for which the empty box holds: the upper half of a float
};

/// What is felt.
struct Foot {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();    // m, of the surface
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the hand to where it may go
    double depth = 0;                                   // m, >= 0, of the probe's surface along it
    std::uint32_t face = 0;                             // in the asset's own order
    std::uint32_t triangle = 0;                         // as it was given
    std::uint8_t material = 0;
};

/// How much was looked at. Bounded in every cycle; see the limits.
struct Work {
    std::uint32_t faces = 0, nodes = 0, pieces = 0, sweeps = 0, guards = 0;
    std::uint32_t fans = 0;     // faces looked at around corners
    std::uint32_t tangles = 0;  // sweeps of the active set
};
inline constexpr std::uint32_t max_walk_faces = 64;
inline constexpr std::uint32_t max_fan = 64;
inline constexpr std::uint32_t max_sweeps = 7;
inline constexpr std::uint32_t max_pieces = 16;  // of a sweep
inline constexpr std::uint32_t max_nodes = 2048;
inline constexpr std::uint32_t max_fans = 512;
inline constexpr std::uint32_t max_tangles = 16 * 5;

/// One cycle of a probe whose centre is at `hand` (m, the asset's frame) and whose radius is `radius` (m).
/// True: it touches, and `foot` says where. A fresh proxy that begins behind a face is not pushed out: it is
/// free until it has come to the front. noexcept, allocates nothing, work within the limits above.
bool follow(const Asset& asset, Proxy& proxy, const Eigen::Vector3d& hand, double radius, Foot& foot,
            Work& work) noexcept;

/// The proxy on another asset that takes the place of `from`'s under the hand: stays where it was as nearly
/// as the new surface allows.
void adopt(const Asset& asset, Proxy& proxy, const Eigen::Vector3d& hand, Work& work) noexcept;

/// Where the way from `from` to `to` (m, the asset's frame) first meets the front of a face: which share of it; 2: it
/// meets none. Where it meets none, a face that is turned towards `side` counts beside which it leads past by `reach` (m)
/// at most. `foot` says what it meets. Work within the limits above.
double first_front(const Asset& asset, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double reach,
                   const Eigen::Vector3d& side, Foot& foot, Work& work) noexcept;

/// Of the faces within `within` (m) of a place the one that faces `normal` most; of several, the nearest. False: there
/// is none whose normal has a cosine of `least` with it.
bool facing_near(const Asset& asset, const Eigen::Vector3d& place, double within,
                 const Eigen::Vector3d& normal, double least, Foot& foot, Work& work) noexcept;

/// The angle-weighted mean normal at a foot, interpolated over its face (force shading; Morgenbesser and
/// Srinivasan 1996). Never decides contact.
Eigen::Vector3d shaded_normal(const Asset& asset, const Foot& foot) noexcept;

}  // namespace knurl
