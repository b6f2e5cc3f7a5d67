#pragma once

#include <knurl/reps/vec.hpp>

namespace knurl {

/// Force and torque on the hand, world frame; the torque is about the position of the probe it acts on.
struct Wrench {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m

    Wrench& operator+=(const Wrench& other) noexcept {
        force += other.force;
        torque += other.torque;
        return *this;
    }
};

inline Wrench operator*(double scale, const Wrench& w) noexcept {
    return {scale * w.force, scale * w.torque};
}
inline Wrench operator+(Wrench a, const Wrench& b) noexcept {
    return a += b;
}

}  // namespace knurl
