#pragma once

#include <cmath>

#include <Eigen/Core>

namespace knurl {

/// A vector's length and direction, also where the squares of its components over- or underflow.
struct Distance {
    Eigen::Vector3d direction;
    double length;  // in the unit of v

    explicit Distance(const Eigen::Vector3d& v) noexcept {  // v is not 0
        const double square = v.squaredNorm();
        if (square > 1e-280) {
            length = std::sqrt(square);
            direction = v / length;
        } else {
            const double largest = v.cwiseAbs().maxCoeff();
            const Eigen::Vector3d scaled = v / largest;
            const double norm = scaled.norm();
            length = norm * largest;
            direction = scaled / norm;
        }
    }
};

}  // namespace knurl
