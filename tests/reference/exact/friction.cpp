#include "friction.hpp"

namespace exact {

/// Uniform over the spread, from the numbers of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
void Friction::draw_next(State& s, const Law& law) {
    std::uint64_t z = law.seed + ++s.draws * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    const Real even = static_cast<Real>((z ^ (z >> 31)) >> 11) / 9007199254740992.0L;  // 2^53
    s.next = std::max(Real(0), law.d_mean + law.d_spread * (even - 0.5L));
}

V Friction::act(State& s, const Law& law, const Sliding& surface, const V& x, Real normal_force) {
    if (!s.held) {
        s = {.held = true, .anchor = x, .snag = x, .draws = s.draws};
        return {};
    }
    const V stretch = surface.along(s.anchor - x);
    s.anchor = x + stretch;  // the part along the normal is lost for good
    const Real length_ = length(stretch);
    if (law.kind == Law::Kind::paper) {
        if (!s.sliding && length_ > law.d_snap) {
            if (law.d_mean == 0) {  // snags everywhere: the anchor is dragged at the longest stretch
                s.anchor = x + law.d_snap / length_ * stretch;
            } else {
                s.sliding = true, s.farthest = 0;
                draw_next(s, law);
            }
        }
        if (s.sliding) {
            s.farthest = std::max(s.farthest, length_);
            if (length_ >= s.next && length_ > 0) {
                s.anchor += -s.next / length_ * stretch;  // the tip has passed the next snag, which holds it
                s.sliding = false;
            } else if (s.farthest - length_ > 2 * law.resolution) {
                s.anchor = x;
                s.sliding = false;
            }
        }
        const V from = surface.along(s.anchor - x);
        const Real ahead = length(from);
        if (!s.sliding) {  // the force is at most what the snag can hold, however long the step
            const Real most = std::max(law.stiffness * law.d_snap, law.dynamic) * normal_force;
            const Real k = std::min(normal_force * law.stiffness, law.max_stiffness);
            return (k * ahead > most ? most / ahead : k) * from;
        }
        return ahead > 0 ? normal_force * law.dynamic / ahead * from : V{};
    }
    const Real force = law.stiffness * length_;
    if (s.sliding && force < 0.7L * law.dynamic * normal_force) s.sliding = false;
    if (!s.sliding && force > law.static_ * normal_force) {
        s.sliding = true;
        s.snag = s.anchor;
        draw_next(s, law);
    }
    const Real most = law.dynamic * normal_force;
    if (!s.sliding) return law.stiffness * stretch;
    // The anchor follows in a straight line until it meets the next snag, at the distance `next` from the
    // place where the last one let go.
    const V kept = force > most ? most / force * stretch : stretch, way = kept - stretch;
    if (law.kind == Law::Kind::snag) {
        const V start = surface.along(s.anchor - s.snag);
        const Real a = dot(way, way), b = dot(start, way), c = dot(start, start) - s.next * s.next;
        if (c + 2 * b + a >= 0) {
            const Real share = c >= 0 ? 0 : (-b + std::sqrt(b * b - a * c)) / a;
            const V met = stretch + share * way;
            if (law.stiffness * length(met) <= law.static_ * normal_force) {
                s.sliding = false;
                s.anchor = x + met;
                return law.stiffness * met;
            }
            s.anchor = s.snag = x + kept;  // it does not hold: this step passes it and all others on its way
            draw_next(s, law);
            return law.stiffness * kept;
        }
    }
    s.anchor = x + kept;
    return law.stiffness * kept;
}

V Friction::step(const Law& law, const Sliding& surface, const V& x, const V& velocity, const V& carried,
                 Real normal_force, Real dt) {
    if (!(normal_force > 0)) {
        if (dt > 0) state_.held = false;
        return {};
    }
    State next = state_;
    next.anchor += dt * carried;
    next.snag += dt * carried;
    V force = act(next, law, surface, x, normal_force);
    if (dt > 0) state_ = next;
    const V slip = surface.along(velocity - carried);
    const Real drag = law.viscous * length(slip);
    if (drag > 0) force += -std::min(drag, normal_force) / length(slip) * slip;
    return force;
}

}  // namespace exact
