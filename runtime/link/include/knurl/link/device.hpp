#pragma once

#include <string>

#include <knurl/reps/vec.hpp>

namespace knurl {

struct DeviceDescription {
    std::string name, address, profile, serial;
    double rate = 0;              // Hz
    Vec3 workspace_centre;        // m
    double workspace_radius = 0;  // m
    double peak_force = 0;        // N
    double max_stiffness = 0;     // N/m
    bool renders_torque = false;
};

}  // namespace knurl
