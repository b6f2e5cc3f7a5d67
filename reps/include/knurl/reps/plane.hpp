#pragma once
// The half-space n.x >= offset is free; below it the hand feels max(0, k depth - b v.n) n.
// Source: Mark et al., SIGGRAPH 96, section 2.1.

#include <cstddef>
#include <optional>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// How a plane that changes under the hand reaches its new place.
enum class PlaneUpdate : std::uint32_t {
    fade = 0,        // cross-fade of the old set's force to the new set's (default)
    paper = 1,       // lowered to the probe if it embeds it, then raised linearly (paper, figure 7)
    last_depth = 2,  // starts with the depth that was felt, then raised linearly (VRPN's variant)
};

/// What `recovery = automatic` means to `paper` and `last_depth`: the paper's own figure.
inline constexpr double paper_recovery = 0.05;  // s

struct Plane {
    Vec3 normal = {0, 0, 1};      // towards free space; a length other than 1 divides offset too
    double offset = 0;            // m
    double stiffness = 0;         // N/m; infinity: as stiff as the device allows
    double damping = 0;           // N s/m
    double recovery = automatic;  // s; 0: at once
    PlaneUpdate update = PlaneUpdate::fade;
    std::uint32_t reserved = 0;

    struct State {
        double lowered = 0;      // m, how far below its place the plane still is (paper, last_depth)
        double remaining = 0;    // s, until it has arrived
        double last_height = 0;  // m, of the probe over the plane in the last cycle
        std::uint64_t met = 0;   // 1 once evaluated
    };
};

template <>
struct Describe<Plane> {
    static constexpr std::string_view name = "plane";
    static constexpr std::string_view updates[] = {"fade", "paper", "last_depth"};
    static constexpr Field fields[] = {
        {.name = "normal",
         .type = Field::Type::vector,
         .offset = offsetof(Plane, normal),
         .unit = "1",
         .meaning = "towards free space",
         .minimum = -1e9,
         .maximum = 1e9,
         .nonzero = true},
        {.name = "offset",
         .offset = offsetof(Plane, offset),
         .unit = "m",
         .meaning = "n.x >= offset is free",
         .minimum = -1e9,
         .maximum = 1e9},
        {.name = "stiffness",
         .offset = offsetof(Plane, stiffness),
         .unit = "N/m",
         .meaning = "force per depth",
         .minimum = 0,
         .maximum = 1e9,
         .infinity_allowed = true},
        {.name = "damping",
         .offset = offsetof(Plane, damping),
         .unit = "N s/m",
         .meaning = "along the normal, never pulling",
         .minimum = 0,
         .maximum = 1e9},
        {.name = "recovery",
         .offset = offsetof(Plane, recovery),
         .unit = "s",
         .meaning = "time over which a change reaches the hand",
         .minimum = 0,
         .maximum = 1000,
         .automatic_allowed = true},
        {.name = "update",
         .type = Field::Type::choice,
         .offset = offsetof(Plane, update),
         .meaning = "how a change reaches the hand",
         .choices = updates},
    };
};

Plane prepared(Plane params, const Limits& limits) noexcept;
void adopt(const Plane& params, const Plane* previous, Plane::State& state, const Probe& probe) noexcept;
Contact contact(const Plane& params, Plane::State& state, const Probe& probe, double dt) noexcept;

/// A plane that fades stands still between changes: the scene scans it with all others, without a call.
std::optional<HalfSpace> standing(const Plane& params) noexcept;
/// The paper's update and last_depth bring their own recovery; the scene does not cross-fade them.
bool recovers_itself(const Plane& params) noexcept;
/// Arrives at once.
void settle(const Plane& params, Plane::State& state) noexcept;

}  // namespace knurl
