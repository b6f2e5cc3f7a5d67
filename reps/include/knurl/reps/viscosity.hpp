#pragma once
// A thick liquid everywhere: F = -b v, torque -b_r w.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

struct Viscosity {
    double damping = 0;           // N s/m; never more than the device stands
    double angular_damping = 0;   // N m s/rad; likewise
    double recovery = automatic;  // s; 0: at once

    struct State {
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
void adopt(const Viscosity& params, const Viscosity* previous, Viscosity::State& state,
           const Probe& probe) noexcept;
Wrench evaluate(const Viscosity& params, Viscosity::State& state, const Probe& probe, double dt) noexcept;
HandLoad load(const Viscosity& params, const Viscosity::State& state, const Probe& probe) noexcept;
bool powerless(const Viscosity& params) noexcept;

}  // namespace knurl
