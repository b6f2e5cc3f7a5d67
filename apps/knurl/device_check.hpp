#pragma once
// What an arm can do, computed from its description alone: reach, condition, force, resolution. No hardware.

#include <optional>
#include <string>
#include <vector>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/drivers/delta.hpp>
#include <knurl/view/arm.hpp>

namespace knurl::cli {

/// The arm to be checked: a profile and the additional values of its file.
struct CheckedArm {
    drivers::SimProfile profile;
    std::vector<drivers::Between> row_limits;  // of A q; empty: none
    std::vector<std::string> axis_names;
    std::vector<drivers::ArmFigure> figures;
    std::vector<std::string> assumed;
    std::vector<std::string> unlimited;              // axes with unknown limits
    std::optional<drivers::SerialChainTable> chain;  // one of these two
    std::optional<drivers::DeltaTable> delta;
};

/// A file or a name of find_arm, or "falcon". Throws as find_arm does.
CheckedArm checked_arm(const std::string& name_or_path);

/// The arm in a posture as lines to draw, m, device frame.
using view::Lines;
Lines skeleton(const CheckedArm& arm, const drivers::JointArray& joints);

/// One step along a straight line from the centre.
struct Reached {
    Eigen::Vector3d position;  // m
    double conditioning;       // 0 to 1
};
/// How far the tip goes from the centre in a direction, and the limit that stops it.
struct Ray {
    std::vector<Reached> steps;
    double length = 0;  // m
    std::string stop;   // "the limit of axis 2 (upper arm)", "the arm's length", "" (farther than the search)
};
Ray ray(const CheckedArm& arm, const Eigen::Vector3d& direction);

struct Extreme {
    double value = 0;
    Eigen::Vector3d where = Eigen::Vector3d::Zero();  // m, or a direction
};

struct ArmCheck {
    // m, box of the reached places
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
    double ball = 0;  // m, radius of the largest reachable ball about the centre
    Eigen::Vector3d ball_end = Eigen::Vector3d::Zero();  // direction in which it is limited
    std::string ball_stop;
    double out_of_reach = 0;                                    // share of the stated workspace, 0 to 1
    Extreme best_condition, median_condition, worst_condition;  // sigma max / sigma min over the workspace
    double badly_conditioned = 0;     // share of the workspace with a condition above 20
    std::optional<Extreme> singular;  // nearest posture with a condition above 100: distance, where

    // N: the force that the motors can hold at the tip before the first one is at its limit.
    Extreme weakest_at_centre;  // value and direction
    std::string weakest_axis;
    Extreme strongest_at_centre;                           // value and direction
    Eigen::Vector3d along_axes = Eigen::Vector3d::Zero();  // x, y, z
    std::vector<Extreme> every_way_at_centre;              // values and directions, evenly over a sphere
    Extreme weakest_anywhere;                              // value and place
    // N m, likewise; where the arm renders torque
    Eigen::Vector3d torque_about_axes = Eigen::Vector3d::Zero();  // x, y, z
    // m, motion of the tip per count of the coarsest axis; 0: counts unknown
    double resolution_at_centre = 0, median_resolution = 0;
    Extreme worst_resolution;
    // rad, rotation of the tip per count at the centre; where torque is rendered
    double angular_resolution = 0;
};
ArmCheck check(const CheckedArm& arm);

std::string report_text(const CheckedArm& arm, const ArmCheck& check);
std::string report_json(const CheckedArm& arm, const ArmCheck& check);
/// Side and top view as a PNG. Throws std::runtime_error if it cannot be written.
void draw(const CheckedArm& arm, const ArmCheck& check, const std::string& path);

}  // namespace knurl::cli
