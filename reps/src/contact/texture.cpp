#include <algorithm>
#include <cmath>
#include <numbers>

#include <knurl/reps/texture.hpp>

namespace knurl {
namespace {

using Vector = Eigen::Vector3d;

constexpr double turn = 2 * std::numbers::pi;

/// Phase of a cosine (rad). The remainder is exact, so far away only the rounding of the distance is left.
double phase(double distance, double wavelength) noexcept {
    return turn * (std::remainder(distance, wavelength) / wavelength);
}

/// Across the ridges of a grid's second direction: perpendicular to the surface normal and to the ridges'
/// direction.
Vector perpendicular(const Vector& normal, const Vector& direction) noexcept {
    const Vector v = normal.cross(direction);
    const double length = v.norm();
    return length > 1e-9 ? Vector(v / length) : normal.unitOrthogonal();
}

}  // namespace

Relief relief(const Texture& texture, const Vector& p, const Vector& normal, const Vector& shift) noexcept {
    const Vector q = p - to_eigen(texture.origin) - shift;
    const double amplitude = texture.amplitude, steepest = amplitude * (turn / texture.wavelength);
    Relief relief;
    if (texture.pattern == TexturePattern::rings) {
        const Vector along = q - normal.dot(q) * normal;
        const double r = along.norm(), angle = phase(r, texture.wavelength);
        relief.height = amplitude * std::cos(angle);
        if (r > 0) relief.slope = along * (-steepest * std::sin(angle) / r);
        return relief;
    }
    const Vector u = to_eigen(texture.direction).normalized();
    const double angle = phase(u.dot(q), texture.wavelength);
    relief.height = amplitude * std::cos(angle);
    relief.slope = (-steepest * std::sin(angle)) * u;
    if (texture.pattern == TexturePattern::grid) {
        const Vector v = perpendicular(normal, u);
        const double other = phase(v.dot(q), texture.wavelength);
        relief.height = 0.5 * (relief.height + amplitude * std::cos(other));
        relief.slope = 0.5 * (relief.slope + (-steepest * std::sin(other)) * v);
    }
    relief.slope -= normal.dot(relief.slope) * normal;
    return relief;
}

double texture_gain(const Texture& texture, double speed, const Limits& limits) noexcept {
    const double per_cycle = speed / texture.wavelength * limits.period;  // ridges per cycle
    return std::clamp(2 - 8 * per_cycle, 0.0, 1.0);
}

Vector texture_force(const Texture& texture, const Relief& relief, double normal_force,
                     const Limits& limits) noexcept {
    const double waves = turn / texture.wavelength;
    const double stiffness = normal_force * texture.amplitude * waves * waves;
    const double share = stiffness > limits.max_stiffness ? limits.max_stiffness / stiffness : 1;
    return (-share * normal_force) * relief.slope;
}

}  // namespace knurl
