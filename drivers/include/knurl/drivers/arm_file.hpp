#pragma once

/// @file
/// A serial arm as a TOML file: all that a serial device needs. drivers/arms/ has those that are shipped, and
/// drivers/README.md the keys.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/drivers/link_config.hpp>
#include <knurl/drivers/serial_chain.hpp>
#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// Angles or, of a sliding joint, places between which something may be. Infinite: not known.
struct Between {
    /// Least value (rad, m); -infinity: not known.
    double least = -std::numeric_limits<double>::infinity();
    /// Greatest value (rad, m); infinity: not known.
    double greatest = std::numeric_limits<double>::infinity();
    /// True: there is a range.
    bool known() const { return least > -std::numeric_limits<double>::infinity(); }
};

/// One axis that is sensed, and driven unless passive. Its angle is the motor's, as a JointSample has it.
struct ArmAxis {
    /// Name of the axis.
    std::string name;
    /// Where its stops are.
    Between limits;
    /// True: an encoder without a motor.
    bool passive = false;
    /// Radians (metres, if sliding) per count of the encoder.
    std::optional<double> radians_per_count;
    /// Largest effort of the motor (N m; N if sliding).
    std::optional<double> effort_limit;
    /// Effort per count of the amplifier (N m; N if sliding).
    std::optional<double> effort_per_count;
};

/// A number of the file, and where it comes from.
struct ArmFigure {
    /// Where in the file: "row 2: a".
    std::string name;
    /// The figure.
    std::string value;
    /// Where it comes from.
    std::string source;
};

/// A serial arm as a file describes it.
struct ArmFile {
    /// Path of the file; of a shipped one "arms/NAME.toml".
    std::string path;
    /// Name: "omni".
    std::string name;
    /// One line for people.
    std::string description;
    /// Source of all figures that state none of their own.
    std::string source;

    /// Kinematics. The device frame has its origin at the tip in the posture `centre`; x away from the base,
    /// z up, unless the file turns the base.
    SerialChainTable table;
    /// Where the rows' variables, A q, have stops.
    std::vector<Between> row_limits;
    /// The axes, driven ones first.
    std::vector<ArmAxis> axes;
    /// Posture with the tip in the middle of the workspace (rad, m).
    JointArray centre = {};
    /// Radius of the workspace (m).
    double workspace_radius = 0;
    /// Rate of the servo's loop (Hz).
    double rate = 1000;

    /// One count at the centre, at the tip (m), where counts are not known. This and the following figures:
    /// none is not known.
    std::optional<double> resolution;
    /// Peak force at the tip (N).
    std::optional<double> peak_force;
    /// Continuous force at the tip (N).
    std::optional<double> continuous_force;
    /// Peak torque at the tip (N m).
    std::optional<double> peak_torque;
    /// Apparent mass at the tip (kg).
    std::optional<double> mass;
    /// Damping at the tip (N s/m).
    std::optional<double> damping;
    /// Dry friction at the tip (N).
    std::optional<double> friction;
    /// Largest stiffness at the tip, as measured (N/m).
    std::optional<double> max_stiffness;
    /// Rotational inertia at the tip (kg m^2).
    std::optional<double> rotational_inertia;
    /// Rotational damping at the tip (N m s/rad).
    std::optional<double> rotational_damping;
    /// Inertia of each axis (kg m^2).
    std::optional<double> joint_inertia;
    /// Bandwidth of the actuators (Hz).
    std::optional<double> bandwidth;
    /// Time without a write until the device switches its motors off (s).
    std::optional<double> watchdog;

    /// All figures with their sources.
    std::vector<ArmFigure> figures;

    /// Number of axes.
    std::size_t joints() const { return axes.size(); }
    /// Number of driven axes.
    std::size_t actuated() const;
};

/// Reads a file. Throws std::runtime_error "FILE:LINE:COLUMN: what; what to do" for the first mistake: a
/// wrong number of rows, axes or columns, a singular coupling, missing or reversed limits, numbers that look
/// like another unit, unknown keys, no source, ...
ArmFile load_arm(const std::string& path);
/// The same from text; `name` stands for the file in messages.
ArmFile parse_arm(std::string_view text, const std::string& name);

/// Finds an arm by path (with a slash, or ending in .toml) or by name: first of the arms that are built in,
/// then of files in $KNURL_ARMS_DIR, then in the installed share/knurl/arms. Throws std::runtime_error.
ArmFile find_arm(const std::string& name_or_path);
/// Names of the arms that are built in.
std::vector<std::string> shipped_arms();

/// What a driver says about such a device. Where the file knows no count or effort limit of an axis, they
/// follow from resolution and peak_force at the tip; what stays unknown is 0.
LinkConfig link_of(const ArmFile& arm);

/// A simulated device of that arm. What the file does not know is taken from SimProfile's own figures and
/// listed, one line each, in `assumed`.
SimProfile sim_profile_of(const ArmFile& arm, std::vector<std::string>* assumed = nullptr);

}  // namespace knurl::drivers
