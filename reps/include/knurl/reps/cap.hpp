#pragma once
// The rimmed cap: what an application fits to a smooth surface where the hand is, with one curvature or two.
//
//        tangent          arc           tangent       Within the rim it follows the surface to third order;
//        ________......---------......________        beyond, where a fit knows nothing any more, it goes on
//                ^rim    foot    rim^                  straight. Smooth (C1) everywhere.
//
// Its height is a signed distance (|gradient| = 1), so its force k depth n is the gradient of k depth^2 / 2
// and no closed path of the hand gains anything.

#include <cstddef>

#include <knurl/reps/distance_surface.hpp>
#include <knurl/reps/material.hpp>

namespace knurl {

/// One curvature (no `axis`): the sphere that touches the foot, beyond the rim its tangent cone.
/// Two (`axis`): the torus that touches the foot, `curvature` along the axis and `curvature2` across it;
/// beyond the rim in either direction its tangents. Where both are equal it is the one-curvature form.
struct Cap {
    Vec3 foot = {};           // m, the surface's point under the hand
    Vec3 normal = {0, 0, 1};  // there, towards free space
    double curvature = 0;     // 1/m, positive: hollow, the surface curves towards free space
    double curvature2 = 0;    // 1/m, across `axis`
    Vec3 axis = {};        // the tangent direction of `curvature` (projected); 0 0 0: that in every direction
    double rim = 0.15;     // sine of the angle up to which the stronger curvature is followed
    Vec3 velocity = {};    // m/s, with which it moves on between updates
    double stiffness = 0;  // N/m; infinity: as stiff as the device allows
    double damping = 0;    // N s/m
    double recovery = automatic;  // s; 0: at once
    double braking = 0;           // 1, share of the hand's momentum taken away at entry
    Friction friction = {};
    Snag snag = {};
    Texture texture = {};

    using State = MovingState;
};

template <>
struct Describe<Cap> {
    static constexpr std::string_view name = "cap";
    static constexpr auto fields = join_rows(
        std::array{
            vector_row("foot", offsetof(Cap, foot), "m", "the surface's point under the hand"),
            direction_row("normal", offsetof(Cap, normal), "there, towards free space"),
            number_row("curvature", offsetof(Cap, curvature), "1/m", "positive: towards free space, hollow",
                       -1e9, 1e9),
            number_row("curvature2", offsetof(Cap, curvature2), "1/m", "across the axis", -1e9, 1e9),
            vector_row("axis", offsetof(Cap, axis), "1",
                       "the tangent direction of curvature; none: in every direction"),
            number_row("rim", offsetof(Cap, rim), "1",
                       "sine of the angle up to which the stronger curvature is followed", 0, 0.5),
        },
        surface_rows<Cap>());
    static constexpr std::string_view contradictions[] = {
        static_below_dynamic,
        "needs an axis; give the tangent direction of curvature",
        "is along the normal; give a direction in the tangent plane",
    };
    static Verdict check(const Cap& cap) noexcept;
};

Cap prepared(Cap params, const Limits& limits) noexcept;
/// A hollow tighter than half of 1 / the probe's radius is felt as
/// one of that curvature: in a tighter one the probe would touch on both sides.
SurfaceDistance distance(const Cap& params, const Eigen::Vector3d& p, double radius) noexcept;
double clearance(const Cap& params, const Cap::State& state, const Probe& probe) noexcept;
std::uint32_t curved(const Cap& params, const Cap::State& state, const Probe& probe, const Probe& there,
                     std::span<CurvedContact> out) noexcept;

}  // namespace knurl
