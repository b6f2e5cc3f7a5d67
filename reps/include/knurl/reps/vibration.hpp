#pragma once

/// @file
/// A buzz: F = A sin(2 pi phase) along a direction. The phase is a sum over the servo's own steps, phase += f
/// dt, never a clock's reading, so a change of frequency bends the wave and does not break it.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// A vibration: F = A sin(2 pi phase) along a direction.
struct Vibration {
    /// Direction of the force, of any length but 0.
    Vec3 direction = {0, 0, 1};
    /// Largest force A (N).
    double amplitude = 0;
    /// Frequency (Hz), 0 to 1e5; clamped to 1 / (4 T), a quarter of the servo's rate. Typically 50 to 300.
    double frequency = 100;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;

    /// The servo's memory of one such representation.
    struct State {
        /// The phase goes on through an update (concepts.hpp).
        static constexpr bool moves_alike = true;
        /// Phase in periods (1), 0 to 1; it stands still where there is no amplitude.
        double phase = 0;
    };
};

template <>
struct Describe<Vibration> {
    static constexpr std::string_view name = "vibration";
    static constexpr Field fields[] = {
        direction_row("direction", offsetof(Vibration, direction), "along which it pushes and pulls"),
        number_row("amplitude", offsetof(Vibration, amplitude), "N", "largest force"),
        number_row("frequency", offsetof(Vibration, frequency), "Hz", "periods per second", 0, 1e5),
        recovery_row(offsetof(Vibration, recovery)),
    };
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Vibration prepared(Vibration params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Vibration& params, const Vibration* previous, Vibration::State& state,
           const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const Vibration& params, Vibration::State& state, const Probe& probe, double dt) noexcept;

/// The frequency changes by itself, without a jump; the rest is cross-faded.
Vibration carried(const Vibration& old, const Vibration& next) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Vibration& params) noexcept;

}  // namespace knurl
