#pragma once

/// @file
/// A force and torque that do not depend on the probe: gravity, wind, or (badly) a contact computed
/// elsewhere.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// A force and a torque that do not depend on the probe.
struct ConstantForce {
    /// Force on the hand (N), world frame.
    Vec3 force = {};
    /// Torque on the hand about the probe's position (N m), world frame.
    Vec3 torque = {};
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;

    /// The servo's memory of one such representation.
    struct State {
        /// Nothing is remembered.
        std::uint64_t unused = 0;
    };
};

template <>
struct Describe<ConstantForce> {
    static constexpr std::string_view name = "constant_force";
    static constexpr Field fields[] = {
        vector_row("force", offsetof(ConstantForce, force), "N", "on the hand"),
        vector_row("torque", offsetof(ConstantForce, torque), "N m", "on the hand, about the probe"),
        recovery_row(offsetof(ConstantForce, recovery)),
    };
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
ConstantForce prepared(ConstantForce params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const ConstantForce& params, const ConstantForce* previous, ConstantForce::State& state,
           const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const ConstantForce& params, ConstantForce::State& state, const Probe& probe,
                double dt) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const ConstantForce& params) noexcept;

}  // namespace knurl
