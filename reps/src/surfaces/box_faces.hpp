#pragma once
// The six faces of a box, and which of them holds a probe that entered through it.

#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/box.hpp>

#include "surfaces/distance.hpp"
#include "surfaces/surface.hpp"

namespace knurl::boxes {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Face {
    int axis;
    double sign;  // of the normal

    explicit Face(std::uint32_t number) noexcept
        : axis(static_cast<int>(number - 1) / 2), sign(number % 2 == 1 ? 1 : -1) {}
    static std::uint32_t number(int axis, double sign) noexcept {
        return 1 + 2 * static_cast<std::uint32_t>(axis) + (sign < 0 ? 1 : 0);
    }
    double depth(const Vector3d& y, const Vector3d& half) const noexcept {
        return half[axis] - sign * y[axis];
    }

    // The foot lies within the face, or beside it by no more than `by`.
    bool has_foot(const Vector3d& y, const Vector3d& half, double by) const noexcept {
        for (int i = 0; i < 3; ++i) {
            if (i != axis && !(std::abs(y[i]) <= half[i] + by)) return false;
        }
        return true;
    }
    // The probe is below the face's plane, with its foot within: the face holds a probe that entered through
    // it.
    bool holds(const Vector3d& y, const Vector3d& half) const noexcept {
        return has_foot(y, half, 0) && depth(y, half) >= 0;
    }
};

inline std::uint32_t nearest_face(const Vector3d& y, const Vector3d& half) noexcept {
    int axis = 0;
    (half - y.cwiseAbs()).minCoeff(&axis);
    return Face::number(axis, y[axis] < 0 ? -1 : 1);
}

inline bool within(const Vector3d& y, const Vector3d& half) noexcept {
    return (y.cwiseAbs().array() <= half.array()).all();
}

// The face through which the path from `last`, outside, enters the closed box; 0: it does not. The path
// enters through the last face whose plane it passes, if it is still within the other faces then.
inline std::uint32_t face_entered(const Vector3d& last, const Vector3d& y, const Vector3d& half) noexcept {
    int axis = -1;
    double latest = -1;
    for (int i = 0; i < 3; ++i) {
        const double outside = std::abs(last[i]) - half[i];
        if (!(outside > 0)) continue;
        const double sign = last[i] < 0 ? -1 : 1, along = sign * (last[i] - y[i]);
        if (!(along >= outside)) return 0;  // still in front of that plane
        const double t = outside / along;
        // Through an edge: the nearer face at the end of the path.
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

// A step that ends out of reach (of the ball of `bound`) has led past the box, whatever its path.
inline Hold follow(const Box::State& state, const Vector3d& y, const Vector3d& half, double radius) noexcept {
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

}  // namespace knurl::boxes
