#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/box.hpp>
#include <knurl/reps/proxy_path.hpp>

#include "beside.hpp"
#include "distance.hpp"
#include "solid.hpp"

namespace knurl {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Face {
    int axis;
    double sign;  // of its normal

    explicit Face(std::uint32_t number) noexcept
        : axis(static_cast<int>(number - 1) / 2), sign(number % 2 == 1 ? 1 : -1) {}
    static std::uint32_t number(int axis, double sign) noexcept {
        return 1 + 2 * static_cast<std::uint32_t>(axis) + (sign < 0 ? 1 : 0);
    }
    double depth(const Vector3d& y, const Vector3d& half) const noexcept {
        return half[axis] - sign * y[axis];
    }

    // The foot lies within it, or beside it by no more than `by`.
    bool has_foot(const Vector3d& y, const Vector3d& half, double by) const noexcept {
        for (int i = 0; i < 3; ++i) {
            if (i != axis && !(std::abs(y[i]) <= half[i] + by)) return false;
        }
        return true;
    }
    // Below its plane, with the foot within: there it holds a probe that came through it.
    bool holds(const Vector3d& y, const Vector3d& half) const noexcept {
        return has_foot(y, half, 0) && depth(y, half) >= 0;
    }
};

std::uint32_t nearest_face(const Vector3d& y, const Vector3d& half) noexcept {
    int axis = 0;
    (half - y.cwiseAbs()).minCoeff(&axis);
    return Face::number(axis, y[axis] < 0 ? -1 : 1);
}

bool within(const Vector3d& y, const Vector3d& half) noexcept {
    return (y.cwiseAbs().array() <= half.array()).all();
}

// The face through which the path from `last`, outside, enters the closed box; 0: it does not. It enters
// where it has passed the planes of all faces that it was in front of, so through the last of them, if it is
// still within the others.
std::uint32_t face_entered(const Vector3d& last, const Vector3d& y, const Vector3d& half) noexcept {
    int axis = -1;
    double latest = -1;
    for (int i = 0; i < 3; ++i) {
        const double outside = std::abs(last[i]) - half[i];
        if (!(outside > 0)) continue;
        const double sign = last[i] < 0 ? -1 : 1, along = sign * (last[i] - y[i]);
        if (!(along >= outside)) return 0;  // still in front of that one
        const double t = outside / along;
        // Through an edge: by the face that is nearer then.
        if (t > latest || (t == latest && half[i] - sign * y[i] < half[axis] - std::abs(y[axis]))) {
            latest = t;
            axis = i;
        }
    }
    if (axis < 0) return 0;
    const Vector3d at = last + latest * (y - last);
    for (int i = 0; i < 3; ++i) {
        if (i != axis && !(std::abs(at[i]) <= half[i])) return 0;
    }
    return Face::number(axis, last[axis] < 0 ? -1 : 1);
}

struct Hold {
    std::uint32_t face;  // 0: none
    bool slipped;
};

// A step that ends out of reach (of the ball of `bound`) has led past the box, however it went there.
Hold follow(const Box::State& state, const Vector3d& y, const Vector3d& half, double radius) noexcept {
    if (state.face != 0) {
        const Face face(state.face);
        if (face.holds(y, half)) return {state.face, false};
        return {0, face.depth(y, half) >= 0};
    }
    if (state.met && y.norm() <= half.norm() + radius) {
        const std::uint32_t face = face_entered(to_eigen(state.last), y, half);
        if (face != 0) return Face(face).holds(y, half) ? Hold{face, false} : Hold{0, true};
    }
    return {within(y, half) ? nearest_face(y, half) : 0, state.slipped != 0};
}

struct Seen {
    Matrix3d axes;
    Vector3d y;  // m, the probe in the box's frame
};

// m: how far from it something touches it.
double seam_of(const Vector3d& half) noexcept {
    return seam_of_size * 2 * half.maxCoeff();
}

// As far off a face, in seams, a proxy is not held by it: more than rounding.
constexpr double off_of_seam = 1e-6;

// The way of a proxy that others hold, in the box's frame.
struct Way {
    Vector3d from, to;
    Vector3d hold;    // m: by which the probe was held at its beginning
    Vector3d around;  // ... is at its end
};

bool faces(double part, const Vector3d& held) noexcept {
    return part > 1e-6 * held.lpNorm<1>();
}

// Does the face, which the path crosses there, go so far? Where the probe is held against it, it goes as much
// farther as touching is; and all others end as much below it: what they have above that is a step that touches.
bool goes_as_far(const Face& face, const Vector3d& at, const Vector3d& half, const Vector3d& hold) noexcept {
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

// The first face on the way, from its front. One that touches counts as in front of a face against which the
// probe is held.
Crossing first_face(const Way& way, const Vector3d& half) noexcept {
    const double seam = seam_of(half);
    Crossing first;
    double first_facing = 0;
    for (std::uint32_t number = 1; number <= 6; ++number) {
        const Face face(number);
        const double held = face.sign * way.hold[face.axis], holds = face.sign * way.around[face.axis];
        const double above = -face.depth(way.from, half), below = face.depth(way.to, half);
        // One along which the path goes is not entered by rounding.
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

// Within, though it has come through no face: seen for the first time there, or by less than rounding.
std::uint32_t face_about(const Vector3d& y, const Vector3d& half, const Vector3d& around) noexcept {
    const double seam = seam_of(half), little = around.isZero(0) ? 0 : off_of_seam * seam;
    for (int i = 0; i < 3; ++i) {
        const double depth = half[i] - std::abs(y[i]);
        if (!(depth > (faces(y[i] < 0 ? -around[i] : around[i], around) ? seam : little))) return 0;
    }
    return nearest_face(y, half);
}

// Where a path through nothing passes within touching of the box, by the first face that is so near (share of the
// way; 2: it does not).
double grazed(const Vector3d& from, const Vector3d& to, const Vector3d& half) noexcept {
    const double far = seam_of(half) + (to - from).lpNorm<1>();
    if (!((to.cwiseAbs() - half).maxCoeff() <= far)) return 2;
    return first_face({from, to, from - to, Vector3d::Zero()}, half).when;
}

Seen see(const Box& box, Box::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Matrix3d axes = to_eigen(box.orientation).toRotationMatrix();
    return {axes, axes.transpose() * from_surface(box.center, box.velocity, state.motion, probe)};
}

[[gnu::always_inline]] inline Contact solid(const Box& box, const Seen& seen, double radius,
                                            Hold& hold) noexcept {
    const Vector3d half = to_eigen(box.half_size), &y = seen.y;
    if (hold.face != 0) {
        const Face face(hold.face);
        return contact_of(box, face.sign * seen.axes.col(face.axis), -face.depth(y, half) - radius);
    }
    const Distance out(y - y.cwiseMin(half).cwiseMax(-half));
    const double height = out.length - radius;
    hold.slipped = hold.slipped && height < 0;
    return contact_of(box, seen.axes * out.direction,
                      hold.slipped ? std::numeric_limits<double>::infinity() : height);
}

double wall_height(const Box& box, const Seen& seen, const Probe& probe, int axis) noexcept {
    return room(to_eigen(box.half_size)[axis], probe) - std::abs(seen.y[axis]);
}

Contact wall(const Box& box, const Seen& seen, const Probe& probe, int axis) noexcept {
    return contact_of(box, (seen.y[axis] < 0 ? 1 : -1) * seen.axes.col(axis),
                      wall_height(box, seen, probe, axis));
}

int nearest_wall(const Box& box, const Seen& seen, const Probe& probe) noexcept {
    int nearest = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (wall_height(box, seen, probe, axis) < wall_height(box, seen, probe, nearest)) nearest = axis;
    }
    return nearest;
}

void begin_cycle(Box::State& state) noexcept {
    state.start = state.last;
    state.was_met = state.met != 0;
    state.was_face = state.face;
    state.was_slipped = state.slipped;
    state.left = state.brushed = 0;
}

void remember(const Seen& seen, const Hold& hold, Box::State& state, double dt) noexcept {
    if (!(dt > 0)) return;
    begin_cycle(state);
    state.handed = state.out = 0;
    state.last = to_plain(seen.y);
    state.met = 1;
    state.face = static_cast<std::uint16_t>(hold.face);
    state.slipped = hold.slipped;
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
            state_.out = is_back() && -Face(state_.face).depth(to, half_) > off_of_seam * seam_;
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
        if (state_.face != 0 && !holds(at, slack())) return;  // it is about to leave itself
        if (!(at.norm() <= half_.norm() + radius_)) return;   // as far as others are asked
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
        // What the proxy has not come to holds nothing, but for a probe with a radius: by the plane at the proxy.
        if (state_.brushed == 0) return {.height = std::numeric_limits<double>::infinity()};
        const Vector3d offset = to_eigen(state_.brush);
        Contact felt = rim_of(offset, hold);
        felt.height -= felt.normal.dot(offset);
        return felt;
    }

  private:
    // The probe is back above its face; so it holds nothing alone, but may hold the proxy beside others.
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

void tell(const Box::State& state, const Hold& hold, const Vector3d& y, const Vector3d& half,
          ProxyPath& path) noexcept {
    path.entered = path.entered || (state.face == 0 && hold.face != 0);
    path.left = path.left || (hold.slipped && state.slipped == 0);
    if (state.met && state.face == 0 && hold.face == 0)
        path.grazed = path.grazed || grazed(to_eigen(state.last), y, half) <= 1;
}

}  // namespace

Box prepared(Box params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    params.reserved = 0;
    params.orientation = to_plain(to_eigen(params.orientation).normalized());
    return params;
}

// The probe's last place is kept as the box sees it, so a box that is sent elsewhere meets it on its way.
void adopt(const Box& params, const Box* previous, Box::State& state, const Probe&) noexcept {
    if (!previous) {
        state = {};
        place(state.motion);
        return;
    }
    if (!(params.center == previous->center) || !(params.orientation == previous->orientation) ||
        !(params.half_size == previous->half_size) || !(params.velocity == previous->velocity)) {
        place(state.motion);
    }
}

Contact contact(const Box& params, Box::State& state, const Probe& probe, double dt) noexcept {
    const Seen seen = see(params, state, probe, dt);
    if (params.side == Side::outside && probe.path && probe.path->stage != ProxyPath::Stage::free)
        return contact_beside(Beside(params, state, seen, probe.radius, *probe.path), probe.path->stage, dt);
    Hold hold{};
    if (params.side == Side::outside) hold = follow(state, seen.y, to_eigen(params.half_size), probe.radius);
    if (probe.path) probe.path->holds = hold.face != 0;
    if (probe.path && dt > 0 && params.side == Side::outside)
        tell(state, hold, seen.y, to_eigen(params.half_size), *probe.path);
    const Contact out = params.side == Side::outside
                            ? solid(params, seen, probe.radius, hold)
                            : wall(params, seen, probe, nearest_wall(params, seen, probe));
    remember(seen, hold, state, dt);
    return out;
}

std::uint32_t contacts(const Box& params, Box::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept {
    if (params.side == Side::outside || out.size() < Box::max_contacts) {
        if (out.empty()) return 0;
        out[0] = contact(params, state, probe, dt);
        return 1;
    }
    const Seen seen = see(params, state, probe, dt);
    for (int axis = 0; axis < 3; ++axis)
        out[static_cast<std::size_t>(axis)] = wall(params, seen, probe, axis);
    remember(seen, {}, state, dt);
    return Box::max_contacts;
}

std::optional<Bound> bound(const Box& params, const Box::State& state) noexcept {
    if (params.side == Side::inside || (state.face != 0 && state.out == 0)) return std::nullopt;
    return Bound{.center = to_eigen(params.center) + state.motion.time * to_eigen(params.velocity),
                 .radius = to_eigen(params.half_size).norm()};
}

void out_of_reach(const Box&, Box::State& state) noexcept {
    state.met = 0;
    state.face = state.slipped = state.out = 0;
}

}  // namespace knurl
