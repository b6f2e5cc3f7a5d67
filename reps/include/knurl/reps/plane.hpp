#pragma once
// The half-space n.x >= offset is free; below it the hand feels max(0, k depth - b v.n) n.
// Source: Mark et al., SIGGRAPH 96, section 2.1.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>

namespace knurl {

/// How a plane that changes under the hand reaches its new place.
enum class PlaneUpdate : std::uint32_t {
    fade = 0,        // cross-fade of the old set's force to the new set's (default)
    paper = 1,       // lowered to the probe if it embeds it, then raised linearly (paper, figure 7)
    last_depth = 2,  // starts with the depth that was felt, then raised linearly (VRPN's variant)
};

/// How a plane acts together with the others of its probe.
enum class PlaneCombine : std::uint32_t {
    joint = 0,  // solved together with all other surfaces (default)
    // its force k depth is added to theirs, as Armlib and VRPN do: up to N k stiff, and not conservative
    sum = 1,
};

/// What `recovery = automatic` means to `paper` and `last_depth`: the paper's own figure.
inline constexpr double paper_recovery = 0.05;  // s

struct Plane {
    Vec3 normal = {0, 0, 1};      // towards free space; a length other than 1 divides offset too
    double offset = 0;            // m
    Vec3 velocity = {};           // m/s, with which it moves on between updates
    double stiffness = 0;         // N/m; infinity: as stiff as the device allows
    double damping = 0;           // N s/m
    double recovery = automatic;  // s; 0: at once
    PlaneUpdate update = PlaneUpdate::fade;
    PlaneCombine combine = PlaneCombine::joint;
    double braking = 0;  // 1, share of the hand's momentum taken away at entry
    Friction friction = {};
    Snag snag = {};
    Texture texture = {};

    struct State {
        double lowered = 0;    // m, how far below its place the plane still is (paper, last_depth)
        double remaining = 0;  // s, until it has arrived
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

void prepare_geometry(Plane& params) noexcept;
Plane prepared(Plane params, const Limits& limits) noexcept;
void adopt(const Plane& params, const Plane* previous, Plane::State& state, const Probe& probe) noexcept;
Contact contact(const Plane& params, Plane::State& state, const Probe& probe, double dt) noexcept;

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
