#pragma once
// The contact of a finite flat piece, the same for all outlines. An outline offers
//
//   normal()             unit, towards the front
//   height(q)            m, of q over its plane
//   holds(q, reach, by)  the foot of q lies within the piece, or beside it by no more than `by` (m), except
//                        for the rounding of coordinates of size `reach` (m)
//   reaches(q, r)        a probe of radius r at q meets the ball around the piece (of `bound`)
//   away(q)              m, from the nearest point of the piece to q, where the foot lies outside
//   seam(path)           m: anything within this distance touches it
//
// With a probe of radius r the piece is a thin plate with rounded edges until the centre has crossed it:
// height |p - x| - r along p - x, x the piece's nearest point. After that the height is -|h| - r along the
// normal of the side of entry. Where the centre crosses, both are -r.

#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/piece.hpp>

#include "surfaces/beside.hpp"
#include "surfaces/distance.hpp"
#include "surfaces/surface.hpp"

namespace knurl::piece {

using Eigen::Vector3d;

inline constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();

/// The result of one cycle: where the probe is, and the new state if time has passed.
struct Step {
    Vector3d q;  // m, the probe minus the piece's own motion
    double height;
    bool held;  // the foot lies within the piece
    std::int32_t side;
    std::int32_t touched;
    LetGo let_go;
};

/// As a share of the seam: a proxy farther than this from the face is not held by it. Less is rounding.
inline constexpr double off_of_seam = 1e-6;

inline std::int32_t side_of(double height, std::int32_t otherwise) noexcept {
    return height > 0 ? 1 : height < 0 ? -1 : otherwise;
}

inline bool can_enter(std::int32_t from, Sides sides) noexcept {
    return from > 0 || sides == Sides::both;
}

/// The share of a path at which it crosses a plane; `from`, `to`: heights of its ends (m). A path that comes
/// from `side`, but begins behind the plane by rounding or a touch, crosses at its beginning.
inline double crossed_at(double from, double to, std::int32_t side) noexcept {
    return side * from > 0 ? from / (from - to) : 0;
}

template <class Outline>
Step follow(const Outline& outline, Sides sides, const PieceState& state, const Vector3d& q,
            double radius) noexcept {
    const double height = outline.height(q), reach = q.lpNorm<1>();
    Step now{.q = q,
             .height = height,
             .held = outline.holds(q, reach, 0),
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
    if (!outline.reaches(q, radius)) return now;  // the path has led past the piece
    const Vector3d last = to_eigen(state.last);
    const Vector3d crossing = last + crossed_at(outline.height(last), height, state.side) * (q - last);
    if (!outline.holds(crossing, reach + last.lpNorm<1>(), 0)) return now;
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

/// The contact of an untouched piece with a probe at `at`: the nearest point, or none.
struct Rim {
    Vector3d normal;
    double height;
    LetGo let_go;
};

template <class Outline>
Rim rim(const Outline& outline, Sides sides, const Vector3d& at, double over, bool held, std::int32_t side,
        LetGo let_go, double radius) noexcept {
    constexpr double nothing = std::numeric_limits<double>::infinity();
    if (held && !can_enter(side, sides)) return {side * outline.normal(), nothing, LetGo::from_behind};
    Rim out{side * outline.normal(), 0, let_go};
    const Vector3d away = held ? Vector3d::Zero() : outline.away(at);
    if (away.isZero(0)) {
        out.height = std::abs(over) - radius;
    } else {
        const Distance edge(away);
        out.normal = edge.direction;
        out.height = edge.length - radius;
    }
    if (out.height >= 0) out.let_go = LetGo::no;
    if (out.let_go != LetGo::no) out.height = nothing;
    return out;
}

inline void begin_cycle(PieceState& state) noexcept {
    state.start = state.last;
    state.was_side = state.met ? state.side : 0;
    state.was_touched = state.touched;
    state.was_let_go = state.let_go;
    state.left = state.brushed = 0;
}

/// A piece beside others: see ProxyPath and contact_beside.
template <class Piece, class Outline>
class Beside {
  public:
    Beside(const Piece& params, const Outline& outline, PieceState& state, const Vector3d& q, double radius,
           ProxyPath& path) noexcept
        : params_(params),
          outline_(outline),
          state_(state),
          q_(q),
          radius_(radius),
          path_(path),
          seam_(outline.seam(path)) {}

    void brush() noexcept {
        state_.brushed = 1;
        state_.brush = to_plain(path_.to);
    }

    void come_back(double dt) noexcept {
        if (path_.first) state_.brushed = 0;
        if (!(dt > 0)) return;
        if (!state_.met) {
            state_.side = side(outline_.height(q_ + path_.to), path_.to, 1);
            state_.last = to_plain(q_ + path_.to);
        }
        if (state_.touched == 0) state_.let_go = rim_at(to_eigen(state_.last), state_.side).let_go;
        if (state_.out != 0) {
            state_.side = state_.touched;
            state_.touched = 0;
            state_.out = 0;
        }
        begin_cycle(state_);
        go_from_start();
        state_.met = 1;
        if (path_.passes) state_.last = to_plain(q_ + path_.to);
    }

    void rewind() noexcept {
        state_.touched = state_.was_touched;
        state_.side = state_.was_side;
        state_.let_go = state_.was_let_go;
        go_from_start();
        state_.left = state_.out = state_.brushed = 0;
    }

    void look() noexcept {
        if (state_.touched != 0) {
            const Vector3d to = q_ + path_.to;
            state_.out = is_back() && !path_.holds_harder &&
                         state_.touched * outline_.height(to) > off_of_seam * seam_;
            if (state_.out == 0 && !holds(to, slack())) path_.left = true;
            if (state_.handed != 0 && holds(to, 0)) state_.handed = 0;
            state_.last = to_plain(to);
            return;
        }
        const Way found = way();
        if (found.crossed <= 1) {
            if (can_enter(found.from, params_.sides)) {
                path_.when = std::min(path_.when, found.crossed);
            } else {
                state_.let_go = LetGo::from_behind;
            }
        }
        state_.side = found.to;
        state_.last = to_plain(q_ + path_.to);
    }

    void near() noexcept {
        const Vector3d to = q_ + path_.to;
        // A piece that is about to let go does not count itself.
        if (state_.touched != 0 && !holds(to, slack())) return;
        // The same distance as that within which the others are evaluated.
        if (!outline_.reaches(to, radius_)) return;
        const double away = holds(to, 0) ? std::abs(outline_.height(to)) : outline_.away(to).norm();
        path_.close += away <= near_in_seams * seam_ + radius_;
    }

    void overlap() noexcept {
        if (holds_centre() || state_.brushed != 0) return;
        const Rim felt = rim_of(path_.to);
        if (path_.commits) state_.let_go = felt.let_go;
        path_.deepest = std::max(path_.deepest, -felt.height);
    }

    void enter() noexcept {
        if (state_.touched != 0) return;
        const Way found = way();
        if (!(found.crossed <= path_.when) || !can_enter(found.from, params_.sides)) return;
        state_.touched = found.from;
        state_.handed = !path_.hold.isZero(0);
        state_.let_go = LetGo::no;
    }

    void leave() noexcept {
        state_.from = state_.last;
        state_.from_side = state_.side;
        if (state_.touched == 0) return;
        const Vector3d to = q_ + path_.to;
        if (state_.out != 0) return;
        if (holds(to, path_.close > 0 ? seam_ : slack())) {
            state_.handed = !holds(to, 0);
            return;
        }
        path_.left = true;
        state_.let_go = is_back() ? LetGo::no : LetGo::slipped;
        state_.side = side_of(outline_.height(q_), -state_.touched);
        state_.touched = 0;
        state_.handed = 0;
        state_.left = 1;
    }

    Contact answer() const noexcept {
        if (state_.touched != 0 && !(state_.brushed != 0 && state_.out != 0)) {
            return contact_of(params_, state_.touched * outline_.normal(),
                              state_.touched * outline_.height(q_) - radius_);
        }
        // A piece that the proxy has not reached holds nothing. Exception: a probe with a radius that
        // overlaps the piece is held by the plane at the proxy.
        if (state_.brushed == 0) return {.height = std::numeric_limits<double>::infinity()};
        const Vector3d offset = to_eigen(state_.brush);
        const Rim felt = rim_of(offset);
        return contact_of(params_, felt.normal, felt.height - felt.normal.dot(offset));
    }

  private:
    // Is the probe back in front? Then the piece alone would hold nothing, but together with other surfaces
    // it may still hold the proxy.
    bool is_back() const noexcept { return side_of(outline_.height(q_), -state_.touched) == state_.touched; }

    void go_from_start() noexcept {
        state_.from = state_.start;
        state_.from_side = state_.was_side;
    }

    bool holds_centre() const noexcept { return state_.touched != 0 && state_.out == 0; }

    Rim rim_of(const Vector3d& offset) const noexcept {
        const Vector3d at = q_ + offset;
        return rim_at(at, side(outline_.height(at), offset, state_.side));
    }

    // How the path crosses the piece's plane. A path that begins clearly in front crosses with any motion to
    // the back. A path that begins within a seam of the plane crosses once nothing holds it in front any
    // more.
    struct Way {
        std::int32_t from, to;  // sides
        double crossed = 2;     // share of the way at which it crosses the piece itself
    };
    Way way() const noexcept {
        const Vector3d from = to_eigen(state_.from), to = q_ + path_.to;
        const double above = outline_.height(from), below = outline_.height(to);
        Way way{state_.from_side, side(below, path_.to, state_.from_side)};
        if (way.from == 0) way.from = way.to;  // the probe has not met the piece before
        const bool through = way.from * above > 0 && way.from * below < 0;
        if ((way.from == way.to && !through) || state_.let_go == LetGo::from_behind || state_.left != 0 ||
            !outline_.reaches(to, radius_))
            return way;
        const double crossed = crossed_at(above, below, way.from);
        const Vector3d at = from + crossed * (to - from);
        const double reach = to.lpNorm<1>() + from.lpNorm<1>();
        if (outline_.holds(at, reach, path_.hold.isZero(0) ? 0 : seam_)) {
            way.crossed = crossed;
        } else if (can_enter(way.from, params_.sides) && outline_.holds(at, reach, seam_)) {
            path_.grazed = true;
            path_.graze = at - q_;
        }
        return way;
    }

    bool holds(const Vector3d& at, double by) const noexcept {
        return outline_.holds(at, at.lpNorm<1>(), by);
    }
    double slack() const noexcept { return state_.handed != 0 || path_.joined ? seam_ : 0; }

    Rim rim_at(const Vector3d& at, std::int32_t side) const noexcept {
        return rim(outline_, params_.sides, at, outline_.height(at), holds(at, 0), side, state_.let_go,
                   radius_);
    }

    // A path within a seam of the plane is on the side towards which the probe is held, if the piece can be
    // entered from there. Otherwise a surface that pushes the probe towards the back would bring it behind
    // the piece without a crossing.
    std::int32_t side(double height, const Vector3d& held, std::int32_t otherwise) const noexcept {
        const double facing = outline_.normal().dot(held);
        const std::int32_t to = facing > 0 ? 1 : -1;
        if (std::abs(height) <= seam_ && std::abs(facing) > 1e-6 * held.norm() &&
            can_enter(to, params_.sides))
            return to;
        return side_of(height, otherwise);
    }

    const Piece& params_;
    const Outline& outline_;
    PieceState& state_;
    const Vector3d& q_;
    double radius_;
    ProxyPath& path_;
    double seam_;
};

template <class Outline>
void report_to_path(const PieceState& state, const Step& now, const Outline& outline,
                    ProxyPath& path) noexcept {
    path.entered = path.entered || (state.touched == 0 && now.touched != 0);
    path.left = path.left || (now.touched == 0 && now.let_go == LetGo::slipped && state.let_go != now.let_go);
    if (!state.met || state.touched != 0 || now.touched != 0 || now.side == state.side) return;
    const Vector3d last = to_eigen(state.last);
    const Vector3d at = last + crossed_at(outline.height(last), now.height, state.side) * (now.q - last);
    path.grazed =
        path.grazed || outline.holds(at, now.q.template lpNorm<1>() + last.lpNorm<1>(), outline.seam(path));
}

template <class Piece, class Outline>
Contact contact(const Piece& params, const Outline& outline, PieceState& state, const Probe& probe,
                double dt) noexcept {
    move_on(state.motion, dt);
    const Vector3d q = probe.position - state.motion.time * to_eigen(params.velocity);
    if (probe.path && probe.path->stage != ProxyPath::Stage::free)
        return contact_beside(Beside(params, outline, state, q, probe.radius, *probe.path), probe.path->stage,
                              dt);
    Step now = follow(outline, params.sides, state, q, probe.radius);
    if (probe.path) probe.path->holds = now.touched != 0;
    if (probe.path && dt > 0) report_to_path(state, now, outline, *probe.path);
    Vector3d normal = (now.touched != 0 ? now.touched : now.side) * outline.normal();
    double height = now.touched * now.height - probe.radius;
    if (now.touched == 0) {
        const Rim felt =
            rim(outline, params.sides, now.q, now.height, now.held, now.side, now.let_go, probe.radius);
        normal = felt.normal;
        height = felt.height;
        now.let_go = felt.let_go;
    }
    if (dt > 0) {
        begin_cycle(state);
        state.last = to_plain(now.q);
        state.met = 1;
        state.side = now.side;
        state.touched = now.touched;
        state.let_go = now.let_go;
        state.handed = state.out = 0;
    }
    return contact_of(params, normal, height);
}

/// A new place may carry the piece past the probe. Then a probe at rest has crossed the piece if its foot lay
/// within the piece before and after. A held probe stays held as long as it is still behind.
template <class Piece, class Outline>
void adopt(const Piece& params, const Outline& outline, const Piece& previous, const Outline& old,
           PieceState& state) noexcept {
    const Vector3d seen = to_eigen(state.last);
    const Vector3d last = seen + state.motion.time * to_eigen(previous.velocity);
    place(state.motion);
    if (!state.met) return;
    state.last = to_plain(last);
    const std::int32_t turned = old.normal().dot(outline.normal()) < 0 ? -1 : 1;  // the piece was turned over
    const std::int32_t from = turned * state.side;
    state.touched *= turned;
    state.side = side_of(outline.height(last), from);
    if (state.touched != 0 || state.side == from || state.let_go == LetGo::from_behind ||
        !old.holds(seen, seen.lpNorm<1>(), 0) || !outline.holds(last, last.lpNorm<1>(), 0)) {
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
    state.out = 0;
    state.let_go = LetGo::no;
}

}  // namespace knurl::piece
