#pragma once

/// @file
/// The half-space n.x >= offset is free; below it the hand feels max(0, k depth - b v.n) n.
/// Source: Mark et al., SIGGRAPH 96, section 2.1.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>

namespace knurl {

/// How a plane that changes under the hand reaches its new place.
enum class PlaneUpdate : std::uint32_t {
    /// The force of the old set is cross-faded to that of the new set (default).
    fade = 0,
    /// Lowered to the probe if it embeds it, then raised linearly (Mark et al., figure 7).
    paper = 1,
    /// Starts with the last depth, then raised linearly (VRPN's variant).
    last_depth = 2,
};

/// How a plane acts together with the others of its probe.
enum class PlaneCombine : std::uint32_t {
    /// Solved together with all other surfaces (default).
    joint = 0,
    /// Its force k depth is added to theirs, as in Armlib and VRPN: up to N k stiff, and not conservative.
    sum = 1,
};

/// Meaning of `recovery = automatic` for `paper` and `last_depth` (s): the paper's own figure.
inline constexpr double paper_recovery = 0.05;

/// A plane: the half-space normal.x >= offset is free. Below it the hand feels max(0, k depth - b v.n) n.
/// Mark et al., SIGGRAPH 96, section 2.1.
struct Plane {
    /// Normal, towards free space. A length other than 1 divides `offset` too.
    Vec3 normal = {0, 0, 1};
    /// Offset along the normal (m), world frame.
    double offset = 0;
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
    /// How a change reaches the hand.
    PlaneUpdate update = PlaneUpdate::fade;
    /// How it acts together with the other surfaces of its probe.
    PlaneCombine combine = PlaneCombine::joint;
    /// Share of the hand's momentum that a pulse takes away at entry (1); Salcudean and Vlaar. 0: no pulse.
    double braking = 0;
    /// Friction along the surface; by default none.
    Friction friction = {};
    /// Snags along the surface; by default none.
    Snag snag = {};
    /// Relief on the surface; by default none.
    Texture texture = {};

    /// The servo's memory of one such representation.
    struct State {
        /// How far below its place the plane still is (m): `paper`, `last_depth`.
        double lowered = 0;
        /// Time until it has arrived (s).
        double remaining = 0;
        /// How far the surface has moved on since it was placed.
        Motion motion;
    };
};

template <>
struct Describe<Plane> {
    static constexpr std::string_view name = "plane";
    static constexpr std::string_view updates[] = {"fade", "paper", "last_depth"};
    static constexpr std::string_view combinations[] = {"joint", "sum"};
    static constexpr auto fields = join_rows(
        std::array{
            direction_row("normal", offsetof(Plane, normal), "towards free space"),
            number_row("offset", offsetof(Plane, offset), "m", "n.x >= offset is free", -1e9, 1e9),
            choice_row("update", offsetof(Plane, update), "how a change reaches the hand", updates),
            choice_row("combine", offsetof(Plane, combine),
                       "how it acts together with the others of its probe", combinations),
        },
        surface_rows<Plane>());
};

/// The part of `prepared` that the geometry has: normalises the normal.
void prepare_geometry(Plane& params) noexcept;
/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Plane prepared(Plane params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Plane& params, const Plane* previous, Plane::State& state, const Probe& probe) noexcept;
/// Returns the tangent plane at the probe's foot, and advances `state` by `dt` (s).
Contact contact(const Plane& params, Plane::State& state, const Probe& probe, double dt) noexcept;

/// The plane as a half-space.
inline HalfSpace half_space(const Plane& params) noexcept {
    return {.normal = to_eigen(params.normal), .offset = params.offset, .damping = params.damping};
}
/// The paper's update and last_depth bring their own recovery; the scene does not cross-fade them.
inline bool recovers_itself(const Plane& params) noexcept {
    return params.update != PlaneUpdate::fade;
}
/// A plane that fades stands still between changes: the scene scans it with all others, without a call.
inline std::optional<HalfSpace> standing(const Plane& params) noexcept {
    if (recovers_itself(params) || !(params.velocity == Vec3{})) return std::nullopt;
    return half_space(params);
}
/// Arrives at once.
void settle(const Plane& params, Plane::State& state) noexcept;

}  // namespace knurl
