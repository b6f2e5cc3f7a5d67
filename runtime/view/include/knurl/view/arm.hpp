#pragma once
// A device's arm as lines to draw.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/serial_chain.hpp>

namespace knurl::view {

/// Lines through points (m), device frame.
using Lines = std::vector<std::vector<Eigen::Vector3d>>;

/// From row to row, with a point where d ends and a begins.
Lines skeleton(const drivers::SerialChainTable& chain, const drivers::JointArray& joints);
/// Base, crank and platform of each leg; the parallelogram is the line between crank and platform. `tip`: where the
/// platform is.
Lines skeleton(const drivers::DeltaTable& delta, const Eigen::Vector3d& tip,
               const drivers::JointArray& joints);

/// The links of a device, as far as its address says them: one of these, or none.
struct Arm {
    std::optional<drivers::SerialChainTable> chain;
    std::optional<drivers::DeltaTable> delta;

    /// The arm of "sim:premium15,grip=0.5", "sim:arm=mine.toml", "falcon:", "wooden:". Empty: its links are not known.
    static Arm of_address(const std::string& address);
    /// The lines of a posture whose tip is there. Empty: the links are not known, or are of another arm, since their
    /// tip is elsewhere.
    Lines lines(const drivers::JointArray& joints, const Eigen::Vector3d& tip) const;
};

}  // namespace knurl::view
