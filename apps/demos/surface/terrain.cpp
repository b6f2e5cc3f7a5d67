#include "terrain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace surface {
namespace {

/// Weights of the four control heights around t in [0, 1], and their derivatives by t.
struct Weights {
    std::array<double, 4> value, first, second;
};

Weights weights(double t) {
    const double u = 1 - t;
    return {
        .value = {u * u * u / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * u * u + 3 * u * u * u) / 6,
                  t * t * t / 6},
        .first = {-u * u / 2, (3 * t * t - 4 * t) / 2, (4 * u - 3 * u * u) / 2, t * t / 2},
        .second = {u, 3 * t - 2, 3 * u - 2, t},
    };
}

std::size_t index_of(const HeightGrid& grid, int row, int column) {
    const auto r = static_cast<std::size_t>(std::clamp(row, 0, grid.rows - 1));
    const auto c = static_cast<std::size_t>(std::clamp(column, 0, grid.columns - 1));
    return r * static_cast<std::size_t>(grid.columns) + c;
}

/// The cell and the place within it. Far outside: the last cell in which all four control heights are the
/// border's.
void locate(double at, int count, int& cell, double& t) {
    const double bounded = std::clamp(at, -3.0, count + 2.0);
    cell = static_cast<int>(std::floor(bounded));
    t = bounded - cell;
}

}  // namespace

Terrain::Terrain(HeightGrid grid) : grid_(std::move(grid)) {
    if (grid_.rows < 4 || grid_.columns < 4)
        throw std::runtime_error("a terrain needs at least 4 rows and 4 columns of heights, this one has " +
                                 std::to_string(grid_.rows) + " x " + std::to_string(grid_.columns));
    if (!(grid_.cell > 0) || !std::isfinite(grid_.cell))
        throw std::runtime_error("a terrain's cell must have a length above 0 m");
    if (grid_.heights.size() !=
        static_cast<std::size_t>(grid_.rows) * static_cast<std::size_t>(grid_.columns))
        throw std::runtime_error("a terrain needs rows x columns heights");
    for (const double h : grid_.heights)
        if (!std::isfinite(h)) throw std::runtime_error("a terrain's heights must all be finite");
    const auto [low, high] = std::minmax_element(grid_.heights.begin(), grid_.heights.end());
    lowest_ = *low;
    highest_ = *high;
}

Terrain::Jet Terrain::jet(double x, double y) const {
    int column, row;
    double tx, ty;
    locate((x + half_width()) / grid_.cell, grid_.columns, column, tx);
    locate((half_length() - y) / grid_.cell, grid_.rows, row, ty);
    const Weights wx = weights(tx), wy = weights(ty);
    Jet sum;
    for (int i = 0; i < 4; ++i) {
        double f = 0, f1 = 0, f2 = 0;  // along x, by cells
        for (int j = 0; j < 4; ++j) {
            const auto k = static_cast<std::size_t>(j);
            const double h = grid_.heights[index_of(grid_, row - 1 + i, column - 1 + j)];
            f += wx.value[k] * h;
            f1 += wx.first[k] * h;
            f2 += wx.second[k] * h;
        }
        const auto k = static_cast<std::size_t>(i);
        sum.f += wy.value[k] * f;
        sum.fx += wy.value[k] * f1;
        sum.fxx += wy.value[k] * f2;
        sum.fy -= wy.first[k] * f;  // rows run south, y runs north
        sum.fxy -= wy.first[k] * f1;
        sum.fyy += wy.second[k] * f;
    }
    const double by_m = 1 / grid_.cell;
    sum.fx *= by_m;
    sum.fy *= by_m;
    sum.fxx *= by_m * by_m;
    sum.fxy *= by_m * by_m;
    sum.fyy *= by_m * by_m;
    return sum;
}

Eigen::Vector3d Terrain::normal(double x, double y) const {
    const Jet j = jet(x, y);
    return Eigen::Vector3d(-j.fx, -j.fy, 1).normalized();
}

