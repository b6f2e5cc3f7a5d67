#pragma once
// A box beside others: which face the proxy's path enters, and when that face lets go (proxy_path.hpp).

#include <knurl/reps/proxy_path.hpp>

#include "surfaces/beside.hpp"
#include "surfaces/box_faces.hpp"

namespace knurl::boxes {

// m: anything within this distance touches the box.
inline double seam_of(const Vector3d& half) noexcept {
    return seam_of_size * 2 * half.maxCoeff();
}

// As a share of the seam: a proxy farther than this from a face is not held by it. Less is rounding.
inline constexpr double off_of_seam = 1e-6;

// The way of a proxy that other surfaces hold, in the box's frame.
struct Way {
    Vector3d from, to;
    Vector3d hold;    // the push that held the probe at the start of the way
    Vector3d around;  // ... at its end
};

inline bool faces(double part, const Vector3d& held) noexcept {
    return part > 1e-6 * held.lpNorm<1>();
}

// Does the face extend to where the path crosses it? It extends beyond its edges by a seam (without a hold,
// by rounding). Exception: a face against which the probe is not held ends a seam short of an edge to a face
// against which it is, so that a step lower than a seam does not stop the proxy.
inline bool goes_as_far(const Face& face, const Vector3d& at, const Vector3d& half,
                        const Vector3d& hold) noexcept {
    const double seam = (hold.isZero(0) ? off_of_seam : 1) * seam_of(half);
    const bool facing = faces(face.sign * hold[face.axis], hold);
    for (int i = 0; i < 3; ++i) {
        if (i == face.axis) continue;
        const bool ends_below = !facing && faces(at[i] < 0 ? -hold[i] : hold[i], hold);
        if (!(std::abs(at[i]) - half[i] <= (ends_below ? -seam : seam))) return false;
    }
    return true;
}

struct Crossing {
    std::uint32_t face = 0;  // 0: none
    double when = 2;         // share of the way
};

// The first face that the way enters from its front. A way that begins behind a face by less than a seam
// counts as in front of it if the probe is held against that face.
inline Crossing first_face(const Way& way, const Vector3d& half) noexcept {
    const double seam = seam_of(half);
    Crossing first;
    double first_facing = 0;
    for (std::uint32_t number = 1; number <= 6; ++number) {
        const Face face(number);
        const double held = face.sign * way.hold[face.axis], holds = face.sign * way.around[face.axis];
        const double above = -face.depth(way.from, half), below = face.depth(way.to, half);
        // A path along a face must not enter it by rounding.
        const double little = off_of_seam * seam;
        const double behind = faces(held, way.hold) ? seam : little;
        const double within = above <= 0 && faces(holds, way.around) ? seam
                              : faces(held, way.hold)                ? 0
                                                                     : little;
        if (!(above >= -behind) || !(below > within)) continue;
        const double when = above > 0 ? above / (above + below) : 0;
        if (when > first.when || (when == first.when && held <= first_facing)) continue;
        if (!goes_as_far(face, way.from + when * (way.to - way.from), half, way.hold)) continue;
        first = {number, when};
        first_facing = held;
    }
    return first;
}

// The face of a probe that is inside and came through no face: it was first seen there, or entered by less
// than rounding.
inline std::uint32_t face_about(const Vector3d& y, const Vector3d& half, const Vector3d& around) noexcept {
    const double seam = seam_of(half), little = around.isZero(0) ? 0 : off_of_seam * seam;
    for (int i = 0; i < 3; ++i) {
        const double depth = half[i] - std::abs(y[i]);
        if (!(depth > (faces(y[i] < 0 ? -around[i] : around[i], around) ? seam : little))) return 0;
    }
    return nearest_face(y, half);
}

// Where a path through free space first comes within a seam of the box, by the first such face (share of the
// way; 2: it does not).
inline double grazed(const Vector3d& from, const Vector3d& to, const Vector3d& half) noexcept {
    const double far = seam_of(half) + (to - from).lpNorm<1>();
    if (!((to.cwiseAbs() - half).maxCoeff() <= far)) return 2;
    return first_face({from, to, from - to, Vector3d::Zero()}, half).when;
}

inline void begin_cycle(Box::State& state) noexcept {
    state.start = state.last;
    state.was_met = state.met != 0;
    state.was_face = state.face;
    state.was_slipped = state.slipped;
    state.left = state.brushed = 0;
}

// A box beside others: see ProxyPath and contact_beside.
class Beside {
  public:
    Beside(const Box& box, Box::State& state, const Seen& seen, double radius, ProxyPath& path) noexcept
        : box_(box),
          state_(state),
          seen_(seen),
          half_(to_eigen(box.half_size)),
          radius_(radius),
          path_(path),
          seam_(seam_of(half_)) {}

    void brush() noexcept {
        state_.brushed = 1;
        state_.brush = to_plain(path_.to);
    }

    void come_back(double dt) noexcept {
        if (path_.first) state_.brushed = 0;
        if (!(dt > 0)) return;
        if (!state_.met) state_.last = to_plain(there(path_.to));
        if (state_.slipped != 0) state_.slipped = distance(to_eigen(state_.last)) < radius_;
        if (state_.out != 0) state_.face = state_.slipped = state_.out = 0;
        begin_cycle(state_);
        go_from_start();
        state_.met = 1;
        if (path_.passes) state_.last = to_plain(there(path_.to));
    }

