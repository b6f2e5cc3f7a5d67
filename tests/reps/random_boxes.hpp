#pragma once
// Random boxes, and the same in long double.

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

/// The box in long double: its frame from the quaternion as it was sent.
struct ExactBox {
    Eigen::Matrix<Real, 3, 3> axes;
    Vec center, half;

    explicit ExactBox(const Box& box) : center(exact(box.center)), half(exact(box.half_size)) {
        const Quat q = box.orientation;
        const Eigen::Matrix<Real, 4, 1> u = Eigen::Matrix<Real, 4, 1>(q.w, q.x, q.y, q.z).normalized();
        const Vec v(u[1], u[2], u[3]);
        for (int i = 0; i < 3; ++i) {  // e + 2 w (v x e) + 2 v x (v x e)
            const Vec e = Vec::Unit(i), once = v.cross(e);
            axes.col(i) = e + 2 * u[0] * once + 2 * v.cross(once);
        }
    }
    Vec seen(const Vector& p) const { return axes.transpose() * (exact(p) - center); }
    Vector world(const Vector& y) const { return (center + axes * exact(y)).cast<double>(); }

    struct Hit {
        int axis = -1;
        int sign = 0;
        Real margin = INFINITY;  // m, the margin of all other decisions
    };
    // Which of the six rectangles does the path a -> b pass from outside?
    Hit entry(const Vec& a, const Vec& b) const {
        Hit hit;
        for (int i = 0; i < 3; ++i) {
            for (const int sign : {1, -1}) {
                const Real from = sign * a[i] - half[i], to = sign * b[i] - half[i];
                hit.margin = std::min({hit.margin, std::abs(from), std::abs(to)});
                if (!(from > 0 && to < 0)) continue;
                const Vec at = a + from / (from - to) * (b - a);
                Real inside = INFINITY;
                for (int j = 0; j < 3; ++j) {
                    if (j != i) inside = std::min(inside, half[j] - std::abs(at[j]));
                }
                hit.margin = std::min(hit.margin, std::abs(inside));
                if (inside > 0) hit.axis = i, hit.sign = sign;
            }
        }
        return hit;
    }
};

inline Vector any_in(Rng& rng, const Vector& half, double times) {
    return {uniform(rng, -times, times) * half.x(), uniform(rng, -times, times) * half.y(),
            uniform(rng, -times, times) * half.z()};
}

}  // namespace knurl::test
