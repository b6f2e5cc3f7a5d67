#pragma once

/// @file
/// The weight of something held: F = m g.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// The weight of something held: F = m g.
struct Gravity {
    /// Acceleration g (m/s^2), world frame.
    Vec3 acceleration = {0, 0, -9.81};
    /// Mass of what is held (kg), 0 to 1e6.
    double mass = 0;
    /// Time over which a change reaches the hand (s), or `automatic`; 0: at once, so a weight drops.
    double recovery = 0.1;

    /// The servo's memory of one such representation.
    struct State {
        /// Nothing is remembered.
        std::uint64_t unused = 0;
    };
};

template <>
struct Describe<Gravity> {
    static constexpr std::string_view name = "gravity";
    static constexpr Field fields[] = {
        vector_row("acceleration", offsetof(Gravity, acceleration), "m/s^2", "of what falls", 1e6),
        number_row("mass", offsetof(Gravity, mass), "kg", "of what is held", 0, 1e6),
        recovery_row(offsetof(Gravity, recovery)),
    };
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Gravity prepared(Gravity params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Gravity& params, const Gravity* previous, Gravity::State& state,
           const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const Gravity& params, Gravity::State& state, const Probe& probe, double dt) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Gravity& params) noexcept;

}  // namespace knurl
