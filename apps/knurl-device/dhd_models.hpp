#pragma once
// Figures of Force Dimension's devices, per type number of the SDK.

#include <optional>
#include <string>

namespace knurl::device {

struct DhdModel {
    int type;
    const char* name;
    double force;       // N, peak and continuous: the makers' data sheets state one figure
    double torque;      // N m; 0: it renders none
    double grip_force;  // N; 0: none
    double radius;      // m, of a ball in the workspace
    double resolution;  // m; 0: not known
    const char* source;
};

/// The model; none: not in the table.
const DhdModel* dhd_model(int type) noexcept;

}  // namespace knurl::device
