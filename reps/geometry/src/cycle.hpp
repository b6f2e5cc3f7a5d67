#pragma once
// One cycle of a proxy on a surface, in metres from the surface's origin.
//
//   free:     hand in the box known to be empty? ──> nothing.   sweep last..hand ──> miss: nothing; hit: touching
//   touching: walk ──> hand behind: held.   in front (or slipped over a rim): sweep proxy..hand
//             ──> miss: free; hit another face: on it, and walk again

#include <bit>
#include <cmath>
#include <limits>

#include <knurl/geometry/proxy.hpp>

#include "active_set.hpp"
#include "mesh_surface.hpp"
#include "sweep.hpp"
#include "walk.hpp"

namespace knurl::detail {

template <class S>
class Cycle {
  public:
    Cycle(const S& s, const Vec& origin, Proxy& proxy, const Vec& hand, double radius, Foot& foot,
          Work& work) noexcept
        : s_(s),
          origin_(origin),
          proxy_(proxy),
          hand_(hand),
          h_(hand - origin),
          radius_(radius > 0 ? radius : 0),
          foot_(foot),
          work_(work) {}

    bool run() noexcept {
        using Phase = Proxy::Phase;
        if (proxy_.phase == Phase::touching && s_.has(proxy_.face)) {
            if (still_there()) return true;
        } else if (proxy_.phase == Phase::free && in_room()) {
            return stay_free();
        }
        if (!(h_.sum_of_sizes() < 1e12)) {  // NaN, or too far away
            proxy_ = Proxy{};
            return false;
        }
        // Includes the rounding of the coordinates, where the hand is far away.
        hair_ =
            std::max(hair_of_size * s_.size(), 64 * std::numeric_limits<double>::epsilon() * h_.largest());
        if (proxy_.phase == Phase::fresh || !s_.has(proxy_.face)) {
            proxy_ = Proxy{};
            return reach() || stay_free();
        }
        rest_.face = proxy_.face;
        if (proxy_.phase == Phase::tangled) return tangle(map(proxy_.at));
        if (proxy_.phase == Phase::touching) return contact(map(proxy_.at));
        const Hit hit = sweep(s_, map(proxy_.last), h_, hair_ / 2, work_, any);
        if (!hit.whole) return stay_free(hit.point);
        if (hit.face == no_face) {
            if (reach()) return true;
            look_for_room();
            return stay_free();
        }
        rest_.face = hit.face;
        return contact(hit.point);
    }

  private:
    static constexpr auto any = [](std::uint32_t, const Corners&, double) { return true; };
    static constexpr std::uint8_t patience = 8;  // cycles between two searches for free room

    /// Most cycles: the hand is still behind the last cycle's face.
    bool still_there() noexcept {
        const std::uint32_t f = proxy_.face;
        return (s_.flags(f) & face_crossed) == 0 && (behind(f) || next_door(f));
    }
    bool behind(std::uint32_t f) noexcept {
        const Corners face = s_.corners(f);
        const Vec ab = face.side(0), bc = face.side(1), ca = face.side(2), a = h_ - face.at[0];
        const Vec normal = ca.cross(ab);
        const double height = normal.dot(a);
        if (!(height <= 0 && normal.dot(ab.cross(a)) > 0 && normal.dot(bc.cross(h_ - face.at[1])) > 0 &&
              normal.dot(ca.cross(h_ - face.at[2])) > 0))
            return false;
        const double inverse = 1 / normal.norm(), depth = -height * inverse;
        const Vec n = normal * inverse;
        return touch(f, h_ + n * depth, n, depth + radius_);
    }
    /// Where faces are so small that a hand leaves one in nearly every cycle: the hand is behind the next
    /// one, over an edge, not a corner. The walk would find the same.
    [[gnu::noinline]] bool next_door(std::uint32_t f) noexcept {
        const Corners face = s_.corners(f);
        const Vec normal = face.side(2).cross(face.side(0));
        std::uint32_t out = 3;
        for (std::uint32_t i = 0; i < 3; ++i) {
            const Vec from = h_ - face.at[i], side = face.side(i);
            if (normal.dot(side.cross(from)) > 0) continue;
            const double along = side.dot(from);
            if (out != 3 || !(along > 0 && along < side.squaredNorm())) return false;
            out = i;
        }
        if (out == 3 || !(normal.dot(h_ - face.at[0]) <= 0)) return false;
        const Link link = s_.over(f, out);
        if (link == no_link || (s_.flags(face_of(link)) & face_crossed) != 0) return false;
        if (!behind(face_of(link))) return false;
        ++work_.faces;
        return true;
    }

