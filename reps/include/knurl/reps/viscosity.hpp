#pragma once

/// @file
/// A thick liquid everywhere: F = -b v, torque -b_r w.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// A thick liquid everywhere: F = -b v, torque -b_r w.
struct Viscosity {
    /// Damping b (N s/m); clamped to what the device stands. Typically 1 to 5.
    double damping = 0;
    /// Angular damping b_r (N m s/rad); clamped likewise.
    double angular_damping = 0;
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
struct Describe<Viscosity> {
    static constexpr std::string_view name = "viscosity";
    static constexpr Field fields[] = {
        number_row("damping", offsetof(Viscosity, damping), "N s/m", "force against velocity"),
        number_row("angular_damping", offsetof(Viscosity, angular_damping), "N m s/rad",
                   "torque against angular velocity"),
        recovery_row(offsetof(Viscosity, recovery)),
    };
};

/// On a device the damping is clamped to what its velocity filter allows, b <= m / (4 (T + tau + tau_f)), or
/// to 10 N s/m where its mass m is not known; angular damping in proportion to the device's torsional
/// stiffness.
Viscosity prepared(Viscosity params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Viscosity& params, const Viscosity* previous, Viscosity::State& state,
           const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const Viscosity& params, Viscosity::State& state, const Probe& probe, double dt) noexcept;
/// Returns how stiff and how damped the hand feels this effect at the probe, for the budget.
HandLoad load(const Viscosity& params, const Viscosity::State& state, const Probe& probe) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Viscosity& params) noexcept;

}  // namespace knurl
