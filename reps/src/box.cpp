#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/box.hpp>

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

    // Below its plane, with the foot within: there it holds a probe that came through it.
    bool holds(const Vector3d& y, const Vector3d& half) const noexcept {
        for (int i = 0; i < 3; ++i) {
            if (i != axis && !(std::abs(y[i]) <= half[i])) return false;
        }
        return depth(y, half) >= 0;
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

Seen see(const Box& box, Box::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Matrix3d axes = to_eigen(box.orientation).toRotationMatrix();
    return {axes, axes.transpose() * from_surface(box.center, box.velocity, state.motion, probe)};
}

Contact solid(const Box& box, const Seen& seen, double radius, Hold& hold) noexcept {
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

void remember(const Seen& seen, const Hold& hold, Box::State& state, double dt) noexcept {
    if (!(dt > 0)) return;
    state.last = to_plain(seen.y);
    state.met = 1;
    state.face = static_cast<std::uint16_t>(hold.face);
    state.slipped = hold.slipped;
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
    Hold hold{};
    if (params.side == Side::outside) hold = follow(state, seen.y, to_eigen(params.half_size), probe.radius);
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
    if (params.side == Side::inside || state.face != 0) return std::nullopt;
    return Bound{.center = to_eigen(params.center) + state.motion.time * to_eigen(params.velocity),
                 .radius = to_eigen(params.half_size).norm()};
}

void out_of_reach(const Box&, Box::State& state) noexcept {
    state.met = 0;
    state.face = state.slipped = 0;
}

}  // namespace knurl
