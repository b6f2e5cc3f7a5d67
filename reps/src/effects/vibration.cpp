#include <cmath>

#include <knurl/reps/vibration.hpp>

#include "scene/clamped.hpp"

namespace knurl {

Vibration prepared(Vibration params, const Limits& limits) noexcept {
    params.direction = to_plain(to_eigen(params.direction).normalized());
    // A hand needs at least four samples per period to feel a wave.
    if (limits.period > 0) params.frequency = std::min(params.frequency, 1 / (4 * limits.period));
    return params;
}

void adopt(const Vibration&, const Vibration* previous, Vibration::State& state, const Probe&) noexcept {
    if (!previous) state.phase = 0;
}

Wrench evaluate(const Vibration& params, Vibration::State& state, const Probe&, double dt) noexcept {
    if (powerless(params)) return {};
    state.phase += params.frequency * dt;
    state.phase -= std::floor(state.phase);
    return {.force = (params.amplitude * std::sin(2 * M_PI * state.phase)) * to_eigen(params.direction)};
}

Vibration carried(const Vibration& old, const Vibration& next) noexcept {
    Vibration out = old;
    out.frequency = next.frequency;
    out.recovery = next.recovery;
    return out;
}

bool powerless(const Vibration& params) noexcept {
    return params.amplitude == 0;
}

}  // namespace knurl
