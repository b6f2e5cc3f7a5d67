#pragma once
// A motion over time from a CSV file: where a hand goes, or wants to go.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace knurl::drivers {

struct MotionRow {
    double t = 0;                                        // s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

struct MotionSample {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // m/s
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s, in the frame of the motion
};

/// Rows with strictly increasing times. Between rows: position linear, orientation by slerp along the shorter
/// arc. Velocity is that of the segment that begins at that time; at the last row, of the one that ends
/// there. Before the first row and after the last: the row itself, at rest.
class Motion {
  public:
    /// Throws std::runtime_error: no rows, times that do not increase, numbers that are not finite, a zero
    /// quaternion. Quaternions are normalised.
    explicit Motion(std::vector<MotionRow> rows, bool has_orientation = false);

    double begin() const noexcept { return rows_.front().t; }  // s
    double end() const noexcept { return rows_.back().t; }     // s
    bool has_orientation() const noexcept { return has_orientation_; }
    const std::vector<MotionRow>& rows() const noexcept { return rows_; }

    MotionSample sample(double t) const noexcept;
    /// The same; `hint` remembers the segment between calls, which makes steady progress cost no search.
    MotionSample sample(double t, std::size_t& hint) const noexcept;

  private:
    std::vector<MotionRow> rows_;
    std::vector<Eigen::Vector3d> turn_;  // rotation vector of each segment, rad, frame of the motion
    bool has_orientation_;
};

/// Reads `t,x,y,z` or `t,x,y,z,qw,qx,qy,qz` (s, m), with or without a header line; blank lines and lines that
/// begin with # are skipped. Throws std::runtime_error "FILE:LINE: column N (name): what; what to do".
Motion load_motion(const std::string& path);
/// The same from text; `name` stands for the file in messages.
Motion parse_motion(std::string_view text, const std::string& name);

/// Beyond what a hand reaches a length was probably meant in mm: "..., but lengths are in metres; ...". None: it
/// is not.
std::optional<std::string> unit_doubt(const Motion& motion);

}  // namespace knurl::drivers
