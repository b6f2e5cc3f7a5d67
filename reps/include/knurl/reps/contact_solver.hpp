#pragma once

/// @file
/// The joint contact solution: the point x nearest to the probe p with n_i . x >= c_i for every plane i at
/// once. It is the gradient of a squared distance: conservative, continuous, and no stiffer than one plane in
/// any direction, where a sum of plane forces is none of these. Source of the method: Goldfarb & Idnani,
/// Math. Prog. 27 (1983), cut down to three dimensions, where at most three planes are active.

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace knurl {

/// Planes shifted to the probe, as structure of arrays: dx is free where normal . dx >= s, s = c - n . p.
/// Shifting before anything else keeps micrometres exact a thousand kilometres from the origin.
struct ContactPlanes {
    /// x of the unit normals.
    const double* nx = nullptr;
    /// y of the unit normals.
    const double* ny = nullptr;
    /// z of the unit normals.
    const double* nz = nullptr;
    /// s of each plane (m).
    const double* s = nullptr;
    /// How many planes there are.
    std::uint32_t count = 0;
};

/// The planes that hold x, by index: last cycle's are the first guess of the next.
struct ActiveSet {
    /// How many planes are active, 0 to 3.
    std::uint32_t count = 0;
    /// Their indices.
    std::array<std::uint32_t, 3> plane{};
};

/// A solution, and the first guess of the next: keep it from cycle to cycle.
struct ContactSolution {
    /// How a solution ended.
    enum class Status : std::uint32_t {
        /// `x` is the optimum (KKT); x = p if no plane is violated.
        solved,
        /// The planes contradict each other: no point satisfies all.
        infeasible,
        /// The bound on iterations was reached.
        unfinished,
    };
    /// How the solution ended.
    Status status = Status::solved;
    /// Planes that were taken in; 0: the guess was right.
    std::uint32_t iterations = 0;
    /// The solution relative to the probe, x - p (m).
    Eigen::Vector3d dx = Eigen::Vector3d::Zero();
    /// The planes that hold x.
    ActiveSet active;
    /// Multipliers of the active planes (m), all >= 0: dx = sum multiplier_i n_i.
    std::array<double, 3> multiplier{};
    /// If infeasible: all planes must give way by at least this (m); Farkas.
    double contradiction = 0;
};

/// No solution takes more steps than this; the property tests see at most about a dozen.
inline constexpr std::uint32_t max_contact_iterations = 40;

/// How far the worst plane is violated at dx (m; negative: all are satisfied, -infinity: there are none).
double worst_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx) noexcept;

/// Fills s = c - n . p for all planes and returns the largest: the violation at the probe.
double shift_to_probe(const double* nx, const double* ny, const double* nz, const double* c,
                      std::uint32_t count, const Eigen::Vector3d& p, double* s) noexcept;

/// Solves for the planes moved outwards by `give` (m, 0: as they are). `worst` is the largest s. On entry
/// solution.active is the guess: any planes; the last solution's are best.
void solve_contact(const ContactPlanes& planes, double worst, double give,
                   ContactSolution& solution) noexcept;

/// As above, but planes that contradict each other give way by the smallest amount that makes them feasible,
/// which is left in `give` (at most `max_contact_relaxations` solves), to the rounding of distances as large
/// as `worst`. Planes that are feasible with the `give` they come with leave it alone.
void solve_contact_relaxed(const ContactPlanes& planes, double worst, double& give,
                           ContactSolution& solution) noexcept;
/// Most solves of solve_contact_relaxed.
inline constexpr std::uint32_t max_contact_relaxations = 60;

}  // namespace knurl
