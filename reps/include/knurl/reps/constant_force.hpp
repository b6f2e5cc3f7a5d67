#pragma once
// A force and torque that do not depend on the probe: gravity, wind, or (badly) a contact computed elsewhere.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

struct ConstantForce {
    Vec3 force = {};              // N
    Vec3 torque = {};             // N m
    double recovery = automatic;  // s; 0: at once

    struct State {
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

ConstantForce prepared(ConstantForce params, const Limits& limits) noexcept;
void adopt(const ConstantForce& params, const ConstantForce* previous, ConstantForce::State& state,
           const Probe& probe) noexcept;
Wrench evaluate(const ConstantForce& params, ConstantForce::State& state, const Probe& probe,
                double dt) noexcept;
bool powerless(const ConstantForce& params) noexcept;

}  // namespace knurl
