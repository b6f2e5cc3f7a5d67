#pragma once
// Random boxes.

#include <algorithm>

#include <knurl/reps/box.hpp>

#include "piece_tools.hpp"

namespace knurl::test {

inline Box random_box(Rng& rng, double size, double far) {
    const Eigen::Quaterniond pose = turn(rng);
    const double length = scale(rng, 1e-3, 1e3);
    Box box{.center = to_plain(far * direction(rng)),
            .orientation = {length * pose.w(), length * pose.x(), length * pose.y(), length * pose.z()},
            .half_size = {size * scale(rng, 0.1, 1), size * scale(rng, 0.1, 1), size * scale(rng, 0.1, 1)}};
    if (between(rng, 0, 4) == 0) box.half_size.z = 0;
    box.stiffness = 1000;
    return box;
}

/// 40 x 60 x 80 mm about the origin.
inline Box brick() {
    Box box{.half_size = {0.02, 0.03, 0.04}};
    box.stiffness = 1000;
    return box;
}

/// Of a point in the box's frame.
inline Vector in_world(const Box& box, const Vector& y) {
    return to_eigen(box.center) + to_eigen(box.orientation).normalized() * y;
}

inline Vector any_in(Rng& rng, const Vector& half, double times) {
    return {uniform(rng, -times, times) * half.x(), uniform(rng, -times, times) * half.y(),
            uniform(rng, -times, times) * half.z()};
}

}  // namespace knurl::test
