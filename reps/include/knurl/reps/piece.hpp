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
// Beside others a piece goes by the path of the proxy, the point that satisfies all that holds the hand, instead
// of the hand's (proxy_path.hpp): pressed into one the hand slides on to its neighbour as if both were one.

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
    // m, world axes: the probe in the last cycle, or the proxy beside others, less what the piece has moved on by
    Vec3 last = {};
    Motion motion;
    std::uint32_t met = 0;     // 1: there was a last cycle
    std::int32_t side = 0;     // of it: 1 in front, -1 behind
    std::int32_t touched = 0;  // from which side it was entered: 1 front, -1 back, 0 not at all
    LetGo let_go = LetGo::no;
    // When the cycle began: m, as `last`, where the path begins; 0: it had not met the probe.
    Vec3 start = {};
    std::int32_t was_side = 0, was_touched = 0;
    LetGo was_let_go = LetGo::no;
    std::int32_t from_side = 0;
    Vec3 brush = {};
    Vec3 from = {};             // from where the path goes on in it
    std::uint32_t handed = 0;   // 1: it holds the proxy though that is beside it, by less than touching is
    std::uint32_t brushed = 0;  // 1: it holds a probe with a radius at `brush` (m, from the probe)
    std::uint32_t out = 0;      // 1: the proxy has come off it, and the probe is back in front
    std::uint32_t left = 0;     // 1: in this cycle, which is why it is not entered in it
};

namespace detail {
inline constexpr std::string_view piece_sides[] = {"front", "both"};
}  // namespace detail

}  // namespace knurl
