#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/friction.hpp>

#include "scene/clamped.hpp"

namespace knurl {
namespace {

using Vector = Eigen::Vector3d;

/// Sliding ends where the force falls below this share of the sliding force. With a larger share, noise would
/// end it.
constexpr double sticking_share = 0.7;
/// While stuck, the spring keeps the softest stiffness that it has had. Else a stiffness that flickers (the
/// shares of two surfaces in a corner) would make the tip creep. A rise by this ratio or more counts as a
/// change.
constexpr double stiffening = 1.25;

/// Steele, Lea & Flood 2014 (SplitMix64); evenly in [0, 1).
double draw(std::uint64_t& generator) noexcept {
    generator += 0x9e3779b97f4a7c15u;
    std::uint64_t z = generator;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

double next_distance(const FrictionLaw& law, FrictionState& state) noexcept {
    return std::max(0.0, law.d_mean + law.d_spread * (draw(state.generator) - 0.5));
}

/// The point on the way from `from` to `to` at `distance` from the origin; |from| <= distance <= |to|.
Vector at_distance(const Vector& from, const Vector& to, double distance) noexcept {
    const Vector way = to - from;
    const double a = way.squaredNorm(), b = from.dot(way), c = from.squaredNorm() - distance * distance;
    if (!(c < 0)) return from;
    const double root = std::sqrt(b * b - a * c);
    return from + std::min(1.0, b > 0 ? -c / (b + root) : (root - b) / a) * way;
}

/// One cycle of friction: `d` is the anchor as seen from the tip, in the tangent space.
struct Cycle {
    const FrictionLaw& law;
    FrictionState& state;
    const Tangent& tangent;
    const Vector& tip;
    double normal_force;  // N
    Vector d;             // m

    void let_go() noexcept {
        state.sliding = true;
        state.snag = tip + d;
        state.next = law.kind == FrictionLaw::Kind::coulomb ? std::numeric_limits<double>::infinity()
                                                            : next_distance(law, state);
    }

    /// Sets the spring's stiffness to `k` without raising its energy.
    void stiffen(double k) noexcept {
        if (state.sliding || k > stiffening * state.stiffness) {
            if (k > state.stiffness) d *= state.stiffness / k;  // the same force
            state.stiffness = k;
        } else {
            state.stiffness = std::min(state.stiffness, k);
        }
    }

    /// Elastic Coulomb friction, and passive snags, which behave alike until the next snag.
    void drag() noexcept {
        const double force = state.stiffness * d.norm(), sticks = law.static_ * normal_force;
        if (!state.sliding && force > sticks) let_go();
        if (!state.sliding) return;
        const double slides = law.dynamic * normal_force;
        const Vector before = d;
        if (force > slides)
            d *= slides / force;
        else if (force < sticking_share * slides)
            state.sliding = false;
        if (!state.sliding || law.kind != FrictionLaw::Kind::snag) return;
        const Vector snag = tangent.along(state.snag - tip);
        if (!((d - snag).norm() >= state.next)) return;
        // The snag's own place, not the place at which the cycle detected it, so that all rates give the
        // same.
        const Vector caught = snag + at_distance(before - snag, d - snag, state.next);
        if (state.stiffness * caught.norm() <= sticks) {
            d = caught;
            state.sliding = false;
        } else {  // it held and let go within this cycle
            let_go();
        }
    }

    /// The snags of Mark et al. 96, section 2.1: the spring acts only while stuck, and the anchor stays where
    /// it is.
    void snap(double resolution) noexcept {
        const double r = d.norm();
        if (!state.sliding) {
            if (r <= law.d_snap) return;
            if (law.d_snap > 0 && law.d_mean == 0) {  // always stuck
                d *= law.d_snap / r;
                return;
            }
            let_go();
            if (law.d_snap == 0) state.next = std::numeric_limits<double>::infinity();  // kinetic only
            state.farthest = r;
        }
        state.farthest = std::max(state.farthest, r);
        if (r >= state.next) {
            d *= r > 0 ? 1 - state.next / r : 0;
            state.sliding = false;
        } else if (state.farthest - r > 2 * resolution) {  // forward motion ceases
            d.setZero();
            state.sliding = false;
        }
    }
};

double spring_stiffness(const FrictionLaw& law, double normal_force, const Limits& limits) noexcept {
    return clamped_stiffness(law.stiffness + law.stiffness_per_newton * normal_force, limits);
}

void forget(FrictionState& state) noexcept {
    state = {.generator = state.generator, .seed = state.seed};
}

/// The force of the anchor's spring. With the paper's law, sliding gives kinetic friction away from the last
/// snag.
Vector spring_force(const FrictionLaw& law, const FrictionState& state, const Vector& d,
                    double normal_force) noexcept {
    if (law.kind == FrictionLaw::Kind::paper_snag && state.sliding) {
        const double r = d.norm();
        return r > 0 ? Vector(d * (law.dynamic * normal_force / r)) : Vector::Zero();
    }
    return state.stiffness * d;
}

/// The tip slides in another space: the new planes may not hold the last force. A line may turn in one cycle
/// by `dt` as a share of the residual's decay time; that loses no more force than the decay does in a cycle.
bool space_changed(const FrictionState& state, const Tangent& tangent, double dt) noexcept {
    if (state.dimensions != tangent.dimensions) return true;
    return tangent.dimensions == 1 && tangent.line.cross(state.line).squaredNorm() >
                                          std::min(1.0, dt * dt / (residual_decay * residual_decay));
}

/// The part of the last force that the anchor's spring holds in the new space, with the tip at its old place.
Vector still_held(const FrictionLaw& law, const FrictionState& state, const Tangent& tangent) noexcept {
    const Vector held = tangent.along(state.last);
    if (law.kind != FrictionLaw::Kind::paper_snag || !state.sliding) return held;
    const double part = held.norm();  // kinetic friction alone keeps its size
    return part > 0 ? Vector(held * (state.last.norm() / part)) : held;
}

/// True: the tip can slide in another space than in the last cycle.
bool rub(const FrictionLaw& law, FrictionState& state, const Tangent& tangent, const Rubbing& rubbing,
         const Limits& limits, double dt) noexcept {
    const double k = spring_stiffness(law, rubbing.normal_force, limits);
    if (state.seed != law.seed) state.generator = state.seed = law.seed;
    if (!state.held) {
        forget(state);
        state.held = true;
        state.anchor = state.snag = rubbing.position;
        state.stiffness = k;
        state.dimensions = tangent.dimensions;
        state.line = tangent.line;
        return false;
    }
    const Vector carried = dt * rubbing.surface_velocity;
    state.anchor += carried;
    state.snag += carried;

    if (state.residual_time > 0) {
        advance(state.residual_time, dt, [&](double share) {
            state.residual -= share * state.residual;
            state.viscous_residual -= share * state.viscous_residual;
            state.released -= share * state.released;
        });
    }
    const bool changed = space_changed(state, tangent, dt);
    if (changed) {
        // The whole last force that the new space does not hold: so losses that follow each other do not add
        // up.
        state.residual = clamped(state.last + state.residual, state.cone) - still_held(law, state, tangent);
        state.residual_time = residual_decay;
        state.farthest = 0;  // the motion is measured in another space from now on, so it has not ceased
    }
    state.dimensions = tangent.dimensions;
    state.line = tangent.line;

    Cycle cycle{.law = law,
                .state = state,
                .tangent = tangent,
                .tip = rubbing.position,
                .normal_force = rubbing.normal_force,
                .d = tangent.along(state.anchor - rubbing.position)};
    if (law.kind == FrictionLaw::Kind::paper_snag) {
        state.stiffness = k;
        cycle.snap(limits.resolution);
    } else {
        state.farthest = 0;
        cycle.stiffen(k);
        cycle.drag();
    }
    state.anchor = rubbing.position + cycle.d;
    state.last = spring_force(law, state, cycle.d, rubbing.normal_force);
    return changed;
}

}  // namespace

FrictionLaw friction_law(const Friction& friction, const Snag& snag, double surface_stiffness,
                         const Limits& limits) noexcept {
    FrictionLaw law{.stiffness = clamped_stiffness(surface_stiffness, limits), .viscous = friction.viscous};
    const bool sticks = snag.k_stick > 0 && snag.d_snap > 0;
    if (!sticks && !(snag.k_kinetic > 0)) {
        law.dynamic = friction.dynamic;
        law.static_ = friction.static_ == automatic ? friction.dynamic : friction.static_;
        return law;
    }
    law.seed = snag.seed;
    const double snaps = snag.k_stick * snag.d_snap;
    if (snag.law == SnagLaw::paper) {
        law.kind = FrictionLaw::Kind::paper_snag;
        law.stiffness = 0;
        law.stiffness_per_newton = snag.k_stick;
        law.static_ = snaps;
        law.dynamic = snag.k_kinetic;
    } else {
        if (snag.k_stick > 0)
            law.stiffness = clamped_stiffness(snag.k_stick * limits.newton /* 1 N */, limits);
        law.static_ = sticks ? snaps : snag.k_kinetic;
        law.dynamic = sticks && snag.d_mean > 0 ? std::min(snag.k_kinetic, snaps) : law.static_;
        if (sticks && snag.d_mean > 0) law.kind = FrictionLaw::Kind::snag;  // else it is Coulomb friction
    }
    law.d_snap = snag.d_snap;
    law.d_mean = snag.d_mean;
    law.d_spread = snag.d_spread;
    return law;
}

void clamp_material(double& stiffness, double& damping, Friction& friction, const Limits& limits) noexcept {
    stiffness = clamped_stiffness(stiffness, limits);
    damping = clamped_damping(damping, limits);
    friction.viscous = clamped_damping(friction.viscous, limits);
}

void add_share(FrictionLaw& sum, double& leading, const FrictionLaw& one, double share) noexcept {
    sum.stiffness += share * one.stiffness;
    sum.stiffness_per_newton += share * one.stiffness_per_newton;
    sum.static_ += share * one.static_;
    sum.dynamic += share * one.dynamic;
    sum.viscous += share * one.viscous;
    if (!(share > leading)) return;
    leading = share;
    sum.d_snap = one.d_snap;
    sum.d_mean = one.d_mean;
    sum.d_spread = one.d_spread;
    sum.seed = one.seed;
    sum.kind = one.kind;
}

Vector friction_force(const FrictionLaw& law, FrictionState& state, const Tangent& tangent,
                      const Rubbing& rubbing, const Limits& limits, double dt) noexcept {
    const double n = rubbing.normal_force;
    if (!(n > 0)) {
        if (dt > 0) forget(state);
        return Vector::Zero();
    }
    const bool changed = dt > 0 && rub(law, state, tangent, rubbing, limits, dt);
    Vector force = Vector::Zero();
    if (state.held) {
        const Vector d = tangent.along(state.anchor - rubbing.position);
        const double cone = std::max(law.static_, law.dynamic) * n;
        if (dt > 0) state.cone = cone;
        force = clamped(spring_force(law, state, d, n) + state.residual, cone);
        if (state.residual_time > 0) force += clamped(state.released, state.released_per_newton * n);
    }
    Vector viscous = Vector::Zero();
    if (law.viscous > 0) {
        const Vector relative = rubbing.velocity - rubbing.surface_velocity;
        viscous = clamped(-law.viscous * tangent.along(relative), n);
        // The tip can move in one direction more. As when it loses one, viscous friction there sets in
        // gradually.
        if (changed) state.viscous_residual = state.viscous - viscous;
        if (state.residual_time > 0)
            viscous = clamped(viscous + state.viscous_residual, std::min(n, law.viscous * relative.norm()));
        force += viscous;
    }
    if (dt > 0) state.viscous = viscous;
    return force;
}

}  // namespace knurl
