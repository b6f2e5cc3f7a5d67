#pragma once

#include <string>

#include <knurl/protocol/text.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// What an application is told about a device.
struct DeviceDescription {
    /// Name by which it is claimed: "right".
    std::string name;
    /// Address that the servo opened: "sim:premium15".
    std::string address;
    /// Name of its profile or product: "premium15".
    std::string profile;
    /// Serial number; empty: it has none.
    std::string serial;
    /// Rate of its loop (Hz).
    double rate = 0;
    /// Middle of the workspace (m), device frame.
    Vec3 workspace_centre;
    /// Radius of the workspace (m).
    double workspace_radius = 0;
    /// Peak force (N).
    double peak_force = 0;
    /// Peak torque (N m).
    double peak_torque = 0;
    /// Largest stiffness k_max (N/m), device frame.
    double max_stiffness = 0;
    /// False: torque is discarded.
    bool renders_torque = false;
    /// False: the orientation is that of the base.
    bool senses_orientation = false;
};

namespace detail {

/// From the servo's own row in shared memory, or from its like that came over a network.
template <class Row>
DeviceDescription describe(const Row& row) {
    using protocol::text_of;
    return {.name = text_of(row.name),
            .address = text_of(row.address),
            .profile = text_of(row.profile),
            .serial = text_of(row.serial),
            .rate = row.rate,
            .workspace_centre = row.workspace_centre,
            .workspace_radius = row.workspace_radius,
            .peak_force = row.peak_force,
            .peak_torque = row.peak_torque,
            .max_stiffness = row.max_stiffness,
            .renders_torque = row.renders_torque != 0,
            .senses_orientation = row.senses_orientation != 0};
}

}  // namespace detail

}  // namespace knurl
