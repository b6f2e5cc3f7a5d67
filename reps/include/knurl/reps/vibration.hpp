#pragma once
// A buzz: F = A sin(2 pi phase) along a direction. The phase is a sum over the servo's own steps, phase += f
// dt, never a clock's reading, so a change of frequency bends the wave and does not break it.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

struct Vibration {
    Vec3 direction = {0, 0, 1};   // any length but none
    double amplitude = 0;         // N
    double frequency = 100;       // Hz; never more than 1 / (4 T), a quarter of the servo's rate
    double recovery = automatic;  // s; 0: at once

    struct State {
        static constexpr bool moves_alike = true;
        double phase = 0;  // 1, of a period, 0 to 1; it stands where there is no amplitude
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

Vibration prepared(Vibration params, const Limits& limits) noexcept;
void adopt(const Vibration& params, const Vibration* previous, Vibration::State& state,
           const Probe& probe) noexcept;
Wrench evaluate(const Vibration& params, Vibration::State& state, const Probe& probe, double dt) noexcept;

/// The frequency changes by itself, without a jump; the rest is cross-faded.
Vibration carried(const Vibration& old, const Vibration& next) noexcept;
bool powerless(const Vibration& params) noexcept;

}  // namespace knurl
