#pragma once
// A rod with round ends, or the room in one: a sphere about the nearest point of its axis.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

struct Capsule {
    Vec3 center = {};           // m
    Vec3 axis = {0, 0, 1};      // of any length
    double half_length = 0.02;  // m, of the axis, without the round ends; 0: a sphere
    double radius = 0.01;       // m; 0: a needle
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
struct Describe<Capsule> {
    static constexpr std::string_view name = "capsule";
    static constexpr auto fields = join_rows(
        std::array{center_row<Capsule>(), axis_row<Capsule>(),
                   number_row("half_length", offsetof(Capsule, half_length), "m",
                              "from the middle to where the round ends begin"),
                   number_row("radius", offsetof(Capsule, radius), "m", "0: a needle"), side_row<Capsule>()},
        surface_rows<Capsule>());
};

Capsule prepared(Capsule params, const Limits& limits) noexcept;
void adopt(const Capsule& params, const Capsule* previous, Capsule::State& state,
           const Probe& probe) noexcept;
Contact contact(const Capsule& params, Capsule::State& state, const Probe& probe, double dt) noexcept;
std::uint32_t curved(const Capsule& params, const Capsule::State& state, const Probe& probe,
                     const Probe& there, std::span<CurvedContact> out) noexcept;
void lean(const Capsule& params, Capsule::State& state, const Probe& there, double below) noexcept;
bool plane_alone(const Capsule& params, const Capsule::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept;
std::optional<Bound> bound(const Capsule& params, const Capsule::State& state) noexcept;
void out_of_reach(const Capsule& params, Capsule::State& state) noexcept;

}  // namespace knurl
