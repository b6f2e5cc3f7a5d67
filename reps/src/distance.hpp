#pragma once

#include <Eigen/Core>

namespace knurl {

/// A length and its direction, also where the squares of its components are no numbers any more.
struct Distance {
    Eigen::Vector3d direction;
    double length;  // as v

    explicit Distance(const Eigen::Vector3d& v) noexcept {  // not 0
        const double largest = v.cwiseAbs().maxCoeff();
        direction = v / largest;
        const double norm = direction.norm();
        length = norm * largest;
        direction /= norm;
    }
};

}  // namespace knurl
