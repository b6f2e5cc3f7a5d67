#pragma once
// A field of force and torque known near one pose: (F, t) = (F0, t0) + J (dp, theta), theta the rotation
// vector from the orientation at which it is known to the probe's, along the shorter way.

#include <cstddef>
#include <numbers>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/taylor.hpp>

namespace knurl {

struct Taylor6 {
    Vec3 origin = {};       // m
    Quat orientation = {};  // any length but none
    Vec3 force = {};        // N, at the origin
    Vec3 torque = {};       // N m, at the orientation, about the probe
    Mat6 jacobian = {};     // rows N and N m, columns m and rad, in the world's frame
    double radius = 0.05;   // m
    double angle = 0.5;     // rad, from the orientation, where it ends
    double recovery = automatic;
    TaylorEdge edge = TaylorEdge::fade;
    std::uint32_t reserved = 0;
    // The servo's, filled in by `prepared`:
    double stiffness = 0;  // N/m, no direction restores with more
    double core = 0.8;     // of `fade`: up to this share of its reach it is the series
    double metres = 0;     // that a radian counts as; 0: the device's torsion is not known
    double level = 0;      // J, work at which the edge cuts: nothing is felt where it is that

    struct State {
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
/// known, only the part of force by position is clamped. Edges are bounded as Taylor's, where needed by scaling
/// down the field (`fade`) or the jacobian (`hold`).
Taylor6 prepared(Taylor6 params, const Limits& limits) noexcept;
void adopt(const Taylor6& params, const Taylor6* previous, Taylor6::State& state,
           const Probe& probe) noexcept;
Wrench evaluate(const Taylor6& params, Taylor6::State& state, const Probe& probe, double dt) noexcept;
HandLoad load(const Taylor6& params, const Taylor6::State& state, const Probe& probe) noexcept;
bool powerless(const Taylor6& params) noexcept;
std::optional<Bound> bound(const Taylor6& params) noexcept;

}  // namespace knurl
