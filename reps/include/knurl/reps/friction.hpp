#pragma once

/// @file
/// Friction along a solved contact. It acts once per probe, on the joint contact of all its surfaces: N = |F|
/// of the contact, sliding along what the active planes leave free. The tip is held by a spring to an anchor;
/// the anchor is what slides, so nothing creeps (Dupont et al. 2002 show why LuGre and Dahl models do).
/// Sources: elastic Coulomb friction as the god-object's cone (Zilles & Salisbury 1995; Salisbury et al.
/// 1995), snags Mark et al. 96, 2.1.

#include <cstdint>
#include <limits>

#include <knurl/reps/limits.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// Where the tip can slide on what it touches.
struct Tangent {
    /// Unit normal: direction of the contact force.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    /// Unit direction along the corner of two planes.
    Eigen::Vector3d line = Eigen::Vector3d::UnitX();
    /// 2: the tip slides across `normal`; 1: along `line`; 0: three planes hold it.
    std::uint32_t dimensions = 2;

    /// The part of v along which the tip can slide.
    Eigen::Vector3d along(const Eigen::Vector3d& v) const noexcept {
        if (dimensions == 2) return v - normal.dot(v) * normal;
        if (dimensions == 1) return line.dot(v) * line;
        return Eigen::Vector3d::Zero();
    }
};

/// Friction as the cycle needs it: of one surface, or of all that push together.
struct FrictionLaw {
    /// Stiffness of the anchor's spring (N/m).
    double stiffness = 0;
    /// Stiffness that the paper's snags add by normal force (1/m).
    double stiffness_per_newton = 0;
    /// Largest force by normal force until it slides (1).
    double static_ = 0;
    /// Largest force by normal force while it slides (1).
    double dynamic = 0;
    /// Viscous friction (N s/m).
    double viscous = 0;
    /// Snags: distance at which one lets go (m). Of several surfaces that push together, the distances of the
    /// one with the largest share count.
    double d_snap = 0;
    /// Snags: mean distance to the next one (m).
    double d_mean = 0;
    /// Snags: range of that distance (m).
    double d_spread = 0;
    /// Snags: seed of the distances' generator.
    std::uint32_t seed = 1;
    /// Which law.
    enum class Kind : std::uint32_t {
        /// Elastic Coulomb friction.
        coulomb = 0,
        /// Snags, passive.
        snag = 1,
        /// Snags by the paper's own law.
        paper_snag = 2,
    };
    /// Which law.
    Kind kind = Kind::coulomb;

    /// False: there is no friction.
    bool rubs() const noexcept { return static_ > 0 || dynamic > 0 || viscous > 0; }
};

/// The law of one surface. `surface_stiffness` (N/m, as applied) is the Coulomb anchor's too; nothing is
/// stiffer than `limits.max_stiffness`.
FrictionLaw friction_law(const Friction& friction, const Snag& snag, double surface_stiffness,
                         const Limits& limits) noexcept;

/// Adds one surface's law by its share of the normal force; the shares of a cycle add up to 1. `leading` is
/// the largest share so far and starts at 0.
void add_share(FrictionLaw& sum, double& leading, const FrictionLaw& one, double share) noexcept;

/// The servo's memory of one probe's friction.
struct FrictionState {
    /// The anchor (m); of the paper's law the last snag.
    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
    /// Where it last let go (m).
    Eigen::Vector3d snag = Eigen::Vector3d::Zero();
    /// Force of the anchor's spring in the last cycle (N).
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    /// Force that is being let go after the tangent space changed (N).
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();
    /// Viscous force in the last cycle (N).
    Eigen::Vector3d viscous = Eigen::Vector3d::Zero();
    /// Viscous force that is being let go with `residual` (N).
    Eigen::Vector3d viscous_residual = Eigen::Vector3d::Zero();
    /// Force of others (a texture that has ended) that is being let go with `residual` (N).
    Eigen::Vector3d released = Eigen::Vector3d::Zero();
    /// `Tangent::line` of the last cycle.
    Eigen::Vector3d line = Eigen::Vector3d::UnitX();
    /// Bound of `released` by normal force (1): it ends with the contact.
    double released_per_newton = std::numeric_limits<double>::infinity();
    /// Time left of all three residuals (s).
    double residual_time = 0;
    /// Bound of the spring's force in the last cycle (N).
    double cone = 0;
    /// Stiffness of the anchor's spring since it stuck (N/m).
    double stiffness = 0;
    /// Distance from the last snag to the next one (m).
    double next = 0;
    /// Farthest distance from the last snag (m): by it the paper's law sees that forward motion ceases.
    double farthest = 0;
    /// State of the generator of distances.
    std::uint64_t generator = 0;
    /// Seed with which the generator began.
    std::uint32_t seed = 0;
    /// `Tangent::dimensions` of the last cycle.
    std::uint32_t dimensions = 2;
    /// True: there is an anchor.
    bool held = false;
    /// True: the anchor is being dragged.
    bool sliding = false;
};

/// What the tip rubs with in this cycle.
struct Rubbing {
    /// Position of the probe (m).
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    /// Smooth velocity of the probe (m/s).
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    /// Velocity of the surface (m/s), which carries the anchor along.
    Eigen::Vector3d surface_velocity = Eigen::Vector3d::Zero();
    /// Normal force (N).
    double normal_force = 0;
};

/// The force on the hand (N), in the tangent space. No normal force: the anchor is forgotten. dt = 0: the
/// same force, no state advances. Never more than max(static_, dynamic) N, plus at most N of viscous force.
///
/// The anchor's spring never gives back more than it has stored, whatever the tip, the normal, the normal
/// force and the law do (except the paper's law): whenever its stiffness rises or the tangent space turns,
/// the anchor comes nearer.
///
/// Where the tangent space is another than before (the tip slides into a corner, out of it, from one corner
/// into another), force that acted and is not held any more, and viscous force that did not act before, is
/// let go or let in linearly within `residual_decay`: that part, and it alone, may point out of the tangent
/// space. So what a cycle adds is at most (except the paper's law)
///
///     k |dx| + b |dv|                what the tip does: its way and its change of velocity on the surface,
///     + |d cone| + |d slides| + |dN| what normal force and law do (and static - dynamic where it lets go,
///                                    and a spring that becomes softer, by as much),
///     + |F| sin                      by which a plane's normal turns: the contact's own force turns with it,
///     + 3 |F| dt / residual_decay    |F| the most that the last 10 ms held: 2 |F| of a residual that begins
///                                    with at most all that was felt and all that is held, 1 |F| of a
///                                    corner's line that turns too slowly to be another one.
///
/// `state.released` is the caller's to add to, with `residual_time`: it is let go in the same way, and the
/// bound does not count it. It is at most `state.released_per_newton` times the normal force.
Eigen::Vector3d friction_force(const FrictionLaw& law, FrictionState& state, const Tangent& tangent,
                               const Rubbing& rubbing, const Limits& limits, double dt) noexcept;

/// Time in which residuals are let go (s).
inline constexpr double residual_decay = 0.01;

}  // namespace knurl
