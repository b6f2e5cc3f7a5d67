#pragma once

/// @file
/// A field of force and torque known near one pose: (F, t) = (F0, t0) + J (dp, theta), theta the rotation
/// vector from the orientation at which it is known to the probe's, along the shorter way.

#include <cstddef>
#include <numbers>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/taylor.hpp>

namespace knurl {

/// A field of force and torque known near one pose: (F, t) = (F0, t0) + J (dp, theta).
struct Taylor6 {
    /// Point at which the field is known (m), world frame.
    Vec3 origin = {};
    /// Orientation of the probe at which it is known; any length but 0.
    Quat orientation = {};
    /// Force at the origin (N).
    Vec3 force = {};
    /// Torque at the orientation, about the probe (N m).
    Vec3 torque = {};
    /// Jacobian: rows in N and N m, columns in m and rad, world frame.
    Mat6 jacobian = {};
    /// Distance from the origin at which the field ends (m), 1e-6 or more.
    double radius = 0.05;
    /// Angle from the orientation at which it ends (rad), 1e-6 to pi / 2.
    double angle = 0.5;
    /// Time over which a change reaches the hand (s), or `automatic`; 0: at once.
    double recovery = automatic;
    /// What acts beyond radius or angle.
    TaylorEdge edge = TaylorEdge::fade;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Set by the servo in `prepared`: no direction restores with more (N/m).
    double stiffness = 0;
    /// Set by the servo in `prepared`, of `fade`: share of its reach up to which it is the series (1).
    double core = 0.8;
    /// Set by the servo in `prepared`: metres that a radian counts as; 0: the device's torsion is not known.
    double metres = 0;
    /// Set by the servo in `prepared`: work at which the edge cuts (J); the field gives nothing where it is
    /// that.
    double level = 0;

    /// The servo's memory of one such representation.
    struct State {
        /// Nothing is remembered.
        std::uint64_t unused = 0;
    };
};

template <>
struct Describe<Taylor6> {
    static constexpr std::string_view name = "taylor6";
    static constexpr Field fields[] = {
        vector_row("origin", offsetof(Taylor6, origin), "m", "where the field is known"),
        {.name = "orientation",
         .type = Field::Type::quaternion,
         .offset = offsetof(Taylor6, orientation),
         .unit = "1",
         .meaning = "of the probe, at which it is known",
         .minimum = -1e9,
         .maximum = 1e9},
        vector_row("force", offsetof(Taylor6, force), "N", "there"),
        vector_row("torque", offsetof(Taylor6, torque), "N m", "there, about the probe"),
        {.name = "jacobian",
         .type = Field::Type::matrix,
         .offset = offsetof(Taylor6, jacobian),
         .unit = "(N, N m) per (m, rad)",
         .meaning = "how force and torque (rows) change with position and rotation vector (columns)",
         .minimum = -1e9,
         .maximum = 1e9,
         .count = 6},
        number_row("radius", offsetof(Taylor6, radius), "m", "from the origin, where the field ends", 1e-6,
                   1e9),
        number_row("angle", offsetof(Taylor6, angle), "rad", "from the orientation, where the field ends",
                   1e-6, std::numbers::pi / 2),
        choice_row("edge", offsetof(Taylor6, edge), "what is felt beyond radius or angle",
                   detail::taylor_edges),
        recovery_row(offsetof(Taylor6, recovery)),
    };
};

/// On a device the jacobian is clamped as Taylor's is, once force and torque have the same unit: with k_max
/// (N/m) and kappa_max (N m/rad) a radian counts as sqrt(kappa_max / k_max) metres. Where kappa_max is not
/// known, only the part of force by position is clamped. Edges are bounded as Taylor's, where needed by
/// scaling down the field (`fade`) or the jacobian (`hold`).
Taylor6 prepared(Taylor6 params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Taylor6& params, const Taylor6* previous, Taylor6::State& state,
           const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const Taylor6& params, Taylor6::State& state, const Probe& probe, double dt) noexcept;
/// Returns how stiff and how damped the hand feels this effect at the probe, for the budget.
HandLoad load(const Taylor6& params, const Taylor6::State& state, const Probe& probe) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Taylor6& params) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Taylor6& params) noexcept;

}  // namespace knurl