    Vec map(const double (&p)[3]) const noexcept {
        return {p[0] - origin_[0], p[1] - origin_[1], p[2] - origin_[2]};
    }
    void put(double (&to)[3], const Vec& p) const noexcept {
        for (int axis = 0; axis < 3; ++axis) to[axis] = p[axis];
    }

    bool in_room() const noexcept {
        return h_[0] > proxy_.low[0] && h_[1] > proxy_.low[1] && h_[2] > proxy_.low[2] &&
               h_[0] < proxy_.high[0] && h_[1] < proxy_.high[1] && h_[2] < proxy_.high[2] &&
               radius_ <= kept(proxy_.kept);
    }
    bool stay_free() noexcept {
        proxy_.phase = Proxy::Phase::free;
        put(proxy_.at, hand_);
        put(proxy_.last, hand_);
        return false;
    }
    /// A limit was reached: the next cycle sweeps the rest of the way.
    bool stay_free(const Vec& swept) noexcept {
        stay_free();
        no_room();
        put(proxy_.last, origin_ + swept);
        return false;
    }
    void no_room() noexcept { proxy_.low[0] = 1, proxy_.high[0] = 0; }

    // A radius kept in 16 bits, rounded up.
    static float kept(std::uint16_t bits) noexcept { return std::bit_cast<float>(std::uint32_t{bits} << 16); }
    static std::uint16_t keep(double radius) noexcept {
        return radius > 0 ? static_cast<std::uint16_t>(
                                (std::bit_cast<std::uint32_t>(static_cast<float>(radius)) >> 16) + 1)
                          : std::uint16_t{0};
    }
    void look_for_room() noexcept {
        no_room();
        if (proxy_.since < patience) {
            ++proxy_.since;
            return;
        }
        proxy_.since = 0;
        const double step = (h_ - map(proxy_.last)).norm();
        proxy_.kept = keep(radius_);
        const double spare = kept(proxy_.kept);
        const double half =
            s_.room(h_, std::max(64 * step, s_.size() / 32) + spare, work_) - spare - 2 * hair_;
        if (!(half > 4 * step)) return;
        for (int axis = 0; axis < 3; ++axis) {
            proxy_.low[axis] = at_least(h_[axis] - half);
            proxy_.high[axis] = at_most(h_[axis] + half);
        }
        proxy_.since = patience;  // where there was room, more is likely
    }

    // NOLINTNEXTLINE(readability-function-cognitive-complexity): in the cycle, a split costs inlining
    bool contact(Vec from) noexcept {
        const Vec begin = from;
        const std::uint32_t first = rest_.face;
        bool crossed = false;
        for (;;) {
            walk(s_, h_, rest_, work_);
            crossed = crossed || rest_.crossed || rest_.knotted;
            if (rest_.crossed && passes_below(from)) return tangle(lifted(from, rest_.visited[0]));
            const double distance = std::sqrt(rest_.near.square);
            if (!rest_.settled) return touch(rest_.near.height > 0 ? 0 : distance + radius_);
            if (!rest_.outward && !rest_.slipped) return touch(distance + radius_);
            if (!rest_.slipped && distance <= hair_) return touch(radius_);
            from = rest_.near.point;
            const double bound = rest_.near.square * strictly, length = (h_ - from).norm();
            const Hit hit =
                sweep(s_, from, h_, hair_ / 2, work_, [&](std::uint32_t, const Corners& corners, double t) {
                    // Leaves out the face on which the walk rests: the hand is no nearer to it.
                    return t * length > hair_ || nearest_on(corners, h_).square < bound;
                });
            if (!hit.whole) return stay_free(hit.point);
            if (hit.face == no_face) {
                if (crossed)
                    return tangle(lifted(begin, first));  // it may have come out behind the crossing
                                                          // face
                if (reach()) return true;
                no_room();
                proxy_.since = patience;
                return stay_free();
            }
            rest_.face = hit.face;
            from = hit.point;
            if (work_.sweeps >= max_sweeps) {
                rest_.near = nearest_on(s_.corners(hit.face), hit.point);
                rest_.near.point = hit.point;
                rest_.near.square = (h_ - hit.point).squaredNorm();
                rest_.outward = false;
                return touch(std::sqrt(rest_.near.square) + radius_);
            }
        }
    }

