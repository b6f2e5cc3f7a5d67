#pragma once

#include <knurl/reps/vec.hpp>

namespace knurl {

struct ProxyPath;

/// A virtual fingertip, in world coordinates, as one cycle of the servo sees it.
struct Probe {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // m/s, first order 100 Hz: for damping
    Eigen::Vector3d smooth_velocity = Eigen::Vector3d::Zero();   // m/s, FOAW 16: for friction states
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
    double radius = 0;                                           // m
    ProxyPath* path = nullptr;  // beside other surfaces (proxy_path.hpp); null: the probe is its own
};

/// Where a probe sits on the hand, in the frame of the device's tool (its tip, turned with its orientation).
struct ProbePlacement {
    Vec3 offset;        // m
    double radius = 0;  // m, 0 or more
};

}  // namespace knurl
