#pragma once

/// @file
/// What finite flat pieces (polygon, half_plane) have in common. Around a piece space is free on both sides,
/// so the nearest point is not enough to know what the hand touches: half-way through it would pop out at the
/// back (Zilles & Salisbury, IROS 95). A piece therefore remembers from which side the hand came:
///
///       free   .  p0
///               \       front
///     ===========x==========
///                 \     back  p3
///                  p1 ---> ...   p2
///
/// p0 -> p1 crosses the piece: it is touched, and acts as the plane of the side of entry however deep p is,
/// until p is back on that side, or its foot has left the piece sideways (p1 -> p3 holds, p2 lets go): the
/// tip has slipped off, as off the edge of a table, and the force is gone at once.
///
/// A one-sided piece that the hand first meets from behind is not touched. A probe with a radius that slips
/// off, or that comes from behind, feels nothing until all of it is clear of the piece. So no force begins at
/// depth; when the probe slips off, the force falls to zero. Edges are round from all directions.
///
/// Together with other surfaces, a piece follows the path of the proxy (the point that satisfies all surfaces
/// that hold the hand) instead of the hand's own path (proxy_path.hpp). So a hand that is pressed into one
/// piece slides on to its neighbour as if both were one.

#include <cstdint>
#include <string_view>

#include <knurl/reps/motion.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// From where a piece can be touched.
enum class Sides : std::uint32_t {
    /// From the normal's side alone; from the back the hand passes through.
    front = 0,
    /// From both sides.
    both = 1,
};

/// Why a probe that overlaps a piece does not touch it. It can touch again once all of it has been clear.
enum class LetGo : std::uint32_t {
    /// It is not let go.
    no = 0,
    /// It slipped sideways out of its hold; it touches again also when its centre crosses anew.
    slipped = 1,
    /// It came from behind a piece that is touched from the front alone.
    from_behind = 2,
};

/// The servo's memory of a piece.
struct PieceState {
    /// The probe in the last cycle, or the proxy where there are other surfaces, minus the piece's own motion
    /// (m, world axes).
    Vec3 last = {};
    /// How far the surface has moved on since it was placed.
    Motion motion;
    /// 1: there was a last cycle.
    std::uint32_t met = 0;
    /// Side in the last cycle: 1 in front, -1 behind.
    std::int32_t side = 0;
    /// Side from which it was entered: 1 front, -1 back, 0 not at all.
    std::int32_t touched = 0;
    /// Why it is not touched though it overlaps.
    LetGo let_go = LetGo::no;
    /// Where the path of this cycle begins (m), as `last`.
    Vec3 start = {};
    /// `side` when the cycle began; 0: it had not met the probe.
    std::int32_t was_side = 0;
    /// `touched` when the cycle began.
    std::int32_t was_touched = 0;
    /// `let_go` when the cycle began.
    LetGo was_let_go = LetGo::no;
    /// Side on which `from` lies.
    std::int32_t from_side = 0;
    /// Place at which a probe with a radius is held (m), from the probe.
    Vec3 brush = {};
    /// From where the path goes on inside of this cycle (m), as `last`.
    Vec3 from = {};
    /// 1: it holds the proxy, which lies beside it by less than the tolerance of a seam (proxy_path.hpp).
    std::uint32_t handed = 0;
    /// 1: it holds a probe with a radius at `brush`.
    std::uint32_t brushed = 0;
    /// 1: the proxy has come off it, and the probe is back in front.
    std::uint32_t out = 0;
    /// 1: it was left in this cycle, so it is not entered in this cycle.
    std::uint32_t left = 0;
};

namespace detail {
inline constexpr std::string_view piece_sides[] = {"front", "both"};
}  // namespace detail

}  // namespace knurl
