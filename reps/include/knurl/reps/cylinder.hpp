#pragma once
// A cylinder with flat ends, or the room in one. Outside its height is the distance, so a probe with a radius
// feels its edges rounded; inside it is that of the nearest face.

#include <cstddef>
#include <optional>
#include <span>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/solid.hpp>

namespace knurl {

struct Cylinder {
    Vec3 center = {};           // m
    Vec3 axis = {0, 0, 1};      // of any length
    double radius = 0.01;       // m
    double half_length = 0.02;  // m, from the middle to an end; 0: a disc; infinity: endless
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
    static constexpr std::uint32_t max_contacts = 2;
};

template <>
struct Describe<Cylinder> {
    static constexpr std::string_view name = "cylinder";
    static constexpr Field half_length = [] {
        Field row = number_row("half_length", offsetof(Cylinder, half_length), "m",
                               "from the middle to an end; infinity: endless");
        row.infinity_allowed = true;
        return row;
    }();
    static constexpr auto fields =
        join_rows(std::array{center_row<Cylinder>(), axis_row<Cylinder>(),
                             number_row("radius", offsetof(Cylinder, radius), "m", "of the wall"),
                             half_length, side_row<Cylinder>()},
                  surface_rows<Cylinder>());
};

Cylinder prepared(Cylinder params, const Limits& limits) noexcept;
void adopt(const Cylinder& params, const Cylinder* previous, Cylinder::State& state,
           const Probe& probe) noexcept;
Contact contact(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt) noexcept;
/// Of the hollow one the wall and the nearer end, which hold both in its corner; else the one contact.
std::uint32_t contacts(const Cylinder& params, Cylinder::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept;
std::uint32_t curved(const Cylinder& params, const Cylinder::State& state, const Probe& probe,
                     const Probe& there, std::span<CurvedContact> out) noexcept;
void lean(const Cylinder& params, Cylinder::State& state, const Probe& there, double below) noexcept;
bool plane_alone(const Cylinder& params, const Cylinder::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept;
std::optional<Bound> bound(const Cylinder& params, const Cylinder::State& state) noexcept;
void out_of_reach(const Cylinder& params, Cylinder::State& state) noexcept;

}  // namespace knurl
