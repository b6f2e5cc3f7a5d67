#pragma once
// The joint contact solution: the point x nearest to the probe p with n_i . x >= c_i for every plane i at
// once. It is the gradient of a squared distance: conservative, continuous, and no stiffer than one plane in
// any direction, where a sum of plane forces is none of these. Source of the method: Goldfarb & Idnani, Math.
// Prog. 27 (1983), cut down to three dimensions, where at most three planes are active.

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace knurl {

/// Planes shifted to the probe, as structure of arrays: dx is free where normal . dx >= s, s = c - n . p.
/// Shifting before anything else keeps micrometres exact a thousand kilometres from the origin.
struct ContactPlanes {
    const double* nx = nullptr;  // unit normals
    const double* ny = nullptr;
    const double* nz = nullptr;
    const double* s = nullptr;  // m
    std::uint32_t count = 0;
};

/// The planes that hold x, by index: last cycle's are the first guess of the next.
struct ActiveSet {
    std::uint32_t count = 0;
    std::array<std::uint32_t, 3> plane{};
};

/// A solution, and the first guess of the next: keep it from cycle to cycle.
struct ContactSolution {
    enum class Status : std::uint32_t {
        solved,      // x is the optimum (KKT); x = p if no plane is violated
        infeasible,  // the planes contradict each other: no point satisfies all
        unfinished,  // the bound on iterations was hit
    };
    Status status = Status::solved;
    std::uint32_t iterations = 0;                  // planes taken in; 0: the guess was right
    Eigen::Vector3d dx = Eigen::Vector3d::Zero();  // m, x - p
    ActiveSet active;
    std::array<double, 3> multiplier{};  // m, of the active planes: dx = sum multiplier_i n_i, all >= 0
    double contradiction = 0;  // m, if infeasible: all planes must give way by at least this (Farkas)
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
inline constexpr std::uint32_t max_contact_relaxations = 60;

}  // namespace knurl
