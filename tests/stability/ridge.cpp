#include "ridge.hpp"

#include <cmath>

namespace stability {

double Ridge::at(double x) const {
    return height * std::sin(2 * M_PI / length * (x + shift));
}
double Ridge::slope(double x) const {
    const double w = 2 * M_PI / length;
    return height * w * std::cos(w * (x + shift));
}
double Ridge::bend(double x) const {
    const double w = 2 * M_PI / length;
    return -height * w * w * std::sin(w * (x + shift));
}

Ridge::Foot Ridge::foot(const Eigen::Vector3d& p) const {
    if (height == 0) return {{p.x(), p.y(), 0}, Eigen::Vector3d::UnitZ(), 0, p.z()};
    double s = p.x();
    const double sharpest = length * length / (4 * M_PI * M_PI * height);  // m, the smallest radius
    if (std::abs(p.z() - at(s)) > sharpest / 2) {
        // This far away Newton may end on a farther point, so the best of a few starts is used.
        const auto distance = [&](double x) { return std::hypot(x - p.x(), at(x) - p.z()); };
        constexpr int samples = 8;
        double best = distance(s);
        for (int i = -samples; i <= samples; ++i) {
            const double candidate = p.x() + length / 4 * i / samples;
            if (const double d = distance(candidate); d < best) best = d, s = candidate;
        }
    }
    // Newton on the derivative of half the squared distance.
    for (int i = 0; i < 20; ++i) {
        const double z = at(s), dz = slope(s);
        const double first = (s - p.x()) + (z - p.z()) * dz;
        const double second = 1 + dz * dz + (z - p.z()) * bend(s);
        const double step = second > 0.1 ? first / second : first;
        s -= step;
        if (std::abs(step) < 1e-12) break;
    }
    const double dz = slope(s), stretch = std::hypot(1.0, dz);
    Foot foot;
    foot.point = {s, p.y(), at(s)};
    foot.normal = Eigen::Vector3d(-dz, 0, 1) / stretch;
    foot.curvature = bend(s) / (stretch * stretch * stretch);
    foot.height = foot.normal.dot(p - foot.point);
    return foot;
}

}  // namespace stability
