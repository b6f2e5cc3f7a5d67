#pragma once

/// @file
/// A box: solid, touched from outside, or hollow, touched from inside.
///
/// Solid. Once the centre of the probe has entered, the box holds it by the face through which it came, as
/// the face's plane, however deep: half-way through it does not pop out at the back, and neither does it
/// behind a box thinner than the hand sinks in (the god-object of Zilles & Salisbury, IROS 95, on a box). It
/// lets go where the probe is back above that face, or where its foot leaves the face sideways:
///
///        p0 .    | n
///            \   |             free
///       ______\__|________________
///      |       \              .' |
///      |        p1 --- d --- p2 -|- p3
///      |  solid            .'    |
///      |                 .' 45°  |
///
/// The force is k d n all along p1 ... p2, and at p3 it is gone at once: the tip has slipped off the edge. It
/// falls by what pressed, to zero, and nothing that was stored comes back. To move over to the side as soon
/// as that is nearer (beyond the dotted line) would lose no energy, but turn the force there by 90 degrees, a
/// jump of 1.4 k d; push a hand out sideways that presses a table near its edge; and open the narrow side of
/// a wall to a hand that presses it by more than half the wall's thickness: a pop-through. So the face is
/// kept.
///
/// Seen first inside, the nearest face holds the probe. Outside, a probe of radius r touches a box with
/// rounded edges (the length of the parts that stick out, less r): a hand that presses by less than r slides
/// over edges and corners without a jump. One that presses more slips, and feels nothing until it is clear of
/// the box or enters it again.
///
/// Beside others all of this goes by the proxy instead of the probe (proxy_path.hpp), so what touches holds
/// like one.
///
/// Hollow. The nearest wall of each axis, all three at once where the probe is in a corner, solved together:
/// exact. A probe too thick for the box is pulled to its middle.

#include <cstddef>
#include <optional>
#include <span>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

/// A box: solid, touched from outside, or hollow, touched from inside. The head of this file says how it
/// holds a probe.
struct Box {
    /// Its middle (m), world frame.
    Vec3 center = {};
    /// Turns the box's axes into the world's; any length but 0.
    Quat orientation = {};
    /// From the middle to the faces along the box's axes (m); 0: as thin as a plate.
    Vec3 half_size = {0.05, 0.05, 0.05};
    /// Where free space is: around the solid, or in the hollow.
    Side side = Side::outside;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Velocity with which the surface moves on between two updates (m/s).
    Vec3 velocity = {};
    /// Stiffness (N/m), typically 200 to 2000. Infinity: the largest that the device allows. Larger values
    /// are clamped.
    double stiffness = 0;
    /// Damping along the normal (N s/m), while touched; typically 0 to 5. Clamped to what the device stands.
    double damping = 0;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;
    /// Share of the hand's momentum that a pulse takes away at entry (1); Salcudean and Vlaar. 0: no pulse.
    double braking = 0;
    /// Friction along the surface; by default none.
    Friction friction = {};
    /// Snags along the surface; by default none.
    Snag snag = {};
    /// Relief on the surface; by default none.
    Texture texture = {};

    /// Most tangent planes at once (concepts.hpp).
    static constexpr std::uint32_t max_contacts = 3;
    /// The proxy enters and leaves this surface (concepts.hpp).
    static constexpr bool follows = true;

    /// The servo's memory of one such representation.
    struct State {
        /// The probe in the last cycle, or the proxy beside other surfaces (m), in the box's frame.
        Vec3 last = {};
        /// How far the surface has moved on since it was placed.
        Motion motion;
        /// 1: there was a last cycle.
        std::uint32_t met = 0;
        /// The face that holds the probe: 1 + 2 axis, and 1 more for the negative one; 0: none.
        std::uint16_t face = 0;
        /// 1: the probe slipped sideways out of its hold, and is not clear of the box yet.
        std::uint16_t slipped = 0;
        /// Where the path of this cycle begins (m), as `last`.
        Vec3 start = {};
        /// From where the path goes on inside of this cycle (m), as `last`.
        Vec3 from = {};
        /// `met` when the cycle began.
        std::uint16_t was_met = 0;
        /// `face` when the cycle began.
        std::uint16_t was_face = 0;
        /// `slipped` when the cycle began.
        std::uint16_t was_slipped = 0;
        /// 1: `from` is in use.
        std::uint16_t from_met = 0;
        /// 1: its face holds the proxy, which lies beside the face by less than the tolerance of a seam
        /// (proxy_path.hpp).
        std::uint16_t handed = 0;
        /// 1: it holds a probe with a radius at `brush`.
        std::uint16_t brushed = 0;
        /// Place at which a probe with a radius is held (m), from the probe.
        Vec3 brush = {};
        /// 1: the proxy has come off its face, and the probe is back above.
        std::uint16_t out = 0;
        /// 1: it was left in this cycle, so it is not entered in this cycle.
        std::uint16_t left = 0;
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

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Box prepared(Box params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Box& params, const Box* previous, Box::State& state, const Probe& probe) noexcept;
/// The tangent plane that matters most: of a hollow box that of the wall that is violated most.
Contact contact(const Box& params, Box::State& state, const Probe& probe, double dt) noexcept;
/// All tangent planes at once: one of a solid box, three of a hollow one.
std::uint32_t contacts(const Box& params, Box::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept;

/// The ball outside of which the box is out of reach. None while a solid box holds the probe, which it does
/// from however deep.
std::optional<Bound> bound(const Box& params, const Box::State& state) noexcept;
/// The path so far is forgotten: the next cycle sees the probe for the first time.
void out_of_reach(const Box& params, Box::State& state) noexcept;

}  // namespace knurl
