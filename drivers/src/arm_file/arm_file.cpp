// TOML -> ArmFile.

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include <Eigen/LU>
#include <Eigen/SVD>

#include <knurl/drivers/serial_chain.hpp>
#include <knurl/words/toml.hpp>

#include "arm_file/reader.hpp"

namespace knurl::drivers {

namespace {

constexpr std::size_t largest_file = 1 << 20;  // bytes
constexpr double singular = 1e6;  // condition of a coupling: three-digit values never come near it

/// The tables of a [[name]].
std::vector<const toml::table*> tables_of(const ArmTable& root, std::string_view name,
                                          std::string_view what) {
    const toml::node* node = root.table().get(name);
    if (node == nullptr) {
        root.fail(name, "no [[" + std::string(name) + "]]; write one for each " + std::string(what));
    }
    std::vector<const toml::table*> tables;
    const toml::array* array = node->as_array();
    for (std::size_t i = 0; array != nullptr && i < array->size(); ++i)
        tables.push_back((*array)[i].as_table());
    if (tables.empty() || std::find(tables.begin(), tables.end(), nullptr) != tables.end()) {
        root.fail(name, "'" + std::string(name) + "' must be a list of tables; write [[" + std::string(name) +
                            "]] above the keys of each");
    }
    return tables;
}

void read_rows(ArmFile& arm, const ArmTable& root) {
    const auto tables = tables_of(root, "row", "joint, from the base outwards");
    if (tables.size() > static_cast<std::size_t>(max_joints)) {
        root.fail_at(*tables[max_joints], std::to_string(tables.size()) + " rows; an arm has at most " +
                                              std::to_string(max_joints) + " joints");
    }
    for (const toml::table* each : tables) {
        const std::string called = "row " + std::to_string(arm.table.rows.size() + 1);
        ArmTable table(
            arm, *each, called,
            {"theta", "theta_deg", "d", "a", "alpha", "alpha_deg", "prismatic", "limits", "limits_deg"});
        DhRow row;
        row.theta = table.angle("theta").value_or(0);
        row.d = table.length("d").value_or(0);
        row.a = table.length("a").value_or(0);
        row.alpha = table.angle("alpha").value_or(0);
        row.prismatic = table.flag("prismatic");
        arm.row_limits.push_back(table.between("limits", row.prismatic).value_or(Between{}));
        arm.table.rows.push_back(row);
    }
}

void read_axis(ArmFile& arm, const toml::table& node, bool sliding) {
    const std::string called = "axis " + std::to_string(arm.axes.size() + 1);
    const std::string_view per_count = sliding ? "metres_per_count" : "radians_per_count";
    ArmTable table(arm, node, called,
                   {"name", "limits", "limits_deg", "passive", "counts_per_turn", "gear", per_count,
                    "effort_limit", "effort_per_count"});
    ArmAxis axis;
    axis.name = table.text("name").value_or(called);
    const auto limits = table.between("limits", sliding);
    if (!limits) {
        table.fail("", called + " (" + axis.name + ") has no limits; write " +
                           (sliding ? "limits = [0, 0.1]" : "limits_deg = [-60, 60]") +
                           ", or limits = \"unknown\" if nobody knows them");
    }
    axis.limits = *limits;
    axis.passive = table.flag("passive");
    if (!axis.passive && !arm.axes.empty() && arm.axes.back().passive) {
        table.fail("", called + " is driven and comes after a passive one; name the driven ones first");
    }
    const auto counts = table.number("counts_per_turn", {"counts", 1, 1e9});
    const auto gear = table.number("gear", {"turns of the encoder a turn of the axis", 1e-3, 1e4});
    axis.radians_per_count = table.number(per_count, {sliding ? "m" : "rad", 0, 0.1, false});
    if (counts && sliding) table.fail("counts_per_turn", called + " slides; write metres_per_count");
    if (counts && axis.radians_per_count) {
        table.fail("counts_per_turn", called + " has both counts_per_turn and radians_per_count; keep one");
    }
    if (gear && !counts)
        table.fail("gear", "gear of " + called + " is that of counts_per_turn, which is missing");
    if (counts) axis.radians_per_count = 2 * std::numbers::pi / (*counts * gear.value_or(1));
    const std::string_view unit = sliding ? "N" : "N m";
    axis.effort_limit = table.number("effort_limit", {unit, 0, sliding ? 1000.0 : 100.0, false});
    axis.effort_per_count = table.number("effort_per_count", {unit, 0, 10, false});
    if (axis.passive && (axis.effort_limit || axis.effort_per_count)) {
        table.fail(axis.effort_limit ? "effort_limit" : "effort_per_count",
                   called + " is passive and has no effort; remove this, or passive");
    }
    arm.axes.push_back(axis);
}

void read_axes(ArmFile& arm, const ArmTable& root) {
    const auto tables = tables_of(root, "axis", "motor and encoder");
    const std::size_t rows = arm.table.rows.size();
    if (tables.size() != rows) {
        root.fail_at(*tables.back(), std::to_string(tables.size()) + " axes for " + std::to_string(rows) +
                                         " rows; give one [[axis]] for each [[row]], passive ones too");
    }
    for (std::size_t i = 0; i < rows; ++i) read_axis(arm, *tables[i], arm.table.rows[i].prismatic);
    if (arm.actuated() == 0) {
        root.fail_at(*tables.front(), "all axes are passive; at least one must have a motor");
    }
}

void read_coupling(ArmFile& arm, ArmTable& root) {
    const toml::node* node = root.table().get("coupling");
    if (node == nullptr) return;
    const std::size_t n = arm.joints();
    const std::string size = std::to_string(n) + " rows of " + std::to_string(n) + " numbers";
    const toml::array* rows = node->as_array();
    if (rows == nullptr || rows->size() != n) {
        root.fail("coupling", "coupling must be " + size +
                                  ", one row per [[row]], one column per [[axis]]; it has " +
                                  std::to_string(rows == nullptr ? 0 : rows->size()) + " rows");
    }
    const auto side = static_cast<Eigen::Index>(n);
    Eigen::MatrixXd a(side, side);
    for (std::size_t i = 0; i < n; ++i) {
        const toml::array* row = (*rows)[i].as_array();
        if (row == nullptr || row->size() != n) {
            root.fail_at((*rows)[i], "row " + std::to_string(i + 1) + " of coupling has " +
                                         std::to_string(row == nullptr ? 0 : row->size()) +
                                         " columns; coupling must be " + size);
        }
        for (std::size_t j = 0; j < n; ++j) {
            a(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                root.value((*row)[j], "column " + std::to_string(j + 1) + " of row " + std::to_string(i + 1) +
                                          " of coupling");
        }
    }
    const Eigen::VectorXd sizes = Eigen::JacobiSVD<Eigen::MatrixXd>(a).singularValues();
    const double condition = sizes[0] / sizes[side - 1];
    if (!(condition < singular)) {
        root.fail("coupling",
                  "coupling is singular (determinant " + in_text(a.determinant()) + ", condition " +
                      in_text(condition) +
                      "): some motion of the rows belongs to no axis; no row of it may be a sum of others");
    }
    root.note("coupling", size);
    arm.table.coupling = a;
}

void read_frames(ArmFile& arm, const ArmTable& root) {
    if (const toml::node* node = root.table().get("base")) {
        if (!node->is_table()) root.fail("base", "base must be a table; write [base]");
        ArmTable table(arm, *node->as_table(), "[base]", {"rpy", "rpy_deg"});
        const auto rpy = table.angles("rpy", 3);
        if (!rpy) table.fail("", "[base] is empty; write rpy_deg = [0, 0, 90] or remove it");
        // As in URDF: about fixed x, then y, then z.
        arm.table.base.linear() = (Eigen::AngleAxisd((*rpy)[2], Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd((*rpy)[1], Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd((*rpy)[0], Eigen::Vector3d::UnitX()))
                                      .toRotationMatrix();
    }
    if (const toml::node* node = root.table().get("tool")) {
        if (!node->is_table()) root.fail("tool", "tool must be a table; write [tool]");
        ArmTable table(arm, *node->as_table(), "[tool]", {"position"});
        const auto position = table.numbers("position", 3, {"m", -3, 3});
        if (!position) table.fail("", "[tool] is empty; write position = [0, 0, 0.05] or remove it");
        arm.table.tool.translation() = Eigen::Vector3d((*position)[0], (*position)[1], (*position)[2]);
    }
}

void read_workspace(ArmFile& arm, const ArmTable& root) {
    const toml::node* node = root.table().get("workspace");
    if (node == nullptr || !node->is_table()) {
        root.fail("workspace", "no [workspace]; write one with centre_deg (a posture) and radius (m)");
    }
    ArmTable table(arm, *node->as_table(), "[workspace]", {"centre", "centre_deg", "radius"});
    std::vector<bool> sliding;
    for (const DhRow& row : arm.table.rows) sliding.push_back(row.prismatic);
    const auto centre = table.angles("centre", arm.joints(), sliding);
    if (!centre) {
        table.fail(
            "",
            "[workspace] has no centre; write centre_deg = [...], the axes' angles with the tip in the "
            "middle");
    }
    std::copy(centre->begin(), centre->end(), arm.centre.begin());
    const auto radius = table.number("radius", {"m", 0, 3, false});
    if (!radius)
        table.fail("", "[workspace] has no radius; write the radius in m of a ball that the tip reaches");
    arm.workspace_radius = *radius;

    const std::string key = table.has("centre") ? "centre" : "centre_deg";
    const auto outside = [&](double q, const Between& limits, const std::string& what) {
        if (q >= limits.least && q <= limits.greatest) return;
        table.fail(key, "the workspace's centre is outside of the limits of " + what + ": " + in_text(q) +
                            " is not from " + in_text(limits.least) + " to " + in_text(limits.greatest) +
                            " rad (m)");
    };
    for (std::size_t i = 0; i < arm.joints(); ++i) {
        outside(arm.centre[i], arm.axes[i].limits, "axis " + std::to_string(i + 1));
        outside(arm.table.variable(i, arm.centre), arm.row_limits[i], "row " + std::to_string(i + 1));
    }
    // The tip in that posture becomes the origin of the device frame; the axes stay those of the base.
    TipPose pose;
    Jacobian jacobian;
    SerialChain(arm.table).forward(arm.centre, pose, jacobian);
    arm.table.base.translation() = -pose.position;
}

void read_figures(ArmFile& arm, const ArmTable& root) {
    if (const toml::node* node = root.table().get("tip")) {
        if (!node->is_table()) root.fail("tip", "tip must be a table; write [tip]");
        ArmTable table(arm, *node->as_table(), "[tip]",
                       {"resolution", "peak_force", "continuous_force", "peak_torque", "mass", "damping",
                        "friction", "max_stiffness", "rotational_inertia", "rotational_damping"});
        arm.resolution = table.number("resolution", {"m", 0, 0.01, false});
        arm.peak_force = table.number("peak_force", {"N", 0, 1000, false});
        arm.continuous_force = table.number("continuous_force", {"N", 0, 1000, false});
        arm.peak_torque = table.number("peak_torque", {"N m", 0, 100, false});
        arm.mass = table.number("mass", {"kg", 0, 20, false});
        arm.damping = table.number("damping", {"N s/m", 0, 100});
        arm.friction = table.number("friction", {"N", 0, 100});
        arm.max_stiffness = table.number("max_stiffness", {"N/m", 0, 1e6, false});
        arm.rotational_inertia = table.number("rotational_inertia", {"kg m^2", 0, 1, false});
        arm.rotational_damping = table.number("rotational_damping", {"N m s/rad", 0, 10});
        if (arm.continuous_force && arm.peak_force && *arm.continuous_force > *arm.peak_force) {
            table.fail("continuous_force", "continuous_force of [tip] is " + in_text(*arm.continuous_force) +
                                               " N, more than peak_force, " + in_text(*arm.peak_force) +
                                               " N");
        }
    }
    if (const toml::node* node = root.table().get("drive")) {
        if (!node->is_table()) root.fail("drive", "drive must be a table; write [drive]");
        ArmTable table(arm, *node->as_table(), "[drive]", {"bandwidth", "joint_inertia", "watchdog", "rate"});
        arm.bandwidth = table.number("bandwidth", {"Hz", 1, 1e5});
        arm.joint_inertia = table.number("joint_inertia", {"kg m^2", 0, 1, false});
        arm.watchdog = table.number("watchdog", {"s", 1e-3, 100});
        arm.rate = table.number("rate", {"Hz", 100, 20'000}).value_or(arm.rate);
    }
    for (std::size_t i = 0; i < arm.actuated(); ++i) {
        if (!arm.axes[i].effort_limit && !arm.peak_force) {
            root.fail("axis",
                      "axis " + std::to_string(i + 1) +
                          " has no effort_limit and [tip] no peak_force; one of them is needed, since "
                          "nothing else bounds the motor");
        }
    }
}

}  // namespace

std::size_t ArmFile::actuated() const {
    std::size_t count = 0;
    while (count < axes.size() && !axes[count].passive) ++count;
    return count;
}

ArmFile parse_arm(std::string_view text, const std::string& name) {
    const toml::table table = words::parse_toml(text, name);
    ArmFile arm;
    arm.path = name;
    ArmTable root(arm, table, "an arm",
                  {"name", "description", "position_only", "coupling", "row", "axis", "base", "tool",
                   "workspace", "tip", "drive"});
    arm.source = root.text("source").value_or("");
    const auto called = root.text("name");
    if (!called) root.fail("name", "no name; write name = \"my_arm\" at the top");
    for (const char c : *called) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') {
            root.fail("name", "name is \"" + *called + "\"; use letters, digits, _ and -");
        }
    }
    arm.name = *called;
    arm.description = root.text("description").value_or(arm.name);
    arm.table.position_only = root.flag("position_only");
    read_rows(arm, root);
    read_axes(arm, root);
    read_coupling(arm, root);
    read_frames(arm, root);
    // What the chain refuses is said with its place in the file. It judges a coupling by its determinant.
    try {
        const SerialChain chain(arm.table);
    } catch (const std::runtime_error& error) {
        root.fail("coupling", error.what());
    }
    read_workspace(arm, root);
    read_figures(arm, root);
    return arm;
}

ArmFile load_arm(const std::string& path) {
    const auto refuse = [&path](const std::string& what) {
        return std::runtime_error(path + ": " + what + "; give an arm's TOML file");
    };
    // A device or a pipe may be endless, and opening one may block: both are refused.
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::none)
        throw std::runtime_error(path + ": cannot be read: " + error.message());
    if (std::filesystem::is_directory(status)) throw refuse("is a folder");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw refuse("is a device, pipe or socket, not a file");
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file.is_open()) throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
    std::string text(largest_file + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (file.bad()) throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.size() > largest_file) throw refuse("is larger than 1 MiB, and an arm has some 3 KiB");
    return parse_arm(text, path);
}

}  // namespace knurl::drivers
