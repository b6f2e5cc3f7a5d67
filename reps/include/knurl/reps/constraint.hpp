#pragma once

/// @file
/// Holds the probe at a point, on a line or on a plane, from both sides: F = -k P (p - p0) - b P v with P =
/// 1, 1 - u u^T or u u^T. Neither a dead zone at the target nor a distance from which on it lets go: either
/// would chatter.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// To what a constraint holds the probe.
enum class ConstraintShape : std::uint32_t {
    /// A point.
    point = 0,
    /// A line.
    line = 1,
    /// A plane, from both sides.
    plane = 2,
};

/// Holds the probe at a point, on a line or on a plane, from both sides.
struct Constraint {
    /// The point, or a point of the line or plane (m), world frame.
    Vec3 origin = {};
    /// Direction of the line, or normal of the plane; any length but 0.
    Vec3 direction = {0, 0, 1};
    /// Stiffness (N/m), typically 200 to 2000. Infinity: the largest that the device allows. Larger values
    /// are clamped.
    double stiffness = 0;
    /// Damping towards and away from it (N s/m). Clamped to what the device stands.
    double damping = 0;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;
    /// To what the probe is held.
    ConstraintShape shape = ConstraintShape::point;
    /// Padding; 0.
    std::uint32_t reserved = 0;

    /// The servo's memory of one such representation.
    struct State {
        /// Nothing is remembered.
        std::uint64_t unused = 0;
    };
};

template <>
struct Describe<Constraint> {
    static constexpr std::string_view name = "constraint";
    static constexpr std::string_view shapes[] = {"point", "line", "plane"};
    static constexpr Field fields[] = {
        choice_row("shape", offsetof(Constraint, shape), "to what the probe is held", shapes),
        vector_row("origin", offsetof(Constraint, origin), "m", "the point, or one of the line or plane"),
        direction_row("direction", offsetof(Constraint, direction), "of the line; normal of the plane"),
        stiffness_row(offsetof(Constraint, stiffness), "force per distance"),
        number_row("damping", offsetof(Constraint, damping), "N s/m", "towards and away from it"),
        recovery_row(offsetof(Constraint, recovery)),
    };
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Constraint prepared(Constraint params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Constraint& params, const Constraint* previous, Constraint::State& state,
           const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const Constraint& params, Constraint::State& state, const Probe& probe, double dt) noexcept;
/// Returns how stiff and how damped the hand feels this effect at the probe, for the budget.
HandLoad load(const Constraint& params, const Constraint::State& state, const Probe& probe) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Constraint& params) noexcept;

}  // namespace knurl
