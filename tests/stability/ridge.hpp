#pragma once
// The true surface: a sine along x, the same for every y. Its sharpest curve has the radius L^2 / (4 pi^2 A).

#include <Eigen/Core>

namespace stability {

struct Ridge {
    double height = 0;  // m, amplitude A; 0: a flat wall
    double length = 1;  // m, wavelength L
    double shift = 0;   // m, where along x it begins

    double at(double x) const;
    double slope(double x) const;
    double bend(double x) const;  // 1/m, second derivative

    struct Foot {
        Eigen::Vector3d point;   // m
        Eigen::Vector3d normal;  // up
        double curvature;        // 1/m along the stroke, positive in a valley; across it is straight
        double height;           // m, of the given point over the surface
    };
    /// The nearest point, for points less than a quarter wavelength from it.
    Foot foot(const Eigen::Vector3d& p) const;
};

inline constexpr Ridge flat_wall{.height = 0, .length = 1};
inline constexpr Ridge gentle_ridge{.height = 5e-3, .length = 80e-3};  // sharpest radius 32 mm
inline constexpr Ridge harsh_ridge{.height = 3e-3, .length = 40e-3};   // 13.5 mm

}  // namespace stability
