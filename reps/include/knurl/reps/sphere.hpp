#pragma once
// A ball, or the room in one: height |p - center| - radius - the probe's radius, or the radii's difference -
// |p - center|.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

struct Sphere {
    Vec3 center = {};      // m
    double radius = 0.01;  // m; 0: a point
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
struct Describe<Sphere> {
    static constexpr std::string_view name = "sphere";
    static constexpr auto fields = join_rows(
        std::array{center_row<Sphere>(), number_row("radius", offsetof(Sphere, radius), "m", "0: a point"),
                   side_row<Sphere>()},
        surface_rows<Sphere>());
};

Sphere prepared(Sphere params, const Limits& limits) noexcept;
void adopt(const Sphere& params, const Sphere* previous, Sphere::State& state, const Probe& probe) noexcept;
Contact contact(const Sphere& params, Sphere::State& state, const Probe& probe, double dt) noexcept;
std::uint32_t curved(const Sphere& params, const Sphere::State& state, const Probe& probe, const Probe& there,
                     std::span<CurvedContact> out) noexcept;
void lean(const Sphere& params, Sphere::State& state, const Probe& there, double below) noexcept;
bool plane_alone(const Sphere& params, const Sphere::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept;
std::optional<Bound> bound(const Sphere& params, const Sphere::State& state) noexcept;
void out_of_reach(const Sphere& params, Sphere::State& state) noexcept;

}  // namespace knurl
