#include "device_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>
#include <Eigen/QR>

namespace knurl::cli {

namespace {

constexpr double longest_lag = 12e-3, lag_step = 2e-5;  // s
constexpr double turning = 2e-3;  // m/s: below it dry friction changes its sign gradually
constexpr int smooth = 8;         // samples to each side, for the sign of the velocity

/// The force's double integral at any time: exact for forces that are held between samples.
class Integral {
  public:
    Integral(const std::vector<double>& force, double period) : force_(force), period_(period) {
        once_.assign(force.size() + 1, 0);
        twice_.assign(force.size() + 1, 0);
        for (std::size_t i = 0; i < force.size(); ++i) {
            once_[i + 1] = once_[i] + force[i] * period;
            twice_[i + 1] = twice_[i] + once_[i] * period + force[i] * period * period / 2;
        }
    }
    double at(double t) const {
        if (t <= 0) return 0;
        const auto i = std::min(static_cast<std::size_t>(t / period_), force_.size() - 1);
        const double rest = t - static_cast<double>(i) * period_;
        return twice_[i] + once_[i] * rest + force_[i] * rest * rest / 2;
    }

  private:
    const std::vector<double>& force_;
    double period_;
    std::vector<double> once_, twice_;
};

/// x, its integral, the double integral of its velocity's sign, and 1, t, t^2/2: one row a sample.
Eigen::MatrixXd regressors(const Motion1& motion) {
    const auto n = static_cast<Eigen::Index>(motion.position.size());
    Eigen::MatrixXd rows(n, 6);
    double integral = 0, sign_once = 0, sign_twice = 0, before = motion.position.front();
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = [&](Eigen::Index k) {
            return motion.position[static_cast<std::size_t>(std::clamp<Eigen::Index>(k, 0, n - 1))];
        };
        const double t = static_cast<double>(i) * motion.period, x = at(i);
        if (i > 0) integral += (before + x) / 2 * motion.period;
        before = x;
        rows.row(i) << x, integral, sign_twice, 1, t, t * t / 2;
        const double velocity = (at(i + smooth) - at(i - smooth)) / (2 * smooth * motion.period);
        sign_twice += sign_once * motion.period;
        sign_once += std::tanh(velocity / turning) * motion.period;
    }
    return rows;
}

}  // namespace

Fit fit(const Motion1& motion) {
    Fit best;
    best.residual = std::numeric_limits<double>::infinity();
    const auto n = static_cast<Eigen::Index>(motion.position.size());
    const Eigen::MatrixXd rows = regressors(motion);
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(rows);
    const Integral integral(motion.force, motion.period);
    Eigen::VectorXd wanted(n);
    for (double lag = 0; lag <= longest_lag; lag += lag_step) {
        for (Eigen::Index i = 0; i < n; ++i)
            wanted[i] = integral.at(static_cast<double>(i) * motion.period - lag);
        const Eigen::VectorXd found = solver.solve(wanted);
        const double residual = (rows * found - wanted).norm() / std::sqrt(static_cast<double>(n));
        if (residual >= best.residual) continue;
        best = {.mass = found[0],
                .damping = found[1],
                .friction = found[2],
                .lag = lag,
                .residual = residual,
                .moved = 0};
    }
    const auto [least, greatest] = std::ranges::minmax(motion.position);
    best.moved = greatest - least;
    return best;
}

}  // namespace knurl::cli
