#pragma once
// A box: solid, felt from outside, or hollow, felt from inside.
//
// Solid. Once the centre of the probe has entered, the box holds it by the face through which it came, as the
// face's plane, however deep: half-way through it does not pop out at the back, and neither does it behind a
// box thinner than the hand sinks in (the god-object of Zilles & Salisbury, IROS 95, on a box). It lets go
// where the probe is back above that face, or where its foot leaves the face sideways:
//
//        p0 .    | n
//            \   |             free
//       ______\__|________________
//      |       \              .' |
//      |        p1 --- d --- p2 -|- p3
//      |  solid            .'    |
//      |                 .' 45°  |
//
// The force is k d n all along p1 ... p2, and at p3 it is gone at once: the tip has slipped off the edge. It
// falls by what pressed, to zero, and nothing that was stored comes back. To move over to the side as soon as
// that is nearer (beyond the dotted line) would lose no energy, but turn the force there by 90 degrees, a
// jump of 1.4 k d; push a hand out sideways that presses a table near its edge; and open the narrow side of a
// wall to a hand that presses it by more than half the wall's thickness: a pop-through. So the face is kept.
//
// Seen first inside, the nearest face holds the probe. Outside, a probe of radius r touches a box with
// rounded edges (the length of the parts that stick out, less r): a hand that presses by less than r slides
// over edges and corners without a jump. One that presses more slips, and feels nothing until it is clear of
// the box or enters it again.
//
// Beside others all of this goes by the proxy instead of the probe (proxy_path.hpp), so what touches holds like one.
//
// Hollow. The nearest wall of each axis, all three at once where the probe is in a corner, solved together:
// exact. A probe too thick for the box is pulled to its middle.

#include <cstddef>
#include <optional>
#include <span>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

struct Box {
    Vec3 center = {};                     // m
    Quat orientation = {};                // of the box's frame; any length
    Vec3 half_size = {0.05, 0.05, 0.05};  // m, along the axes of its frame; 0: as thin as a plate
    Side side = Side::outside;
    std::uint32_t reserved = 0;
    Vec3 velocity = {};           // m/s, with which it moves on between updates
    double stiffness = 0;         // N/m; infinity: as stiff as the device allows
    double damping = 0;           // N s/m
    double recovery = automatic;  // s; 0: at once
    double braking = 0;           // 1, share of the hand's momentum taken away at entry
    Friction friction = {};
    Snag snag = {};
    Texture texture = {};

    static constexpr std::uint32_t max_contacts = 3;
    static constexpr bool follows = true;

    struct State {
        Vec3 last = {};  // m, in the box's frame: the probe in the last cycle, or the proxy beside others
        Motion motion;
        std::uint32_t met = 0;   // 1: there was a last cycle
        std::uint16_t face = 0;  // that holds the probe: 1 + 2 axis, and 1 more for the negative one; 0: none
        std::uint16_t slipped = 0;  // 1: sideways out of its hold, not clear of the box yet
        // When the cycle began: m, as `last`, where the path begins; from where it goes on in it.
        Vec3 start = {}, from = {};
        std::uint16_t was_met = 0, was_face = 0, was_slipped = 0, from_met = 0;
        // 1: its face holds the proxy though that is beside it, by less than touching is
        std::uint16_t handed = 0;
        std::uint16_t brushed = 0;  // 1: it holds a probe with a radius at `brush` (m, from the probe)
        Vec3 brush = {};
        std::uint16_t out = 0;   // 1: the proxy has come off its face, and the probe is back above
        std::uint16_t left = 0;  // 1: in this cycle, which is why it is not entered in it
    };
};

template <>
struct Describe<Box> {
    static constexpr std::string_view name = "box";
    static constexpr auto fields = join_rows(
        std::array{
            center_row<Box>(),
            Field{.name = "orientation",
                  .type = Field::Type::quaternion,
                  .offset = offsetof(Box, orientation),
                  .unit = "1",
                  .meaning = "turns its axes into the world's",
                  .minimum = -1e9,
                  .maximum = 1e9,
                  .nonzero = true},
            Field{.name = "half_size",
                  .type = Field::Type::vector,
                  .offset = offsetof(Box, half_size),
                  .unit = "m",
                  .meaning = "from the middle to the faces, along its axes",
                  .minimum = 0,
                  .maximum = 1e9},
            side_row<Box>(),
        },
        surface_rows<Box>());
};

Box prepared(Box params, const Limits& limits) noexcept;
void adopt(const Box& params, const Box* previous, Box::State& state, const Probe& probe) noexcept;
/// The one that matters most: of a hollow box the wall that is violated most.
Contact contact(const Box& params, Box::State& state, const Probe& probe, double dt) noexcept;
/// All at once: one of a solid box, three of a hollow one.
std::uint32_t contacts(const Box& params, Box::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept;

/// Of a solid box that does not hold the probe (it holds it from however deep).
std::optional<Bound> bound(const Box& params, const Box::State& state) noexcept;
/// The path so far is forgotten: the next cycle sees the probe for the first time.
void out_of_reach(const Box& params, Box::State& state) noexcept;

}  // namespace knurl
