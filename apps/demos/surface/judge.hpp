#pragma once
// Judges a stroke from its recorded cycles: a pure function with one written definition.
//
//   stable  =  jump <= 1 N a cycle,  kick <= 0.3 m/s,  limit cycle < 0.1 mm,  no fault
//
// The verdict needs enough data. A stroke has none if it never touched, did not move along the surface, was
// not seen at rest, or lacks too many reports, unless the available part is not stable.
//
// All forces are the scene's wrench before the supervisor. The thresholds were chosen, not measured on
// people: a step of 1 N is felt as a knock, and a hand thrown off at 0.3 m/s has lost the surface.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "terrain.hpp"

namespace surface {

/// One cycle of the servo.
struct Cycle {
    std::uint64_t number = 0;
    double t = 0;                                        // s since the claim became active
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N, the scene's, before the supervisor
    std::uint32_t faults = 0;  // the device's mask; not 0: this and later cycles do not count
    bool active = true;  // the device had its full force; false: it ramps up again after a standstill of the
                         // servo
    double gap = 0;      // s since the previous cycle's sample was read; 0: on time
    std::uint64_t late_count = 0;  // of the servo since its start
};

struct Thresholds {
    double jump = 1.0;            // N between two cycles
    double kick = 0.3;            // m/s away from the surface
    double limit_cycle = 0.1e-3;  // m
};

/// The data required for the verdict "stable".
struct Seen {
    double contact = 0.1;  // s below the surface
    double travel = 5e-3;  // m along it during that time
    double missed = 0.05;  // of the cycles, at most
};

struct Ideal {
    double stiffness = 0;       // N/m
    double greatest_force = 0;  // N: the device's own limit, for the true force as for the felt one; 0: none
};

/// Times as in Cycle::t, s: the stroke is judged from its first touch to `end`, the rest from `rest_at`.
struct Span {
    double rest_at = 0, end = 0;
    double period = 1e-3;  // s, the servo's
};

struct Judgement {
    std::uint64_t cycles = 0;  // recorded until the end or the fault
    std::uint64_t missed = 0;  // cycles that are missing in the record
    std::uint64_t late = 0;
    std::uint64_t stalls = 0;               // standstills of the servo long enough to remove the force
    double jump = 0, jump_at = 0;           // N, s
    std::uint64_t jumps = 0;                // above the threshold
    double kick = 0, kick_at = 0;           // m/s, s
    double force_error = 0;                 // N, root mean square of |felt - true| over the judged cycles
    double mean_force = 0;                  // N, of the true force
    std::optional<double> own_force_error;  // N, the same relative to the surface that was sent; none: no
                                            // surface was sent
    double contact_share = 0;               // of the judged cycles with the probe below the surface
    double contact = 0;                     // s below it
    double travel = 0;                      // m along it, between cycles below it
    // m, half of peak to peak of the height at rest; none: it never rested
    std::optional<double> limit_cycle;
    std::optional<double> fault_at;  // s
    std::uint32_t faults = 0;

    /// None: no verdict.
    std::optional<bool> stable(const Thresholds& limits = {}) const;
    /// Why a stroke without an unstable part is not called stable; empty: it is.
    std::string unseen(const Seen& needed = {}) const;
    /// "stable", "not stable: jump, kick", "faulted at t = 1.23 s (hand too fast)", "no verdict: ...".
    std::string verdict(const Thresholds& limits = {}) const;
};

/// The force of the true surface at a place: stiffness times depth along the normal at the foot.
Eigen::Vector3d true_force(const Terrain::Foot& foot, const Ideal& ideal);

/// `feet`: the true surface's foot of each cycle's position.
Judgement judge(const std::vector<Cycle>& cycles, const std::vector<Terrain::Foot>& feet, const Ideal& ideal,
                const Span& span, const Thresholds& limits = {});

/// A fault mask in words.
std::string fault_text(std::uint32_t faults);

}  // namespace surface
