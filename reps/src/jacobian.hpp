#pragma once
// What fields with a jacobian share: the bound on its eigenvalues, and the edge of their reach.

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace knurl {

template <int N>
using Square = Eigen::Matrix<double, N, N>;

/// Jacobi's rotations (Golub & Van Loan, Matrix Computations, 8.5): s becomes diagonal, q^T s q of what it
/// was. They converge quadratically: 6 x 6 takes 6 to 8 sweeps; whatever the last one leaves, q is
/// orthogonal.
template <int N>
void diagonalise(Square<N>& s, Square<N>& q) noexcept {
    constexpr int sweeps = 16;
    q.setIdentity();
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        double outside = 0;
        for (int i = 0; i < N; ++i) {
            for (int k = i + 1; k < N; ++k) outside += s(i, k) * s(i, k);
        }
        if (outside <= 1e-34 * s.diagonal().squaredNorm()) return;
        for (int i = 0; i < N; ++i) {
            for (int k = i + 1; k < N; ++k) {
                if (s(i, k) == 0) continue;
                const double ratio = (s(k, k) - s(i, i)) / (2 * s(i, k));
                const double t = std::copysign(1.0, ratio) / (std::abs(ratio) + std::hypot(ratio, 1.0));
                const double c = 1 / std::hypot(t, 1.0), sine = t * c;
                for (int j = 0; j < N; ++j) {
                    const double a = s(j, i), b = s(j, k);
                    s(j, i) = c * a - sine * b;
                    s(j, k) = sine * a + c * b;
                }
                for (int j = 0; j < N; ++j) {
                    const double a = s(i, j), b = s(k, j), qa = q(j, i), qb = q(j, k);
                    s(i, j) = c * a - sine * b;
                    s(k, j) = sine * a + c * b;
                    q(j, i) = c * qa - sine * qb;
                    q(j, k) = sine * qa + c * qb;
                }
                s(i, k) = s(k, i) = 0;
            }
        }
    }
}

/// Brings the eigenvalues of j's symmetric part into [low, high]; j is untouched, to the bit, where
/// Gershgorin's circles show that they are there. Returns a bound on how strongly any direction restores:
/// minus the least of them, or 0.
template <int N>
double clamp_eigenvalues(Square<N>& j, double low, double high) noexcept {
    Square<N> s = 0.5 * (j + j.transpose());
    double least = 0, most = 0;
    for (int i = 0; i < N; ++i) {
        const double others = s.row(i).cwiseAbs().sum() - std::abs(s(i, i));
        least = std::min(least, s(i, i) - others);
        most = std::max(most, s(i, i) + others);
    }
    if (least >= low && most <= high) return std::abs(least);
    const Square<N> rest = 0.5 * (j - j.transpose());
    Square<N> q;
    diagonalise<N>(s, q);
    const Eigen::Matrix<double, N, 1> values = s.diagonal().cwiseMax(low).cwiseMin(high);
    j = q * values.asDiagonal() * q.transpose();
    j += rest;
    return std::max(0.0, -values.minCoeff());
}

/// 1 up to 0.8 of the reach, then a smoothstep down to 0 at its end.
inline double smooth_edge(double distance, double reach) noexcept {
    const double t = std::clamp((reach - distance) / (0.2 * reach), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace knurl