    Vec lifted(const Vec& p, std::uint32_t face) const noexcept {
        return p + unit_or_zero(s_.corners(face).normal()) * (lift_of_size * s_.size());
    }
    /// True: a face that the walk does not know lies between its start and its end.
    bool passes_below(const Vec& from) noexcept {
        ++work_.guards;
        Work sweeping;
        sweeping.nodes = work_.nodes;
        const double lift = lift_of_size * s_.size();
        const Vec end = lifted(rest_.near.point, rest_.face);
        const auto unknown = [&](std::uint32_t face, const Corners& corners, double) {
            // Behind it by more than the lift over another face explains.
            return !rest_.has_visited(face) &&
                   unit_or_zero(corners.normal()).dot(end - corners.at[0]) < -1.01 * lift;
        };
        const Hit hit =
            sweep(s_, lifted(from, rest_.visited[0]), end, slack_of_lift * lift, sweeping, unknown);
        work_.nodes = sweeping.nodes;
        return hit.face != no_face || !hit.whole;
    }
    bool tangle(const Vec& from) noexcept {
        const Held held = hold(s_, from, h_, work_);
        if (held.whole && held.faces == 0) {
            // Where surfaces cross at a small angle the point may slip between them, so the walk must agree.
            if (rest_.visits == 0) walk(s_, h_, rest_, work_);
            if (rest_.settled && !rest_.outward && !rest_.slipped)
                return touch(std::sqrt(rest_.near.square) + radius_);
            if (reach()) return true;
            no_room();
            return stay_free();
        }
        const std::uint32_t face = held.face != no_face ? held.face : rest_.face;
        // After a limit, the point is still moving along the planes of faces, and may be off all of these
        // faces.
        const Vec foot = held.whole ? held.foot : nearest_on(s_.corners(face), held.foot).point;
        const Vec way = foot - h_;
        const double distance = way.norm();
        // A point that is still moving may not be held.
        const double depth = held.whole ? distance + radius_ : 0;
        const Vec normal = distance > lift_of_size * s_.size() ? way * (1 / distance)
                                                               : unit_or_zero(s_.corners(face).normal());
        touch(face, foot, normal, depth);
        put(proxy_.at, origin_ + held.at);
        if (held.faces != 1 || (s_.flags(face) & face_crossed) != 0) proxy_.phase = Proxy::Phase::tangled;
        return true;
    }

    /// A ball touches the surface from its front although its centre does not reach it.
    bool reach() noexcept {
        if (!(radius_ > 0)) return false;
        double square = radius_ * radius_;
        std::uint32_t found = no_face;
        s_.nearer(h_, square, work_, [&](std::uint32_t face) {
            const Nearest near = nearest_on(s_.corners(face), h_);
            if (near.height > 0 && near.square < square) square = near.square, found = face;
        });
        if (found == no_face) return false;
        rest_.face = found;
        walk(s_, h_, rest_, work_);
        if (!rest_.settled || !rest_.outward || !(rest_.near.square < radius_ * radius_)) return false;
        return touch(radius_ - std::sqrt(rest_.near.square));
    }

    bool touch(double depth) noexcept {
        const Nearest& near = rest_.near;
        const Vec d = h_ - near.point;
        const double distance = d.norm();
        Vec normal;
        if (near.place == within || !(distance > 1e-12 * s_.size())) {
            normal = unit_or_zero(pseudonormal(s_, rest_.face, near));
            if (!(normal.squaredNorm() > 0.5))
                normal = unit_or_zero(near.normal);  // at a knife's edge, either normal
        } else {
            normal = d * ((rest_.outward ? 1 : -1) / distance);
        }
        return touch(rest_.face, near.point, normal, depth);
    }
    bool touch(std::uint32_t face, const Vec& x, const Vec& normal, double depth) noexcept {
        const Vec at = origin_ + x;
        foot_.point = to_eigen(at);
        foot_.normal = to_eigen(normal);
        foot_.depth = depth;
        foot_.face = face;
        foot_.triangle = s_.triangle(face);
        foot_.material = s_.material(face);
        proxy_.phase = Proxy::Phase::touching;
        proxy_.face = face;
        put(proxy_.at, at);
        put(proxy_.last, hand_);
        return true;
    }

    const S& s_;
    const Vec origin_;
    Proxy& proxy_;
    const Vec hand_;
    const Vec h_;
    const double radius_;
    double hair_ = 0;
    Foot& foot_;
    Work& work_;
    Rest rest_;
};

}  // namespace knurl::detail
