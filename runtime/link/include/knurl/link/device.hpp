#pragma once

#include <string>

#include <knurl/protocol/text.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

struct DeviceDescription {
    std::string name, address, profile, serial;
    double rate = 0;                  // Hz
    Vec3 workspace_centre;            // m
    double workspace_radius = 0;      // m
    double peak_force = 0;            // N
    double peak_torque = 0;           // N m
    double max_stiffness = 0;         // N/m
    bool renders_torque = false;      // else torque is discarded
    bool senses_orientation = false;  // else it is that of the base
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
