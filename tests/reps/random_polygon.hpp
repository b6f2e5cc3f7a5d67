#pragma once

#include <cmath>

#include <knurl/reps/polygon.hpp>

#include "random_planes.hpp"

namespace knurl::test {

using Vector = Eigen::Vector3d;

inline Eigen::Quaterniond turn(Rng& rng) {
    std::normal_distribution<> normal;
    return Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng)).normalized();
}

/// Corners on an ellipse at random angles, in a random plane.
inline Polygon random_polygon(Rng& rng, double size, double far) {
    const int count = between(rng, 3, static_cast<int>(max_vertices));
    const Eigen::Quaterniond pose = turn(rng);
    const Vector middle = far * direction(rng);
    const double flat = scale(rng, 0.05, 1);
    Polygon polygon;
    polygon.vertices.count = static_cast<std::uint32_t>(count);
    polygon.stiffness = 1000;
    const double start = uniform(rng, 0, 2 * M_PI);
    for (int i = 0; i < count; ++i) {
        const double angle = start + 2 * M_PI * (i + uniform(rng, -0.3, 0.3)) / count;
        polygon.vertices.at[i] =
            to_plain(middle + pose * (size * Vector(std::cos(angle), flat * std::sin(angle), 0)));
    }
    return polygon;
}

}  // namespace knurl::test
