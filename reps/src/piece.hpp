#pragma once
// The contact of a finite flat piece, the same for all outlines. An outline offers
//
//   normal()          unit, towards the front
//   height(q)         m, of q over its plane
//   holds(q, reach)   the foot of q lies within the piece, but for rounding of coordinates of that size (m)
//   reaches(q, r)     a probe of radius r at q meets the ball around the piece (of `bound`)
//   away(q)           m, from the nearest point of the piece to q, where the foot lies outside
//
// With a probe of radius r the piece is a thin plate with rounded edges until the centre has crossed it:
// height |p - x| - r along p - x, x the piece's nearest point. After that it is -|h| - r along the normal of
// the side of entry: both meet in -r where the centre crosses.

#include <cmath>
#include <limits>

#include <knurl/reps/piece.hpp>

#include "distance.hpp"
#include "surface.hpp"

namespace knurl::piece {

using Eigen::Vector3d;

inline constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();

/// What one cycle finds out: where the probe is, and what the state becomes if time has passed.
struct Step {
    Vector3d q;  // m, the probe, less what the piece has moved on by
    double height;
    bool held;  // the foot lies within the piece
    std::int32_t side;
    std::int32_t touched;
    LetGo let_go;
};

inline std::int32_t side_of(double height, std::int32_t otherwise) noexcept {
    return height > 0 ? 1 : height < 0 ? -1 : otherwise;
}

inline bool can_enter(std::int32_t from, Sides sides) noexcept {
    return from > 0 || sides == Sides::both;
}

template <class Outline>
Step follow(const Outline& outline, Sides sides, const PieceState& state, const Vector3d& q,
            double radius) noexcept {
    const double height = outline.height(q), reach = q.lpNorm<1>();
    Step now{.q = q,
             .height = height,
             .held = outline.holds(q, reach),
             .side = side_of(height, state.met ? state.side : 1),
             .touched = state.touched,
             .let_go = state.let_go};
    if (now.touched != 0) {
        const bool back = now.side == now.touched;
        if (!back && !now.held) now.let_go = LetGo::slipped;
        if (back || !now.held || !can_enter(now.touched, sides)) now.touched = 0;
        return now;
    }
    if (!state.met || now.side == state.side || now.let_go == LetGo::from_behind) return now;
    if (!outline.reaches(q, radius)) return now;  // it has led past the piece, whichever way
    // The path of this cycle crosses the plane; where?
    const Vector3d last = to_eigen(state.last);
    const double before = outline.height(last);
    const Vector3d crossing = last + before / (before - height) * (q - last);
    if (!outline.holds(crossing, reach + last.lpNorm<1>())) return now;
    now.let_go = LetGo::no;
    if (!can_enter(state.side, sides)) {
        now.let_go = LetGo::from_behind;
    } else if (now.held) {
        now.touched = state.side;
    } else {
        now.let_go = LetGo::slipped;
    }
    return now;
}

template <class Piece, class Outline>
Contact contact(const Piece& params, const Outline& outline, PieceState& state, const Probe& probe,
                double dt) noexcept {
    constexpr double nothing = std::numeric_limits<double>::infinity();
    move_on(state.motion, dt);
    const Vector3d q = probe.position - state.motion.time * to_eigen(params.velocity);
    Step now = follow(outline, params.sides, state, q, probe.radius);
    Vector3d normal = (now.touched != 0 ? now.touched : now.side) * outline.normal();
    double height = now.touched * now.height - probe.radius;
    if (now.touched == 0) {
        if (now.held && !can_enter(now.side, params.sides)) {
            now.let_go = LetGo::from_behind;
            height = nothing;
        } else {
            const Vector3d away = now.held ? Vector3d::Zero() : outline.away(now.q);
            if (away.isZero(0)) {
                height = std::abs(now.height) - probe.radius;
            } else {
                const Distance rim(away);
                normal = rim.direction;
                height = rim.length - probe.radius;
            }
            if (height >= 0) now.let_go = LetGo::no;
            if (now.let_go != LetGo::no) height = nothing;
        }
    }
    if (dt > 0) {
        state.last = to_plain(now.q);
        state.met = 1;
        state.side = now.side;
        state.touched = now.touched;
        state.let_go = now.let_go;
    }
    return contact_of(params, normal, height);
}

/// A change of place may carry the piece past the probe. Then the probe, which did not move, has crossed it
/// if its foot lay within the piece before and after; and a probe that it holds stays held where it is still
/// behind.
template <class Piece, class Outline>
void adopt(const Piece& params, const Outline& outline, const Piece& previous, const Outline& old,
           PieceState& state) noexcept {
    const Vector3d seen = to_eigen(state.last);
    const Vector3d last = seen + state.motion.time * to_eigen(previous.velocity);
    place(state.motion);
    if (!state.met) return;
    state.last = to_plain(last);
    const std::int32_t turned = old.normal().dot(outline.normal()) < 0 ? -1 : 1;  // sent the other way round
    const std::int32_t from = turned * state.side;
    state.touched *= turned;
    state.side = side_of(outline.height(last), from);
    if (state.touched != 0 || state.side == from || state.let_go == LetGo::from_behind ||
        !old.holds(seen, seen.lpNorm<1>()) || !outline.holds(last, last.lpNorm<1>())) {
        return;
    }
    if (can_enter(from, params.sides)) {
        state.touched = from;
    } else {
        state.let_go = LetGo::from_behind;
    }
}

inline void forget(PieceState& state) noexcept {
    state.met = 0;
    state.touched = 0;
    state.let_go = LetGo::no;
}

}  // namespace knurl::piece
