#pragma once
// What finite flat pieces (polygon, half_plane) have in common. Around a piece space is free on both sides,
// so the nearest point is not enough to know what the hand touches: half-way through it would pop out at the
// back (Zilles & Salisbury, IROS 95). A piece therefore remembers from which side the hand came:
//
//       free   .  p0
//               \       front
//     ===========x==========
//                 \     back  p3
//                  p1 ---> ...   p2
//
// p0 -> p1 crosses the piece: it is touched, and felt as the plane of the side of entry however deep p is,
// until p is back on that side, or its foot has left the piece sideways (p1 -> p3 holds, p2 lets go): the tip
// has slipped off, as off the edge of a table, and the force is gone at once.
//
// Seen first from behind, a piece with one side is not touched. A probe with a radius that slips off, or that
// comes from behind, feels nothing until all of it is clear of the piece: so nothing pushes that was not
// pushed before, and the force falls to zero at most. Edges are round from all directions.
//
// Pieces know nothing of each other: a hand that is pressed into one and slides onto its neighbour sinks
// through the seam. Let pieces that stand on each other overlap by more than the hand sinks in, or give the
// whole thing (box).

#include <cstdint>
#include <string_view>

#include <knurl/reps/motion.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// From where a piece can be touched.
enum class Sides : std::uint32_t {
    front = 0,  // from the normal's side alone; from the back the hand passes through
    both = 1,
};

/// Why a probe that overlaps a piece does not feel it. It will when all of it is clear of the piece.
enum class LetGo : std::uint32_t {
    no = 0,
    slipped = 1,      // sideways out of its hold; felt again also when the centre crosses anew
    from_behind = 2,  // it came from behind a piece that is touched from the front alone
};

/// The servo's memory of a piece.
struct PieceState {
    Vec3 last = {};  // m, world axes: the probe in the last cycle, less what the piece has moved on by
    Motion motion;
    std::uint32_t met = 0;     // 1: there was a last cycle
    std::int32_t side = 0;     // of it: 1 in front, -1 behind
    std::int32_t touched = 0;  // from which side it was entered: 1 front, -1 back, 0 not at all
    LetGo let_go = LetGo::no;
};

namespace detail {
inline constexpr std::string_view piece_sides[] = {"front", "both"};
}  // namespace detail

}  // namespace knurl
