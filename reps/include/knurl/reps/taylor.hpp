#pragma once
// A force field known near one point: F = F0 + J (p - p0), a Taylor series cut after its linear term.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// What is felt beyond the radius within which the series is to be believed. Both are edges of the energy, so that
/// a loop returns its work where the jacobian is symmetric; what is not symmetric is cut or held as a force.
enum class TaylorEdge : std::uint32_t {
    fade = 0,  // nothing: a smoothstep takes the energy away between 0.8 radius (or core) and radius
    hold = 1,  // radially the force at the rim, along the rim up to twice its part of the jacobian
};

namespace detail {
inline constexpr std::string_view taylor_edges[] = {"fade", "hold"};
}

/// What a hand holds (N/m): a field may push away no faster than that with the distance.
inline constexpr double hand_stiffness = 50;

struct Taylor {
    Vec3 origin = {};             // m, p0
    Vec3 force = {};              // N, F0: there
    Mat3 jacobian = {};           // N/m; negative: it pulls back to where F = 0
    double radius = 0.05;         // m
    double recovery = automatic;  // s; 0: at once
    TaylorEdge edge = TaylorEdge::fade;
    std::uint32_t reserved = 0;
    // The servo's, filled in by `prepared`:
    double stiffness = 0;  // N/m, no direction restores with more
    double core = 0.8;     // of `fade`: up to this share of its reach it is the series
    double level = 0;      // J, work at which the edge cuts: nothing is felt where it is that

    struct State {
        std::uint64_t unused = 0;
    };
};

template <>
struct Describe<Taylor> {
    static constexpr std::string_view name = "taylor";
    static constexpr Field fields[] = {
        vector_row("origin", offsetof(Taylor, origin), "m", "where the field is known"),
        vector_row("force", offsetof(Taylor, force), "N", "at the origin"),
        {.name = "jacobian",
         .type = Field::Type::matrix,
         .offset = offsetof(Taylor, jacobian),
         .unit = "N/m",
         .meaning = "how the force (rows) changes with the position (columns)",
         .minimum = -1e9,
         .maximum = 1e9,
         .count = 3},
        number_row("radius", offsetof(Taylor, radius), "m", "from the origin, where the field ends", 1e-6,
                   1e9),
        choice_row("edge", offsetof(Taylor, edge), "what is felt beyond the radius", detail::taylor_edges),
        recovery_row(offsetof(Taylor, recovery)),
    };
};

/// On a device the eigenvalues of the jacobian's symmetric part are clamped to [-k_max, hand_stiffness]:
/// below, the loop is not stable; above, the hand is thrown out. Without a device nothing is clamped. The
/// rest of the jacobian, the field's curl, stays as it is: it does the work pi r^2 |curl| in each turn of
/// radius r, which is the application's will. The edge counts as well: that of `fade` begins nearer to the
/// origin than 0.8 radius where it would restore or push away with more than k_max, and where even that is not
/// enough the whole field is scaled down; for `hold` the lower clamp is hand_stiffness / 3 nearer to 0.
Taylor prepared(Taylor params, const Limits& limits) noexcept;
void adopt(const Taylor& params, const Taylor* previous, Taylor::State& state, const Probe& probe) noexcept;
Wrench evaluate(const Taylor& params, Taylor::State& state, const Probe& probe, double dt) noexcept;
HandLoad load(const Taylor& params, const Taylor::State& state, const Probe& probe) noexcept;
bool powerless(const Taylor& params) noexcept;
std::optional<Bound> bound(const Taylor& params) noexcept;

}  // namespace knurl
