#pragma once
// What an arm can do, reckoned from its description alone: reach, condition, force, resolution. No hardware.

#include <optional>
#include <string>
#include <vector>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/drivers/delta.hpp>

namespace knurl::cli {

/// A thing to be checked: a profile and what a file says about it besides.
struct CheckedArm {
    drivers::SimProfile profile;
    std::vector<drivers::Between> row_limits;  // of A q; empty: none
    std::vector<std::string> axis_names;
    std::vector<drivers::ArmFigure> figures;
    std::vector<std::string> assumed;
    std::vector<std::string> unlimited;              // axes whose limits nobody knows
    std::optional<drivers::SerialChainTable> chain;  // one of these two
    std::optional<drivers::DeltaTable> delta;
};

/// A file or a name of find_arm, or "falcon". Throws as find_arm does.
CheckedArm checked_arm(const std::string& name_or_path);

/// The arm in a posture as lines to draw, m, device frame.
using Lines = std::vector<std::vector<Eigen::Vector3d>>;
Lines skeleton(const CheckedArm& arm, const drivers::JointArray& joints);

/// One step along a straight line from the centre.
struct Reached {
    Eigen::Vector3d position;  // m
    double conditioning;       // 0 to 1
};
/// How far the tip goes from the centre in a direction, and what stops it.
struct Ray {
    std::vector<Reached> steps;
    double length = 0;  // m
    std::string stop;   // "the limit of axis 2 (upper arm)", "the arm's length", "" (further than was looked)
};
Ray ray(const CheckedArm& arm, const Eigen::Vector3d& direction);

struct Extreme {
    double value = 0;
    Eigen::Vector3d where = Eigen::Vector3d::Zero();  // m, or a direction
};

struct ArmCheck {
    // m, box of what was reached
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
    double ball = 0;  // m, radius of the largest ball about the centre that is all in reach
    Eigen::Vector3d ball_end = Eigen::Vector3d::Zero();  // direction in which it ends
    std::string ball_stop;
    double out_of_reach = 0;                                    // share of the stated workspace, 0 to 1
    Extreme best_condition, median_condition, worst_condition;  // sigma max / sigma min over the workspace
    double badly_conditioned = 0;     // share of the workspace with a condition above 20
    std::optional<Extreme> singular;  // nearest posture with a condition above 100: distance, where

    // N, what the motors can hold at the tip before the first one is at its limit.
    Extreme weakest_at_centre;  // value and direction
    std::string weakest_axis;
    Extreme strongest_at_centre;                           // value and direction
    Eigen::Vector3d along_axes = Eigen::Vector3d::Zero();  // x, y, z
    std::vector<Extreme> every_way_at_centre;              // values and directions, evenly over a sphere
    Extreme weakest_anywhere;                              // value and place
    // N m, likewise; where the arm renders torque
    Eigen::Vector3d torque_about_axes = Eigen::Vector3d::Zero();  // x, y, z
    // m that one count of the coarsest axis moves the tip; 0: counts are not known
    double resolution_at_centre = 0, median_resolution = 0;
    Extreme worst_resolution;
    // rad that one count turns the tip at the centre; where torque is rendered
    double angular_resolution = 0;
};
ArmCheck check(const CheckedArm& arm);

std::string report_text(const CheckedArm& arm, const ArmCheck& check);
std::string report_json(const CheckedArm& arm, const ArmCheck& check);
/// Side and top view as a PNG. Throws std::runtime_error if it cannot be written.
void draw(const CheckedArm& arm, const ArmCheck& check, const std::string& path);

}  // namespace knurl::cli
