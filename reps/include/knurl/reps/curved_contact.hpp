#pragma once

/// @file
/// The nearest point to the probe that satisfies curved surfaces themselves, where their tangent planes at
/// the probe's own feet meet elsewhere:
///
///        p's feet a, b                     planes there meet in y,          the surfaces meet in x
///       .--a--.   .--b--.                  too far out: a wedge that
///      (   \   ) (   /   )                 turns with p makes work          x is where a hand in a groove is held
///       `---p'\-x-/`p---'
///
/// Each step is one of sequential quadratic programming: the surfaces' tangent planes at x_k (not at p), and
/// of the Lagrangian |x - p|^2 / 2 - sum u_i h_i its second derivatives I - sum u_i C_i, C_i those of the
/// signed distance h_i. Without them planes at x_k alone come nearer by a constant factor a step; with them
/// the error is squared. With the Cholesky factor of that matrix it is the nearest point to a point again,
/// under planes: solve_contact finds it, and with it which surfaces hold. Source: Nocedal and Wright,
/// Numerical Optimization (2006), 18.1.

#include <array>
#include <cstdint>
#include <span>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/contact_solver.hpp>

namespace knurl {

/// At most so many steps a cycle and layer.
inline constexpr std::uint32_t max_curved_rounds = 4;

/// A surface near x_k, and the multiplier (m) that it had there in the step before; 0: it did not push.
struct NearSurface {
    /// The surface there.
    CurvedContact at;
    /// To which surface it belongs; the step does not use it.
    std::uint32_t member = 0;
    /// Its multiplier in the step before (m); 0: it did not push.
    double pushes = 0;
    /// True: the surface is not flat everywhere, though it may be flat here.
    bool curved = false;
    /// True after the step: it is active.
    bool holds = false;
};

/// Most surfaces of one probe that a step takes in; of more than these, the tangent planes at the probe's own
/// feet are used.
inline constexpr std::uint32_t max_near_surfaces = 64;

/// Result of solve_curved_step.
struct CurvedStep {
    /// False: the planes at x_k contradict each other.
    bool found = false;
    /// The step x_(k+1) - x_k (m).
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    /// The active surfaces, as indices of `near`.
    ActiveSet active;
    /// Multipliers (m): dx = sum multiplier_i n_i where the steps have ended.
    std::array<double, 3> multiplier{};
};

/// The step from x_k, `dx` = x_k - p (m). Of `near` no more than max_near_surfaces.
CurvedStep solve_curved_step(std::span<const NearSurface> near, const Eigen::Vector3d& dx) noexcept;

}  // namespace knurl
