#pragma once
// An application that sends one mesh and lets the hand feel it.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <knurl/client/client.hpp>
#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/reps/shape.hpp>

#include "record.hpp"

namespace feel {

struct FeelOptions {
    std::string device;  // empty: the only one
    knurl::SendOptions send;
    knurl::Shape shape;  // asset and position are filled in
    double radius = 0;   // m, of the finger
    bool fit = true;     // a larger thing is scaled into the device's workspace
    double seconds = 0;  // 0: until `stop`
};

struct FeelResult {
    knurl::SentShape sent;
    double send_seconds = 0;                             // from the offer to the servo's answer
    double stiffness = 0;                                // N/m as applied
    double scale = 1;                                    // m of the thing for a metre of the device
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, where its origin lies
    std::vector<Cycle> cycles;                           // since the device was active; in the mesh's frame
    std::uint64_t unread = 0;  // reports that were overwritten before they were read
    std::uint32_t faults = 0;
};

/// `told` gets a line now and then. Throws knurl::Error.
FeelResult feel(knurl::Client& client, const knurl::meshfile::MeshFile& file, const FeelOptions& options,
                const std::atomic<bool>& stop, const std::function<void(const std::string&)>& told);

}  // namespace feel
