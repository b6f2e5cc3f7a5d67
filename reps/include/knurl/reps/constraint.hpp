#pragma once
// Holds the probe at a point, on a line or on a plane, from both sides: F = -k P (p - p0) - b P v with P = 1,
// 1 - u u^T or u u^T. Neither a dead zone at the target nor a distance from which on it lets go: either would
// chatter.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

enum class ConstraintShape : std::uint32_t { point = 0, line = 1, plane = 2 };

struct Constraint {
    Vec3 origin = {};             // m, the point, or one of the line or plane
    Vec3 direction = {0, 0, 1};   // of the line; normal of the plane; any length but none
    double stiffness = 0;         // N/m; infinity: as stiff as the device allows
    double damping = 0;           // N s/m; never more than the device stands
    double recovery = automatic;  // s; 0: at once
    ConstraintShape shape = ConstraintShape::point;
    std::uint32_t reserved = 0;

    struct State {
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

Constraint prepared(Constraint params, const Limits& limits) noexcept;
void adopt(const Constraint& params, const Constraint* previous, Constraint::State& state,
           const Probe& probe) noexcept;
Wrench evaluate(const Constraint& params, Constraint::State& state, const Probe& probe, double dt) noexcept;
HandLoad load(const Constraint& params, const Constraint::State& state, const Probe& probe) noexcept;
bool powerless(const Constraint& params) noexcept;

}  // namespace knurl
