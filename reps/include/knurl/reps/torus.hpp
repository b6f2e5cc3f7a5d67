#pragma once
// A ring, or the room in its tube: a sphere about the nearest point of the circle within. A probe too large
// for the hole plugs it: there it comes no farther than to one point of the axis on either side.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

struct Torus {
    Vec3 center = {};       // m
    Vec3 axis = {0, 0, 1};  // of any length, about which the ring goes
    double radius = 0.02;   // m, of the circle within
    double tube = 0.005;    // m, of the tube around it; 0: a wire
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

    using State = SolidState;
};

template <>
struct Describe<Torus> {
    static constexpr std::string_view name = "torus";
    static constexpr auto fields = join_rows(
        std::array{center_row<Torus>(), axis_row<Torus>(),
                   number_row("radius", offsetof(Torus, radius), "m", "of the circle within the tube"),
                   number_row("tube", offsetof(Torus, tube), "m", "0: a wire"), side_row<Torus>()},
        surface_rows<Torus>());
    static constexpr std::string_view contradictions[] = {
        static_below_dynamic, "leaves no hole in the ring; give less than radius"};
    static Verdict check(const Torus& torus) noexcept;
};

Torus prepared(Torus params, const Limits& limits) noexcept;
void adopt(const Torus& params, const Torus* previous, Torus::State& state, const Probe& probe) noexcept;
Contact contact(const Torus& params, Torus::State& state, const Probe& probe, double dt) noexcept;
std::uint32_t curved(const Torus& params, const Torus::State& state, const Probe& probe, const Probe& there,
                     std::span<CurvedContact> out) noexcept;
std::optional<Bound> bound(const Torus& params, const Torus::State& state) noexcept;
void out_of_reach(const Torus& params, Torus::State& state) noexcept;

}  // namespace knurl
