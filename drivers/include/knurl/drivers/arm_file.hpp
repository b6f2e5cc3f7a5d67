#pragma once
// A serial arm as a TOML file: all that a serial device needs. drivers/arms/ has those that are shipped, and
// drivers/README.md the keys.

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
    double least = -std::numeric_limits<double>::infinity();    // rad (m)
    double greatest = std::numeric_limits<double>::infinity();  // rad (m)
    bool known() const { return least > -std::numeric_limits<double>::infinity(); }
};

/// One axis that is sensed, and driven unless passive. Its angle is the motor's, as a JointSample has it.
struct ArmAxis {
    std::string name;
    Between limits;
    bool passive = false;                     // an encoder without a motor
    std::optional<double> radians_per_count;  // (m)
    std::optional<double> effort_limit;       // N m (N)
    std::optional<double> effort_per_count;   // N m (N) a count of the amplifier's
};

/// A number of the file, and where it comes from.
struct ArmFigure {
    std::string name;  // "row 2: a"
    std::string value;
    std::string source;
};

struct ArmFile {
    std::string path;         // of the file; of a shipped one "arms/NAME.toml"
    std::string name;         // "omni"
    std::string description;  // one line
    std::string source;       // of all figures that state none of their own

    /// The device frame has its origin at the tip in the posture `centre`; x away from the base, z up, unless
    /// the file turns the base.
    SerialChainTable table;
    std::vector<Between> row_limits;  // of the rows' variables, A q
    std::vector<ArmAxis> axes;        // driven ones first
    JointArray centre = {};           // rad (m), the tip in the middle of the workspace
    double workspace_radius = 0;      // m
    double rate = 1000;               // Hz

    // At the tip; what the file does not say is not known.
    std::optional<double> resolution;        // m, one count at the centre, where counts are not known
    std::optional<double> peak_force;        // N
    std::optional<double> continuous_force;  // N
    std::optional<double> peak_torque;       // N m
    std::optional<double> mass;              // kg, apparent
    std::optional<double> damping;           // N s/m
    std::optional<double> friction;          // N, dry
    std::optional<double> max_stiffness;     // N/m, measured
    std::optional<double> rotational_inertia, rotational_damping;  // kg m^2, N m s/rad
    std::optional<double> joint_inertia;                           // kg m^2, of each axis
    std::optional<double> bandwidth;                               // Hz, of the actuators
    std::optional<double> watchdog;                                // s

    std::vector<ArmFigure> figures;

    std::size_t joints() const { return axes.size(); }
    std::size_t actuated() const;
};

/// Reads a file. Throws std::runtime_error "FILE:LINE:COLUMN: what; what to do" for the first mistake: a
/// wrong number of rows, axes or columns, a singular coupling, missing or reversed limits, numbers that look
/// like another unit, unknown keys, no source, ...
ArmFile load_arm(const std::string& path);
/// The same from text; `name` stands for the file in messages.
ArmFile parse_arm(std::string_view text, const std::string& name);

/// A path (it has a slash or ends in .toml), else a bare name: first of the arms that are built in, then
/// of files in $KNURL_ARMS_DIR, then in the installed share/knurl/arms.
ArmFile find_arm(const std::string& name_or_path);
/// Names of those that are built in.
std::vector<std::string> shipped_arms();

/// What a driver says about such a device. Where the file knows no count or effort limit of an axis, they
/// follow from resolution and peak_force at the tip; what stays unknown is 0.
LinkConfig link_of(const ArmFile& arm);

/// A simulated device of that arm. What the file does not know is taken from SimProfile's own figures and
/// listed, one line each, in `assumed`.
SimProfile sim_profile_of(const ArmFile& arm, std::vector<std::string>* assumed = nullptr);

}  // namespace knurl::drivers
