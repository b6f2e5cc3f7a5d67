#pragma once

#include <knurl/reps/vec.hpp>

namespace knurl {

struct ProxyPath;

/// A virtual fingertip, in world coordinates, as one cycle of the servo sees it.
struct Probe {
    /// Position of its centre (m).
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    /// Orientation of the hand: turns the probe's axes into the world's.
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    /// Velocity by a first-order filter of 100 Hz (m/s): for damping.
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    /// Velocity by FOAW 16 (m/s): for friction states.
    Eigen::Vector3d smooth_velocity = Eigen::Vector3d::Zero();
    /// Angular velocity (rad/s).
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
    /// Radius (m); 0: a point.
    double radius = 0;
    /// Path of the proxy beside other surfaces (proxy_path.hpp); null: the probe is its own path.
    ProxyPath* path = nullptr;
};

/// Where a probe sits on the hand, in the frame of the device's tool (its tip, turned with its orientation).
struct ProbePlacement {
    /// Place relative to the tip (m).
    Vec3 offset;
    /// Radius (m), 0 or more.
    double radius = 0;
};

}  // namespace knurl
