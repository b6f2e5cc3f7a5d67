#pragma once

/// @file
/// A force field known near one point: F = F0 + J (p - p0), a Taylor series cut after its linear term.

#include <cstddef>

#include <knurl/reps/concepts.hpp>

namespace knurl {

/// What acts beyond the radius within which the series is valid. Both are edges of the energy, so that a loop
/// returns its work where the jacobian is symmetric; what is not symmetric is cut or held as a force.
enum class TaylorEdge : std::uint32_t {
    /// Nothing beyond: a smoothstep takes the energy away between 0.8 radius (or core) and radius.
    fade = 0,
    /// Beyond: radially the force at the rim, along the rim up to twice its part of the jacobian.
    hold = 1,
};

namespace detail {
inline constexpr std::string_view taylor_edges[] = {"fade", "hold"};
}

/// Stiffness that a hand holds (N/m): a field may push away no faster than that with the distance.
inline constexpr double hand_stiffness = 50;

/// A force field known near one point: F = F0 + J (p - p0), a Taylor series up to its linear term.
struct Taylor {
    /// Point p0 at which the field is known (m), world frame.
    Vec3 origin = {};
    /// Force F0 there (N).
    Vec3 force = {};
    /// Jacobian J: how the force (rows) changes with the position (columns) (N/m). Negative: it pulls back to
    /// where F = 0.
    Mat3 jacobian = {};
    /// Distance from the origin at which the field ends (m), 1e-6 or more.
    double radius = 0.05;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;
    /// What acts beyond the radius.
    TaylorEdge edge = TaylorEdge::fade;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Set by the servo in `prepared`: no direction restores with more (N/m).
    double stiffness = 0;
    /// Set by the servo in `prepared`, of `fade`: share of its reach up to which it is the series (1).
    double core = 0.8;
    /// Set by the servo in `prepared`: work at which the edge cuts (J); the field gives nothing where it is
    /// that.
    double level = 0;

    /// The servo's memory of one such representation.
    struct State {
        /// Nothing is remembered.
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
/// origin than 0.8 radius where it would restore or push away with more than k_max, and where even that is
/// not enough the whole field is scaled down; for `hold` the lower clamp is hand_stiffness / 3 nearer to 0.
Taylor prepared(Taylor params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Taylor& params, const Taylor* previous, Taylor::State& state, const Probe& probe) noexcept;
/// Returns the wrench on the hand (N, N m) about the probe's position, and advances `state` by `dt` (s).
Wrench evaluate(const Taylor& params, Taylor::State& state, const Probe& probe, double dt) noexcept;
/// Returns how stiff and how damped the hand feels this effect at the probe, for the budget.
HandLoad load(const Taylor& params, const Taylor::State& state, const Probe& probe) noexcept;
/// True: with these parameters the effect gives nothing anywhere, so it is not evaluated.
bool powerless(const Taylor& params) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Taylor& params) noexcept;

}  // namespace knurl
