#pragma once
// The recorded force, cycle by cycle, and the force of the same mesh at the same places in this process.

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <knurl/geometry/mesh.hpp>

namespace feel {

struct Cycle {
    std::uint64_t number = 0;
    double t = 0;                                        // s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, the hand, in the mesh's frame
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N, the scene's
    // From a proxy in this process, on its own mesh:
    Eigen::Vector3d proxy = Eigen::Vector3d::Zero();     // m; where it is free: the hand
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();  // N
    bool touching = false;
};

struct Judgement {
    std::uint64_t cycles = 0, touching = 0, missed = 0;      // missed: gaps between recorded ones
    double worst_error = 0, mean_force = 0, peak_force = 0;  // N; the error of cycles that have a neighbour
    double jump = 0, expected_jump = 0;                      // N, the largest from one cycle to the next
    std::uint64_t jumps = 0, expected_jumps = 0;             // above 0.5 N
    std::uint64_t lost = 0;                                  // touched in one of the two only
};

/// Computes the expected force: a surface of that stiffness (N/m), force at most `peak` (N).
void expect(std::vector<Cycle>& cycles, const knurl::Mesh& mesh, double stiffness, double peak);
Judgement judge(const std::vector<Cycle>& cycles);

void write_csv(const std::string& path, const std::vector<Cycle>& cycles);

}  // namespace feel
