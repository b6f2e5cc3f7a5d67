#pragma once
// Shared by fields with a Jacobian: the bound on its eigenvalues, and the edge of their reach.

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace knurl {

template <int N>
using Square = Eigen::Matrix<double, N, N>;

/// Jacobi's rotations (Golub & Van Loan, Matrix Computations, 8.5): s becomes diagonal, q^T s q of the input.
/// They converge quadratically: 6 x 6 takes 6 to 8 sweeps. q is orthogonal after any number of sweeps.
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

/// An interval that contains the eigenvalues of a symmetric matrix (N/m), and 0.
struct Spectrum {
    double least = 0, most = 0;
    double largest() const noexcept { return std::max(-least, most); }
};

/// Brings the eigenvalues of j's symmetric part into [low, high]. j stays the same to the bit where
/// Gershgorin's circles show that it is inside. Returns the interval of the result.
template <int N>
Spectrum clamp_eigenvalues(Square<N>& j, double low, double high) noexcept {
    Square<N> s = 0.5 * (j + j.transpose());
    Spectrum found;
    for (int i = 0; i < N; ++i) {
        const double others = s.row(i).cwiseAbs().sum() - std::abs(s(i, i));
        found.least = std::min(found.least, s(i, i) - others);
        found.most = std::max(found.most, s(i, i) + others);
    }
    if (found.least >= low && found.most <= high) return found;
    const Square<N> rest = 0.5 * (j - j.transpose());
    Square<N> q;
    diagonalise<N>(s, q);
    const Eigen::Matrix<double, N, 1> values = s.diagonal().cwiseMax(low).cwiseMin(high);
    j = q * values.asDiagonal() * q.transpose();
    j += rest;
    return {std::min(0.0, values.minCoeff()), std::max(0.0, values.maxCoeff())};
}

/// The lower clamp of a field that is held beyond its rim. There the tangential force still grows, and a
/// direction's stiffness rises by up to a third of the largest negative one.
inline double restoring_when_held(double largest, double pushing) noexcept {
    return std::isfinite(largest) ? std::max(0.0, largest - pushing / 3) : largest;
}

/// Up to this share of its reach a field equals its series, unless the edge would be too steep for the
/// device.
inline constexpr double widest_core = 0.8;

/// The share of the energy that is left at a distance, and its derivative (1/m).
struct EdgeShare {
    double value = 1, slope = 0;
};

/// 1 up to core x reach, then a smoothstep down to 0 at the reach.
inline EdgeShare smooth_edge(double distance, double core, double reach) noexcept {
    if (distance <= core * reach) return {};
    if (!(distance < reach)) return {.value = 0};
    const double width = (1 - core) * reach, t = (reach - distance) / width;
    return {.value = t * t * (3 - 2 * t), .slope = -6 * t * (1 - t) / width};
}

/// The share of a field's load: all of it up to nine tenths of its reach, zero at the reach.
inline double load_left(double distance, double reach) noexcept {
    return std::clamp(10 * (1 - distance / reach), 0.0, 1.0);
}

/// The middle of the edge, as a share of the reach. The field's mean energy there is the level for the cut,
/// so that the least energy is cut off.
inline double middle_of_edge(double core) noexcept {
    return (1 + core) / 2;
}

/// The widest core, at most widest_core, for which `slope_of(core)` is at most `largest` (N/m). `strength` is
/// the remaining share of the field where even an edge over the whole reach is steeper.
struct Core {
    double share = widest_core, strength = 1;
    double slope = 0;  // N/m, of the edge
};
template <class SlopeOf>
Core core_within(double largest, SlopeOf slope_of) noexcept {
    constexpr int halvings = 30;
    Core out{.slope = slope_of(widest_core)};
    if (out.slope <= largest) return out;
    out = {.share = 0, .slope = slope_of(0.0)};
    if (out.slope > largest) {
        out.strength = largest / out.slope;
        out.slope = largest;
        return out;
    }
    double beyond = widest_core;
    for (int i = 0; i < halvings; ++i) {
        const double middle = (out.share + beyond) / 2, slope = slope_of(middle);
        if (slope <= largest) {
            out = {.share = middle, .slope = slope};
        } else {
            beyond = middle;
        }
    }
    return out;
}

}  // namespace knurl
