#include <cmath>

#include <knurl/reps/box.hpp>

#include "distance.hpp"
#include "surface.hpp"

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

Hold follow(const Box::State& state, const Vector3d& y, const Vector3d& half) noexcept {
    if (state.face != 0) {
        const Face face(state.face);
        if (face.holds(y, half)) return {state.face, false};
        return {0, face.depth(y, half) >= 0};
    }
    if (state.met) {
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

Contact wall(const Box& box, const Seen& seen, double radius, int axis) noexcept {
    const double half = to_eigen(box.half_size)[axis], y = seen.y[axis];
    const double room = half > radius ? half - radius : 0;
    return contact_of(box, (y < 0 ? 1 : -1) * seen.axes.col(axis), room - std::abs(y));
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
    if (params.side != previous->side) state.face = state.slipped = 0;
}

std::uint32_t contacts(const Box& params, Box::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept {
    const Seen seen = see(params, state, probe, dt);
    Hold hold{};
    std::uint32_t count = 0;
    if (params.side == BoxSide::inside) {
        while (count < 3 && count < out.size()) {
            out[count] = wall(params, seen, probe.radius, static_cast<int>(count));
            ++count;
        }
    } else if (!out.empty()) {
        hold = follow(state, seen.y, to_eigen(params.half_size));
        out[count++] = solid(params, seen, probe.radius, hold);
    }
    if (dt > 0) {
        state.last = to_plain(seen.y);
        state.met = 1;
        state.face = static_cast<std::uint16_t>(hold.face);
        state.slipped = hold.slipped;
    }
    return count;
}

Contact contact(const Box& params, Box::State& state, const Probe& probe, double dt) noexcept {
    Contact all[Box::max_contacts];
    const std::uint32_t count = contacts(params, state, probe, dt, all);
    std::uint32_t worst = 0;
    for (std::uint32_t i = 1; i < count; ++i) {
        if (all[i].height < all[worst].height) worst = i;
    }
    return all[worst];
}

std::optional<Bound> bound(const Box& params, const Box::State& state) noexcept {
    if (params.side == BoxSide::inside || state.face != 0) return std::nullopt;
    return Bound{.center = to_eigen(params.center) + state.motion.time * to_eigen(params.velocity),
                 .radius = to_eigen(params.half_size).norm()};
}

void out_of_reach(const Box&, Box::State& state) noexcept {
    state.met = 0;
    state.face = state.slipped = 0;
}

}  // namespace knurl