    void rewind() noexcept {
        state_.face = state_.was_face;
        state_.slipped = state_.was_slipped;
        go_from_start();
        state_.left = state_.out = state_.brushed = 0;
    }

    void look() noexcept {
        if (state_.face != 0) {
            const Vector3d to = there(path_.to);
            state_.out =
                is_back() && !path_.holds_harder && -Face(state_.face).depth(to, half_) > off_of_seam * seam_;
            if (state_.out == 0 && !holds(to, slack())) path_.left = true;
            if (state_.handed != 0 && holds(to, 0)) state_.handed = 0;
            state_.last = to_plain(to);
            return;
        }
        path_.when = std::min(path_.when, crossing().when);
        state_.last = to_plain(there(path_.to));
    }

    void near() noexcept {
        const Vector3d at = there(path_.to);
        // A box that is about to let go does not count itself.
        if (state_.face != 0 && !holds(at, slack())) return;
        // The same distance as that within which the others are evaluated.
        if (!(at.norm() <= half_.norm() + radius_)) return;
        path_.close += distance(at) <= near_in_seams * seam_ + radius_;
    }

    void overlap() noexcept {
        if ((state_.face != 0 && state_.out == 0) || state_.brushed != 0) return;
        Hold hold{0, state_.slipped != 0};
        const Contact felt = rim_of(path_.to, hold);
        if (path_.commits) state_.slipped = hold.slipped;
        path_.deepest = std::max(path_.deepest, -felt.height);
    }

    void enter() noexcept {
        if (state_.face != 0) return;
        const Crossing found = crossing();
        if (!(found.when <= path_.when)) return;
        state_.face = static_cast<std::uint16_t>(found.face);
        state_.handed = !path_.hold.isZero(0);
        state_.slipped = 0;
    }

    void leave() noexcept {
        state_.from = state_.last;
        state_.from_met = 1;
        if (state_.face == 0) return;
        const Vector3d to = there(path_.to);
        if (state_.out != 0) return;
        if (holds(to, path_.close > 0 ? seam_ : slack())) {
            state_.handed = !holds(to, 0);
            return;
        }
        path_.left = true;
        state_.slipped = !is_back();
        state_.face = state_.handed = 0;
        state_.left = 1;
    }

    Contact answer() const noexcept {
        Hold hold{state_.face, state_.slipped != 0};
        if (state_.brushed != 0 && state_.out != 0) hold.face = 0;
        if (hold.face != 0) return solid(box_, seen_, radius_, hold);
        // A box that the proxy has not reached holds nothing. Exception: a probe with a radius that overlaps
        // the box is held by the plane at the proxy.
        if (state_.brushed == 0) return {.height = std::numeric_limits<double>::infinity()};
        const Vector3d offset = to_eigen(state_.brush);
        Contact felt = rim_of(offset, hold);
        felt.height -= felt.normal.dot(offset);
        return felt;
    }

  private:
    // Is the probe back above its face? Then the box alone would hold nothing, but together with other
    // surfaces it may still hold the proxy.
    bool is_back() const noexcept { return !(Face(state_.face).depth(seen_.y, half_) >= 0); }

    void go_from_start() noexcept {
        state_.from = state_.start;
        state_.from_met = state_.was_met;
    }

    Crossing crossing() const noexcept {
        const Vector3d to = there(path_.to);
        if (state_.left != 0 || !(to.norm() <= half_.norm() + radius_)) return {};
        const Way way{to_eigen(state_.from), to, seen_.axes.transpose() * path_.hold,
                      seen_.axes.transpose() * path_.to};
        Crossing found;
        if (state_.from_met != 0) {
            found = first_face(way, half_);
            if (found.face == 0 && way.hold.isZero(0)) graze(way);
        }
        if (found.face == 0) {
            found.face = face_about(to, half_, way.around);
            if (found.face != 0) found.when = 0;
        }
        return found;
    }

    void graze(const Way& way) const noexcept {
        const double when = grazed(way.from, way.to, half_);
        if (!(when <= 1)) return;
        path_.grazed = true;
        path_.graze = seen_.axes * (way.from + when * (way.to - way.from) - seen_.y);
    }

    Contact rim_of(const Vector3d& offset, Hold& hold) const noexcept {
        const Seen at{seen_.axes, there(offset)};
        if (distance(at.y) == 0) hold.face = nearest_face(at.y, half_);
        return solid(box_, at, radius_, hold);
    }

    Vector3d there(const Vector3d& offset) const noexcept {
        return seen_.y + seen_.axes.transpose() * offset;
    }
    bool holds(const Vector3d& at, double by) const noexcept {
        return Face(state_.face).has_foot(at, half_, by);
    }
    double distance(const Vector3d& at) const noexcept {
        return (at - at.cwiseMin(half_).cwiseMax(-half_)).norm();
    }
    double slack() const noexcept { return state_.handed != 0 || path_.joined ? seam_ : 0; }

    const Box& box_;
    Box::State& state_;
    const Seen& seen_;
    Vector3d half_;
    double radius_;
    ProxyPath& path_;
    double seam_;
};

inline void report_to_path(const Box::State& state, const Hold& hold, const Vector3d& y, const Vector3d& half,
                           ProxyPath& path) noexcept {
    path.entered = path.entered || (state.face == 0 && hold.face != 0);
    path.left = path.left || (hold.slipped && state.slipped == 0);
    if (state.met && state.face == 0 && hold.face == 0)
        path.grazed = path.grazed || grazed(to_eigen(state.last), y, half) <= 1;
}

}  // namespace knurl::boxes
