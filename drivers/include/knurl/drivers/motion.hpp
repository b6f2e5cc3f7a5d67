#pragma once

/// @file
/// A motion over time from a CSV file: where a hand goes, or wants to go.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace knurl::drivers {

/// The pose at one time.
struct MotionRow {
    /// Time (s).
    double t = 0;
    /// Position (m).
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    /// Orientation.
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// The motion at some time.
struct MotionSample {
    /// Position (m).
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    /// Orientation.
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    /// Velocity (m/s).
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    /// Angular velocity (rad/s), in the frame of the motion.
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
};

/// Rows with strictly increasing times. Between rows: position linear, orientation by slerp along the shorter
/// arc. Velocity is that of the segment that begins at that time; at the last row, of the one that ends
/// there. Before the first row and after the last: the row itself, at rest.
class Motion {
  public:
    /// Throws std::runtime_error: no rows, times that do not increase by a nanosecond at least, numbers that are
    /// not finite, places beyond 1e6 m, times beyond 1e9 s, a quaternion whose length is not 1e-6 to 1e6.
    /// Quaternions are normalised.
    explicit Motion(std::vector<MotionRow> rows, bool has_orientation = false);

    /// Time of the first row (s).
    double begin() const noexcept { return rows_.front().t; }
    /// Time of the last row (s).
    double end() const noexcept { return rows_.back().t; }
    /// True: the rows state an orientation.
    bool has_orientation() const noexcept { return has_orientation_; }
    /// The rows.
    const std::vector<MotionRow>& rows() const noexcept { return rows_; }

    /// The motion at the time t (s).
    MotionSample sample(double t) const noexcept;
    /// The same; `hint` remembers the segment between calls, which makes steady progress cost no search.
    MotionSample sample(double t, std::size_t& hint) const noexcept;

  private:
    std::vector<MotionRow> rows_;
    std::vector<Eigen::Vector3d> turn_;  // rotation vector of each segment, rad, frame of the motion
    bool has_orientation_;
};

/// Reads `t,x,y,z` or `t,x,y,z,qw,qx,qy,qz` (s, m), with or without a header line; blank lines and lines that
/// begin with # are skipped. The numbers are within the bounds of Motion. Throws std::runtime_error "FILE:LINE: column N (name): what; what to do".
Motion load_motion(const std::string& path);
/// The same from text; `name` stands for the file in messages.
Motion parse_motion(std::string_view text, const std::string& name);

/// Says "..., but lengths are in metres; ..." if the motion goes beyond what a hand reaches, so that it was
/// probably meant in mm. None: it does not.
std::optional<std::string> unit_doubt(const Motion& motion);

}  // namespace knurl::drivers
