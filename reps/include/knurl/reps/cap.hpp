#pragma once

/// @file
/// The rimmed cap: what an application fits to a smooth surface where the hand is, with one curvature or two.
///
///        tangent          arc           tangent       Within the rim it follows the surface to third order;
///        ________......---------......________        beyond, where a fit knows nothing any more, it goes on
///                ^rim    foot    rim^                  straight. Smooth (C1) everywhere.
///
/// Its height is a signed distance (|gradient| = 1), so its force k depth n is the gradient of k depth^2 / 2
/// and no closed path of the hand gains anything.

#include <cstddef>

#include <knurl/reps/distance_surface.hpp>
#include <knurl/reps/material.hpp>

namespace knurl {

/// One curvature (no `axis`): the sphere that touches the foot, beyond the rim its tangent cone.
/// Two (`axis`): the torus that touches the foot, `curvature` along the axis and `curvature2` across it;
/// beyond the rim in either direction its tangents. Where both are equal it is the one-curvature form.
struct Cap {
    /// Point of the surface under the hand (m), world frame.
    Vec3 foot = {};
    /// Normal at the foot, towards free space; any length but 0.
    Vec3 normal = {0, 0, 1};
    /// Curvature along `axis` (1/m). Positive: hollow, the surface curves towards free space.
    double curvature = 0;
    /// Curvature across `axis` (1/m).
    double curvature2 = 0;
    /// Tangent direction of `curvature` (projected into the tangent plane); 0 0 0: that curvature in every
    /// direction.
    Vec3 axis = {};
    /// Sine of the angle up to which the stronger curvature is followed, 0 to 0.5.
    double rim = 0.15;
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

    /// The servo's memory of one such representation.
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

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Cap prepared(Cap params, const Limits& limits) noexcept;
/// Signed distance of the probe's surface, p and radius in m. A hollow tighter than half of 1 / the probe's
/// radius is evaluated as one of that curvature: in a tighter one the probe would touch on both sides.
SurfaceDistance distance(const Cap& params, const Eigen::Vector3d& p, double radius) noexcept;
/// Returns how far the probe may move before it touches (m); 0: it is touched.
double clearance(const Cap& params, const Cap::State& state, const Probe& probe) noexcept;
/// Fills in the surface near `there` with its curvature, and returns how many (concepts.hpp).
std::uint32_t curved(const Cap& params, const Cap::State& state, const Probe& probe, const Probe& there,
                     std::span<CurvedContact> out) noexcept;

}  // namespace knurl
