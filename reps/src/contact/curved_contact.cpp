#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include <knurl/reps/curved_contact.hpp>

namespace knurl {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A matrix with an eigenvalue below this (the identity has 1) counts as not positive definite.
constexpr double least_eigenvalue = 0.02;

struct Model {
    Matrix3d lower;     // Cholesky factor
    Vector3d gradient;  // m
};

bool factor(const Matrix3d& second, Model& model) noexcept {
    const Eigen::LLT<Matrix3d> cholesky(second);
    if (cholesky.info() != Eigen::Success) return false;
    model.lower = cholesky.matrixL();
    return model.lower.diagonal().minCoeff() > std::sqrt(least_eigenvalue);
}

// I - sum u C. Where it is not positive across the holding surfaces, in directions that no step takes, their
// planes are added to the function. They are zero where they hold, so neither the point nor its multipliers
// change. Where it is not positive along the surfaces, p lies beyond their centre of curvature: then the
// largest share of the bend that still has a minimum is taken.
Model model_of(std::span<const NearSurface> near, const Vector3d& dx) noexcept {
    Model model{Matrix3d::Identity(), dx};
    Matrix3d bend = Matrix3d::Zero(), planes = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    bool bends = false;
    for (const NearSurface& surface : near) {
        if (!(surface.pushes > 0)) continue;
        bends = bends || !surface.at.bend.isZero(0);
        bend += surface.pushes * surface.at.bend;
        planes += surface.at.normal * surface.at.normal.transpose();
        pull += surface.at.height * surface.at.normal;
    }
    if (!bends || factor(Matrix3d::Identity() - bend, model)) return model;
    for (double share = 1; share > 0.05; share /= 2) {
        if (!factor(Matrix3d::Identity() - share * bend + planes, model)) continue;
        model.gradient = dx + pull;
        return model;
    }
    model.lower.setIdentity();
    return model;
}

}  // namespace

CurvedStep solve_curved_step(std::span<const NearSurface> near, const Vector3d& dx) noexcept {
    struct {
        std::array<double, max_near_surfaces> nx, ny, nz, s;
    } shifted;
    if (near.size() > max_near_surfaces) near = near.first(max_near_surfaces);
    const Model model = model_of(near, dx);
    const auto lower = model.lower.triangularView<Eigen::Lower>();
    // In y = L^T step + L^-1 gradient the solution is the point nearest to 0.
    const Vector3d pulled = lower.solve(model.gradient);
    ContactSolution solution;
    double worst = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < near.size(); ++i) {
        const Vector3d m = lower.solve(near[i].at.normal);
        const double length = m.norm();
        shifted.nx[i] = m.x() / length;
        shifted.ny[i] = m.y() / length;
        shifted.nz[i] = m.z() / length;
        shifted.s[i] = (m.dot(pulled) - near[i].at.height) / length;
        worst = std::max(worst, shifted.s[i]);
        if (near[i].pushes > 0 && solution.active.count < 3)
            solution.active.plane[solution.active.count++] = static_cast<std::uint32_t>(i);
    }
    const ContactPlanes planes{shifted.nx.data(), shifted.ny.data(), shifted.nz.data(), shifted.s.data(),
                               static_cast<std::uint32_t>(near.size())};
    solve_contact(planes, worst, 0, solution);
    CurvedStep out;
    if (solution.status != ContactSolution::Status::solved) return out;
    out.found = true;
    out.step = lower.transpose().solve(solution.dx - pulled);
    out.active = solution.active;
    for (std::uint32_t i = 0; i < solution.active.count; ++i) {
        const NearSurface& surface = near[solution.active.plane[i]];
        const Vector3d m = lower.solve(surface.at.normal);
        out.multiplier[i] = solution.multiplier[i] / m.norm();
    }
    return out;
}

}  // namespace knurl
