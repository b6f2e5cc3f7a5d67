#pragma once

#include <knurl/reps/contact_solver.hpp>

namespace knurl {

struct PlaneArrays {
    const double* nx;
    const double* ny;
    const double* nz;
    const double* c;
};

/// The first plane whose violation at dx is exactly `violation`, as worst_violation returned it.
std::uint32_t find_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx,
                             double violation) noexcept;

}  // namespace knurl
