#include "bound.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace stability {
namespace {

using Eigen::VectorXd;

/// One cycle of the loop, linear: state is position, velocity, force exerted, last position, filtered
/// velocity, and the forces on their way.
VectorXd cycle_of(const Conditions& c, double stiffness, VectorXd state) {
    const int steps = static_cast<int>(std::ceil(c.period() / 100e-6 - 1e-9));
    const double h = c.period() / steps, mass = c.total_mass();
    const double follow = c.lag > 0 ? -std::expm1(-h * 2 * M_PI * c.lag) : 1;
    double &x = state[0], &v = state[1], &exerted = state[2], &last = state[3], &filtered = state[4];
    const auto pipe = state.tail(state.size() - 5);  // oldest first
    filtered += -std::expm1(-2 * M_PI * 100 * c.period()) * ((x - last) / c.period() - filtered);
    last = x;
    const double target = -stiffness * x - c.virtual_damping * filtered;
    for (int i = 0; i < steps; ++i) {
        double arrives = target;
        if (pipe.size() > 0) {
            arrives = pipe[0];
            for (Eigen::Index k = 0; k + 1 < pipe.size(); ++k) state[5 + k] = pipe[k + 1];
            state[state.size() - 1] = target;
        }
        exerted += follow * (arrives - exerted);
        v += h / mass * (exerted - c.total_damping() * v - c.grip * c.hand_press * x);
        x += h * v;
    }
    return state;
}

double largest_modulus(const Conditions& c, double stiffness) {
    const double h = c.period() / std::ceil(c.period() / 100e-6 - 1e-9);
    const Eigen::Index size = 5 + std::lround(c.delay / h);
    Eigen::MatrixXd map(size, size);
    for (Eigen::Index i = 0; i < size; ++i) map.col(i) = cycle_of(c, stiffness, VectorXd::Unit(size, i));
    return Eigen::EigenSolver<Eigen::MatrixXd>(map, false).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

double bound(const Conditions& c) {
    return c.total_damping() / (c.period() / 2 + c.lateness());
}

double eigenvalue_limit(const Conditions& c) {
    // Without any stiffness the loop has no eigenvalue above 1; each step of the ladder is 1 %.
    double low = 1;
    while (low < 1e6 && largest_modulus(c, low * 1.1) <= 1 + 1e-12) low *= 1.1;
    double high = low * 1.1;
    while (high / low > 1.001) {
        const double middle = std::sqrt(low * high);
        (largest_modulus(c, middle) <= 1 + 1e-12 ? low : high) = middle;
    }
    return low;
}

}  // namespace stability
