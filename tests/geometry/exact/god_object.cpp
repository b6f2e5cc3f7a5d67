#include "god_object.hpp"

namespace exact {

namespace {

constexpr Real behind = 1e-12L;  // of the size: a probe behind a face by less than this has not passed it
constexpr Real moved = 1e-16L;   // of the size

}  // namespace

void GodObject::put(const V& at, int face) {
    at_ = at, face_ = face, touching_ = met_ = true;
}
void GodObject::let_go(const V& hand) {
    at_ = last_ = hand, touching_ = false, met_ = true;
}

/// Goes from face to face as long as the next one has a point nearer to the hand. The present point is on
/// both faces. The nearest point x of a convex set satisfies |y - h|^2 >= |x - h|^2 + |x - y|^2 for any y of
/// the set, so it is enough, and more accurate, to check whether the point moves.
Nearest3 GodObject::descend(const V& hand) {
    const Surface& s = *surface_;
    Nearest3 here = s.nearest(face_, hand);
    const Real least = moved * s.size();
    for (int steps = 0; steps < 10'000'000; ++steps) {
        if (here.edge >= 0) {
            const int next = s.over(face_, here.edge);
            if (next < 0) return here;
            const Nearest3 there = s.nearest(next / 3, hand);
            if (!(distance(there.point, here.point) > least)) return here;
            face_ = next / 3, here = there;
        } else if (here.corner >= 0) {
            int best = -1;
            Nearest3 best_there;
            Real shortest = distance(here.point, hand);
            for (const int f : s.fan(face_, here.corner)) {
                const Nearest3 there = s.nearest(f, hand);
                const Real d = distance(there.point, hand);
                if (!(distance(there.point, here.point) > least) || !(d <= shortest)) continue;
                shortest = d, best = f, best_there = there;
            }
            if (best < 0) return here;
            face_ = best, here = best_there;
        } else {
            return here;
        }
    }
    ++unsettled_;
    return here;
}

/// At a rim the surface holds the god-object only if one of its faces blocks the way to the hand.
bool GodObject::held(const Nearest3& rest, const V& hand) const {
    const V n = surface_->pseudonormal(face_, rest);
    if (!(dot(hand - at_, n) <= 0)) return false;
    return !surface_->rim(face_, rest) || surface_->blocked(at_, at_ + 1e-6L * surface_->size() * n, hand);
}

bool GodObject::step(const V& hand) {
    const Surface& s = *surface_;
    if (!met_) {
        let_go(hand);
        return false;
    }
    if (!touching_) {
        const Crossing hit = s.sweep(last_, hand, behind * s.size());
        if (hit.face >= 0) put(last_ + hit.t * (hand - last_), hit.face);
    }
    for (int round = 0; touching_; ++round) {
        const Nearest3 rest = descend(hand);
        at_ = rest.point;
        if (held(rest, hand)) break;
        // No face at `at` blocks the way to the hand.
        const Crossing hit = s.sweep(at_, hand, behind * s.size(), &at_);
        if (hit.face < 0) {
            let_go(hand);
        } else if (round == 1000) {
            ++unsettled_;
            break;
        } else {
            put(at_ + hit.t * (hand - at_), hit.face);
        }
    }
    if (!touching_) at_ = hand;
    last_ = hand;
    return touching_;
}

}  // namespace exact
