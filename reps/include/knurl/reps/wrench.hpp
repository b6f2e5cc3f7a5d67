#pragma once

#include <knurl/reps/vec.hpp>

namespace knurl {

/// Force and torque on the hand, world frame; the torque is about the position of the probe it acts on.
struct Wrench {
    /// Force (N).
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    /// Torque (N m).
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();

    /// Adds another wrench about the same point.
    Wrench& operator+=(const Wrench& other) noexcept {
        force += other.force;
        torque += other.torque;
        return *this;
    }
};

/// The wrench at that scale.
inline Wrench operator*(double scale, const Wrench& w) noexcept {
    return {scale * w.force, scale * w.torque};
}
/// The sum of two wrenches about the same point.
inline Wrench operator+(Wrench a, const Wrench& b) noexcept {
    return a += b;
}

}  // namespace knurl
