#pragma once
// The record of one stroke: its way of rendering, every cycle of the servo, every update of the application.

#include <cstdint>
#include <string>
#include <vector>

#include "judge.hpp"

namespace surface {

/// The ways in which an application of a few hertz can render a surface.
enum class Way {
    force,   // the application computes the force and sends it
    planes,  // tangent planes at the hand, without transition
    paper,   // the same, with the recovery of Mark et al. 96 (figure 7)
    knurl,   // planes for the predicted place of the hand, cross-faded: Knurl's default
    caps,    // the same with caps, which have the surface's curvature there
    mesh,    // the whole relief as triangles, sent once
    field,   // the same as heights over a grid
};

inline constexpr Way all_ways[] = {Way::force, Way::planes, Way::paper, Way::knurl,
                                   Way::caps,  Way::mesh,   Way::field};

std::string key_of(Way way);                 // "force"
std::string title_of(Way way, double rate);  // "force from the application, 20 Hz"
Way way_of(const std::string& key);          // throws std::runtime_error that names them

/// One update of the application.
struct Update {
    std::uint64_t report_cycle = 0;   // of the report that it was computed from
    std::int64_t report_read_ns = 0;  // when that was read from the device
    std::int64_t commit_ns = 0;
};

/// All that was recorded of one stroke.
struct Recording {
    Way way{};
    double stiffness = 0;                         // N/m, as applied
    double max_stiffness = 0;                     // N/m, the device's k_max
    double greatest_force = 0;                    // N, the device's peak
    std::vector<Cycle> cycles;                    // since the claim became active
    std::vector<std::int64_t> read_ns, write_ns;  // of the same cycles
    std::vector<Update> updates;                  // committed in that time
    std::uint64_t unread = 0;                     // reports overwritten before they were read
    bool interrupted = false;
    // N, of each cycle: the force of the surface that this way had sent by then (stated.hpp). Empty: it has
    // sent none.
    std::vector<Eigen::Vector3d> own_force;
};

/// For each used update: the time from the read of its report to the end of the write of the first cycle
/// whose sample was read after the commit, in s. (The servo may have taken it one cycle earlier.)
std::vector<double> ages_at_use(const Recording& recording);

}  // namespace surface