/// Newton's method on q(x, y) = |(x, y, f) - p|^2 / 2, with the Gauss-Newton matrix (always positive
/// definite) where the Hessian is not, and halved steps until q falls.
Eigen::Vector2d Terrain::refine(Eigen::Vector2d at, const Eigen::Vector3d& p) const {
    constexpr int max_steps = 40, max_halvings = 30;
    const auto q_of = [&](const Eigen::Vector2d& a, double f) {
        const double dz = f - p.z();
        return 0.5 * ((a - p.head<2>()).squaredNorm() + dz * dz);
    };
    Jet j = jet(at.x(), at.y());
    for (int step = 0; step < max_steps; ++step) {
        const double dz = j.f - p.z();
        const Eigen::Vector2d slope(j.fx, j.fy);
        const Eigen::Vector2d gradient = at - p.head<2>() + dz * slope;
        Eigen::Matrix2d hessian = Eigen::Matrix2d::Identity() + slope * slope.transpose();
        const Eigen::Matrix2d gauss_newton = hessian;
        hessian(0, 0) += dz * j.fxx;
        hessian(1, 1) += dz * j.fyy;
        hessian(0, 1) += dz * j.fxy;
        hessian(1, 0) += dz * j.fxy;
        const bool convex = hessian(0, 0) > 0 && hessian.determinant() > 1e-6;
        Eigen::Vector2d move = -(convex ? hessian : gauss_newton).inverse() * gradient;
        if (move.norm() > 2 * grid_.cell) move *= 2 * grid_.cell / move.norm();
        if (move.norm() < 1e-13) break;

        // This close, q differs by less than a double resolves, but its gradient does not: use Newton's step.
        if (convex && move.norm() < 1e-4 * grid_.cell) {
            at += move;
            j = jet(at.x(), at.y());
            continue;
        }
        const double q = q_of(at, j.f);
        bool fell = false;
        for (int halving = 0; halving < max_halvings && !fell; ++halving, move *= 0.5) {
            const Eigen::Vector2d next = at + move;
            const Jet there = jet(next.x(), next.y());
            if (q_of(next, there.f) < q) {
                at = next;
                j = there;
                fell = true;
            }
        }
        if (!fell) break;  // as close as doubles resolve
    }
    return at;
}

Terrain::Foot Terrain::foot(const Eigen::Vector3d& p) const {
    // The nearest point is no farther than the point straight above or below p: search that disc.
    const double vertical = height(p.x(), p.y()) - p.z();
    const double radius = std::abs(vertical);
    const double step = std::max(0.5 * grid_.cell, radius / 16);
    const int reach = std::min(16, static_cast<int>(std::ceil(radius / step)));
    Eigen::Vector2d best = p.head<2>();
    double nearest = radius * radius;
    for (int i = -reach; i <= reach; ++i)
        for (int k = -reach; k <= reach; ++k) {
            const Eigen::Vector2d offset(i * step, k * step);
            if (offset.squaredNorm() >= nearest) continue;
            const Eigen::Vector2d at = p.head<2>() + offset;
            const double dz = height(at.x(), at.y()) - p.z();
            const double squared = offset.squaredNorm() + dz * dz;
            if (squared < nearest) nearest = squared, best = at;
        }
    best = refine(best, p);
    const Jet j = jet(best.x(), best.y());
    Foot foot;
    foot.point = {best.x(), best.y(), j.f};
    foot.normal = Eigen::Vector3d(-j.fx, -j.fy, 1).normalized();
    foot.distance = std::copysign((p - foot.point).norm(), -vertical);
    return foot;
}

HeightGrid smoothed(HeightGrid grid, double sigma) {
    if (!(sigma > 0)) return grid;
    const int reach = static_cast<int>(std::ceil(4 * sigma));
    std::vector<double> kernel;
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
        kernel.push_back(std::exp(-0.5 * (i / sigma) * (i / sigma)));
        sum += kernel.back();
    }
    for (double& w : kernel) w /= sum;
    const auto pass = [&](int step_row, int step_column) {
        std::vector<double> out(grid.heights.size());
        for (int r = 0; r < grid.rows; ++r)
            for (int c = 0; c < grid.columns; ++c) {
                double h = 0;
                for (int i = -reach; i <= reach; ++i)
                    h += kernel[static_cast<std::size_t>(i + reach)] *
                         grid.heights[index_of(grid, r + i * step_row, c + i * step_column)];
                out[index_of(grid, r, c)] = h;
            }
        grid.heights = std::move(out);
    };
    pass(0, 1);
    pass(1, 0);
    return grid;
}

}  // namespace surface
