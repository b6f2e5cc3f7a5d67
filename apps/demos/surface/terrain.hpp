#pragma once
// The true surface: a height field z = f(x, y) as a uniform bicubic B-spline.
//
// A B-spline rather than Catmull-Rom: its curvature is continuous (C2), so a tangent plane that follows the
// hand turns smoothly, and Newton's method for the foot converges from everywhere near. It never overshoots
// its control heights, so it has no pit or bump that the data do not have. The price: it passes near the
// samples, not through them (as if they were smoothed by the weights 1/6 2/3 1/6).

#include <vector>

#include <Eigen/Dense>

namespace surface {

/// Control heights on a regular grid, in the hand's world: row 0 lies at the largest y (north), column 0 at
/// the smallest x (west), the grid's middle at x = y = 0.
struct HeightGrid {
    int rows = 0, columns = 0;
    double cell = 0;                   // m, distance of neighbours
    std::vector<double> heights = {};  // m, row by row
};

class Terrain {
  public:
    /// Throws std::runtime_error if the grid is smaller than 4 x 4, or a height or the cell is not finite.
    explicit Terrain(HeightGrid grid);

    struct Jet {
        double f = 0;                      // m
        double fx = 0, fy = 0;             // 1
        double fxx = 0, fxy = 0, fyy = 0;  // 1/m
    };
    /// Height and derivatives; beyond the grid the border's last heights continue level (still C2).
    Jet jet(double x, double y) const;
    double height(double x, double y) const { return jet(x, y).f; }
    Eigen::Vector3d normal(double x, double y) const;  // unit, upwards

    struct Foot {
        Eigen::Vector3d point = Eigen::Vector3d::Zero();    // m
        Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, upwards
        double distance = 0;                                // m, signed: negative below the surface
    };
    /// The surface's nearest point to p. Exact (the global minimum) for |p_z - f(p_x, p_y)| <= 8 cells;
    /// farther away the nearest of the minima that a coarser search finds.
    Foot foot(const Eigen::Vector3d& p) const;

    const HeightGrid& grid() const { return grid_; }
    double half_width() const { return 0.5 * (grid_.columns - 1) * grid_.cell; }  // m, along x
    double half_length() const { return 0.5 * (grid_.rows - 1) * grid_.cell; }    // m, along y
    double lowest() const { return lowest_; }                                     // m, of the control heights
    double highest() const { return highest_; }

  private:
    Eigen::Vector2d refine(Eigen::Vector2d at, const Eigen::Vector3d& p) const;

    HeightGrid grid_;
    double lowest_ = 0, highest_ = 0;
};

/// Smooths the heights with a Gaussian of standard deviation `sigma` cells (cut at 4 sigma, borders
/// repeated).
HeightGrid smoothed(HeightGrid grid, double sigma);

}  // namespace surface
