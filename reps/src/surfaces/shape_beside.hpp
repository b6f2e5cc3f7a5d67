#pragma once
// A shape beside others (proxy_path.hpp). Its god-object follows the proxy of all surfaces minus the shape's
// own push, that is, the probe displaced by the push of the others. Where no other surface pushes, it follows
// the probe.
//
//        push of the others           The point x satisfies all surfaces. It is also the shape's point
//     t <------------------ probe     at which the walk towards t = x - own push comes to rest. So
//      \  own push                    the solver and the walk alternate until both agree.
//       x
//
// All lengths and directions are in the asset's frame.

#include <algorithm>
#include <limits>

#include <knurl/reps/shape.hpp>

#include "surfaces/beside.hpp"
#include "surfaces/surface.hpp"

namespace knurl::shapes {

using Eigen::Quaterniond;
using Eigen::Vector3d;

inline Vector3d at(const double (&from)[3]) noexcept {
    return {from[0], from[1], from[2]};
}
inline void put(double (&to)[3], const Vector3d& from) noexcept {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

inline bool touches(Proxy::Phase phase) noexcept {
    return phase == Proxy::Phase::touching || phase == Proxy::Phase::tangled;
}

/// m: anything within this distance touches the shape.
inline double seam_of(const Asset& asset) noexcept {
    return seam_of_size * (asset.high - asset.low).norm();
}

/// If the normals of two faces have a larger cosine than this, the faces form no rim: one continues the
/// other.
inline constexpr double along = 0.9;
/// A face blocks the way if its normal and the reversed way have at least this cosine.
inline constexpr double stops = 1e-4;
/// As a share of the seam: less than this is rounding.
inline constexpr double little_of_seam = 1e-6;
/// The most times that the shape lets go in one cycle.
inline constexpr std::uint8_t most_left = 2;

inline void begin_cycle(Shape::State& state) noexcept {
    const bool holds = touches(state.proxy.phase);
    state.was_phase = state.proxy.phase;
    state.was_face = state.proxy.face;
    state.tries = 0;
    state.start = to_plain(at(holds ? state.proxy.at : state.proxy.last));
}

inline void hold_by(Shape::State& state, const Vector3d& normal, double offset,
                    std::uint32_t material) noexcept {
    state.normal = to_plain(normal);
    state.offset = offset;
    state.material = material;
}

class Beside {
  public:
    /// `rounding` (m): of the hand's coordinates.
    Beside(Shape::State& state, const Quaterniond& turn, const Vector3d& hand, double rounding, double radius,
           ProxyPath& path) noexcept
        : state_(state),
          turn_(turn),
          hand_(hand),
          radius_(radius),
          path_(path),
          seam_(seam_of(*state.asset)),
          little_(std::max(little_of_seam * seam_, rounding)) {}

    void come_back(double dt) noexcept {
        if (!(dt > 0)) return;
        Proxy& proxy = state_.proxy;
        if (proxy.phase == Proxy::Phase::fresh) put(proxy.last, place());
        // A probe that overlaps the shape while its centre is outside starts each cycle free: overlaps are
        // found anew, the deepest first.
        if (state_.brushed != 0) free_at(at(proxy.last) + in_asset(path_.to));
        if (!holds()) free_at(path_.passes ? place() : at(proxy.last));
        if (state_.anew != 0 && holds()) find_plane();
        state_.left = state_.leaving = 0;
        begin_cycle(state_);
    }

    void rewind() noexcept {
        state_.left = state_.leaving = 0;
        const bool held = touches(state_.was_phase), brushed = state_.brushed != 0;
        if (held && holds() && !brushed) return;  // it goes on over the surface from where it is
        free_at(to_eigen(state_.start));
        if (!held || brushed) return;
        state_.proxy.phase = Proxy::Phase::touching;
        state_.proxy.face = state_.was_face;
    }

    void look() noexcept {
        if (holds()) return look_on();
        if (state_.left >= most_left) return;
        Foot foot;
        path_.when = std::min(path_.when, way_in(foot));
        put(state_.proxy.last, place());
    }

    void near() noexcept {
        if (holds() && state_.leaving != 0) return;
        Foot foot;
        path_.close += facing(place(), near_in_seams * seam_ + radius_, Vector3d::Zero(), -2, foot);
    }

    void enter() noexcept {
        if (holds() || state_.left >= most_left) return;
        Foot foot;
        if (!(way_in(foot) <= path_.when)) return;
        hold_on(foot, foot.point);
        state_.handed = 0;
    }

    void leave() noexcept {
        if (!holds()) return put(state_.proxy.at, at(state_.proxy.last));
        if (state_.leaving == 0) return;
        state_.leaving = 0;
        if (path_.close > 0 && reaches_on()) return;
        path_.left = true;
        ++state_.left;
        state_.handed = 0;
        Proxy next = state_.proxy;
        Foot foot;
        // It slides over an edge of the shape itself; no other surface continues there.
        if (path_.close == 0 && walk(next, target(), foot)) return turn_to(next, foot);
        free_at(place());
    }

    void overlap() noexcept {
        Proxy next = state_.proxy;
        Foot foot;
        if (!holds() && walk(next, place(), foot)) path_.deepest = std::max(path_.deepest, foot.depth);
    }

    void brush() noexcept {
        Proxy next = state_.proxy;
        Foot foot;
        if (!holds() && walk(next, place(), foot)) turn_to(next, foot);
    }

    /// m: of the probe's surface over the holding plane; infinity: it does not hold.
    double height() const noexcept {
        if (!holds()) return std::numeric_limits<double>::infinity();
        return normal().dot(hand_) - state_.offset - radius_;
    }

  private:
    bool holds() const noexcept { return touches(state_.proxy.phase); }
    Vector3d normal() const noexcept { return to_eigen(state_.normal); }
    Vector3d in_asset(const Vector3d& world) const noexcept { return turn_.conjugate() * world; }

    /// The target of the god-object: the probe, displaced by the push of the others.
    Vector3d target() const noexcept {
        return path_.joined ? hand_ + in_asset(path_.to - path_.push) : hand_ + in_asset(path_.to);
    }
    /// The proxy.
    Vector3d place() const noexcept {
        return path_.joined ? hand_ + in_asset(path_.to) : hand_ + in_asset(path_.to + path_.push);
    }
    /// The proxy's foot on the shape's own plane.
    Vector3d foot_of_proxy() const noexcept {
        const Vector3d t = target();
        return t + (state_.offset - normal().dot(t)) * normal();
    }

    void free_at(const Vector3d& where) noexcept {
        Proxy& proxy = state_.proxy;
        proxy.phase = Proxy::Phase::free;
        put(proxy.at, where);
        put(proxy.last, where);
        state_.handed = state_.brushed = 0;
    }

    bool walk(Proxy& next, const Vector3d& to, Foot& foot) const noexcept {
        Work work;
        return follow(*state_.asset, next, to, radius_, foot, work);
    }
    bool facing(const Vector3d& where, double within, const Vector3d& normal, double least,
                Foot& foot) const noexcept {
        Work work;
        return facing_near(*state_.asset, where, within, normal, least, foot, work);
    }

    // The shape has got another asset, to which the kept plane does not belong.
    void find_plane() noexcept {
        Foot foot;
        if (facing(at(state_.proxy.at), seam_, Vector3d::Zero(), -2, foot)) hold_on(foot, foot.point);
        state_.anew = 0;
    }

    void hold_on(const Foot& foot, const Vector3d& where) noexcept {
        Proxy& proxy = state_.proxy;
        proxy.phase = Proxy::Phase::touching;
        proxy.face = foot.face;
        put(proxy.at, where);
        hold_by(state_, foot.normal, foot.normal.dot(foot.point), foot.material);
    }

    void turn_to(const Proxy& next, const Foot& foot) noexcept {
        state_.proxy = next;
        state_.brushed = foot.depth < radius_;
        hold_by(state_, foot.normal, foot.normal.dot(foot.point), foot.material);
    }

    /// Would the foot's plane, in place of the present one, move the proxy by more than rounding?
    bool differs(const Foot& foot) const noexcept {
        const double away = std::abs(foot.normal.dot(foot.point) - foot.normal.dot(foot_of_proxy()));
        const double leans = path_.push.norm() * (foot.normal - normal()).norm();
        return away + leans > little_;
    }

    void look_on() noexcept {
        Proxy next = state_.proxy;
        Foot foot;
        const bool held = walk(next, target(), foot) && lies_on_it(foot);
        // After the shape has let go in this cycle, a face that the proxy meets again holds it, wherever the
        // walk ends.
        if (held && (state_.left > 0 || (!drops(foot) && !clings(foot)))) return go_on(next, foot);
        if (path_.push.isZero(0) && !held) return come_off();
        if ((state_.handed != 0 || path_.joined) && reaches_on()) return;
        if (held && stays_on_plane()) return;
        path_.left = true;
        state_.leaving = 1;
    }

    // Other surfaces hold the proxy off the shape. If the probe is still behind the shape's plane, that plane
    // stays: it may hold the probe in a stiffer layer, and does so as soon as the others let go.
    void come_off() noexcept {
        if (path_.joined && normal().dot(hand_) < state_.offset && reaches_on()) return;
        if (!path_.turns) return;
        free_at(place());
        path_.turned = true;  // a stiffer layer was solved with this plane
    }

    // On a way within the plane of a face, rounding may report a face that is not there. It counts if it
    // continues the present plane, or if the shape really has a face at the foot.
    bool lies_on_it(const Foot& foot) const noexcept {
        Foot same;
        return foot.normal.dot(normal()) >= along || facing(foot.point, little_, Vector3d::Zero(), -2, same);
    }

    // Has the walk gone over an edge, to a face behind the present plane? If that face is behind by less
    // than a seam, it counts only if it is turned away.
    bool drops(const Foot& foot) const noexcept {
        const double behind = state_.offset - normal().dot(foot.point);
        if (behind > seam_) return true;
        if (foot.normal.dot(normal()) >= along || behind < -little_) return false;
        return behind > little_ || foot.normal.dot(foot_of_proxy() - foot.point) > -little_;
    }

    // Has the walk stopped at a rim, or at an edge beyond which the surface leans back, although no face
    // there blocks the way?
    bool clings(const Foot& foot) const noexcept {
        const Vector3d on = foot_of_proxy() - foot.point;
        const double far = on.norm();
        // The turn of the plane is compared, since rounding does not hide it: small turns that pass unnoticed
        // in each cycle would add up.
        const double least = std::min(little_of_seam, little_ / (2 * path_.push.norm()));
        if (!(far > little_) || !((foot.normal - normal()).dot(on) < -least * far)) return false;
        if (std::abs(normal().dot(foot.point) - state_.offset) > little_) return false;
        Foot stop;
        return !facing(foot.point, little_, on / -far, stops, stop);
    }

    void go_on(const Proxy& next, const Foot& foot) noexcept {
        state_.handed = state_.leaving = 0;
        if (!differs(foot)) {
            state_.proxy = next;
            state_.brushed = foot.depth < radius_;
        } else if (path_.turns) {
            turn_to(next, foot);
            path_.turned = true;
        }
    }

    // Is the proxy beyond a rim by no more than a seam?
    bool reaches_on() noexcept {
        Foot foot;
        if (!facing(foot_of_proxy(), seam_, normal(), along, foot)) return false;
        state_.handed = 1;
        state_.leaving = 0;
        if (differs(foot)) {
            if (!path_.turns) return true;
            path_.turned = true;
            hold_on(foot, foot.point);
            return true;
        }
        state_.proxy.phase = Proxy::Phase::touching;
        state_.proxy.face = foot.face;
        put(state_.proxy.at, foot.point);
        return true;
    }

    // At a corner the walk may drop over a rim, since it goes to the face nearest to the target. But if the
    // present plane continues below the target, it holds the probe as before.
    bool stays_on_plane() noexcept {
        constexpr double same = 1 - 1e-9;  // cosine
        Foot foot;
        if (!facing(foot_of_proxy(), little_, normal(), same, foot)) return false;
        state_.handed = state_.leaving = 0;
        state_.proxy.phase = Proxy::Phase::touching;
        state_.proxy.face = foot.face;
        put(state_.proxy.at, foot.point);
        return true;
    }

    // For a hand that other surfaces hold, the way is lifted off them by a seam and descends at its end. So
    // it passes over a step lower than a seam, and does not meet its side.
    double way_in(Foot& foot) const noexcept {
        Work work;
        const Vector3d from = at(state_.proxy.at), to = place();
        const Vector3d hold = in_asset(path_.hold);
        if (hold.isZero(0)) {
            const double when = first_front(*state_.asset, from, to, 0, hold, foot, work);
            if (!(when <= 1)) graze(from, to);
            return when;
        }
        const Vector3d lift = seam_ * hold.normalized();
        const double reach = state_.left == 0 ? seam_ : 0;
        const double over = first_front(*state_.asset, from + lift, to + lift, reach, lift, foot, work);
        if (over <= 1) return over;
        return first_front(*state_.asset, to + lift, to, 0, lift, foot, work) <= 1 ? 1 : 2;
    }

    // Nothing holds the probe, and it passes close to a face.
    void graze(const Vector3d& from, const Vector3d& to) const noexcept {
        Work work;
        Foot foot;
        const double when = first_front(*state_.asset, from, to, seam_, from - to, foot, work);
        if (!(when <= 1)) return;
        path_.grazed = true;
        path_.graze = turn_ * (from + when * (to - from) - hand_);
    }

    Shape::State& state_;
    const Quaterniond& turn_;
    const Vector3d hand_;
    const double radius_;
    ProxyPath& path_;
    const double seam_, little_;
};

}  // namespace knurl::shapes
