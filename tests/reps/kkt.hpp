#pragma once
// The reference for contacts: in long double, sharing no code with the solver. A point is the nearest one if
// and only if it satisfies every plane, and its offset from the probe is a sum of normals of touching planes
// with weights >= 0 (Karush, Kuhn, Tucker; the problem is convex). Here the weights come from Cramer's rule.

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "random_planes.hpp"

namespace knurl::test {

struct Kkt {
    RealVector x = RealVector::Zero();  // m from the probe: the point that the active set stands for
    Real violation = 0;                 // m, of the worst plane there
    Real weight = 0;                    // m, the smallest multiplier
    Real size = 0;                      // m, the largest length involved
    // of the active corner: |n1 x n2|, or the volume of three normals over the largest face
    Real sharpness = 1;
};

inline Kkt kkt(const ContactPlanes& planes, const ActiveSet& active) {
    Kkt out;
    std::array<RealVector, 3> n;
    std::array<Real, 3> s{}, u{};
    for (std::uint32_t i = 0; i < active.count; ++i) {
        const std::uint32_t a = active.plane[i];
        n[i] = RealVector(planes.nx[a], planes.ny[a], planes.nz[a]);
        s[i] = planes.s[a];
    }
    // The Gram system N u = s, by cofactors in orthogonalised form: exact enough for 0.01 degrees in 64 bits.
    if (active.count == 1) {
        u[0] = s[0] / n[0].squaredNorm();
    } else if (active.count == 2) {
        const RealVector w = n[1] - n[0] * (n[0].dot(n[1]) / n[0].squaredNorm());
        u[1] = (s[1] - s[0] * n[0].dot(n[1]) / n[0].squaredNorm()) / w.squaredNorm();
        u[0] = (s[0] - u[1] * n[0].dot(n[1])) / n[0].squaredNorm();
    } else if (active.count == 3) {
        Eigen::Matrix<Real, 3, 3> rows;
        for (int i = 0; i < 3; ++i) rows.row(i) = n[static_cast<std::size_t>(i)].transpose();
        const Eigen::FullPivLU<Eigen::Matrix<Real, 3, 3>> lu(rows);
        const RealVector x = lu.solve(RealVector(s[0], s[1], s[2]));
        const RealVector v = Eigen::FullPivLU<Eigen::Matrix<Real, 3, 3>>(rows.transpose()).solve(x);
        for (int i = 0; i < 3; ++i) u[static_cast<std::size_t>(i)] = v(i);
        out.x = x;
    }
    if (active.count < 3) {
        for (std::uint32_t i = 0; i < active.count; ++i) out.x += u[i] * n[i];
    }
    if (active.count == 2) out.sharpness = n[0].cross(n[1]).norm();
    if (active.count == 3) {
        const Real ab = n[0].cross(n[1]).norm(), bc = n[1].cross(n[2]).norm(), ca = n[2].cross(n[0]).norm();
        out.sharpness = std::min({ab, bc, ca, std::abs(n[0].cross(n[1]).dot(n[2])) / std::max({ab, bc, ca})});
    }
    for (std::uint32_t i = 0; i < active.count; ++i) out.weight = std::min(out.weight, u[i]);
    out.violation = -INFINITY;
    for (std::uint32_t i = 0; i < planes.count; ++i) {
        const RealVector normal(planes.nx[i], planes.ny[i], planes.nz[i]);
        out.violation = std::max(out.violation, planes.s[i] - normal.dot(out.x));
        if (planes.s[i] > 0) out.size = std::max(out.size, Real(planes.s[i]));
    }
    out.size = std::max(out.size, out.x.norm());
    return out;
}

}  // namespace knurl::test
