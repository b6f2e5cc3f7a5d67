#pragma once
// The weight of something held: F = m g.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

struct Gravity {
    Vec3 acceleration = {0, 0, -9.81};  // m/s^2
    double mass = 0;                    // kg
    double recovery = 0.1;  // s, or automatic; 0: at once. A weight that is there at once is dropped

    struct State {
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

Gravity prepared(Gravity params, const Limits& limits) noexcept;
void adopt(const Gravity& params, const Gravity* previous, Gravity::State& state,
           const Probe& probe) noexcept;
Wrench evaluate(const Gravity& params, Gravity::State& state, const Probe& probe, double dt) noexcept;
bool powerless(const Gravity& params) noexcept;

}  // namespace knurl
