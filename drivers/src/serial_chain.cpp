#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include <knurl/drivers/serial_chain.hpp>

namespace knurl::drivers {

namespace {

constexpr double longest_link = 10;         // m: a longer one was probably given in millimetres
constexpr double singular_coupling = 1e-9;  // relative to the largest entry to the power of the size

void check(const SerialChainTable& table) {
    const auto n = static_cast<Eigen::Index>(table.rows.size());
    if (n < 1 || n > max_joints) {
        throw std::runtime_error("serial chain: " + std::to_string(n) + " rows; give 1 to " +
                                 std::to_string(max_joints));
    }
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const DhRow& row = table.rows[i];
        const std::string where = "serial chain: row " + std::to_string(i + 1);
        if (!std::isfinite(row.theta) || !std::isfinite(row.d) || !std::isfinite(row.a) ||
            !std::isfinite(row.alpha)) {
            throw std::runtime_error(where + " holds a number that is not finite");
        }
        if (std::abs(row.d) > longest_link || std::abs(row.a) > longest_link) {
            throw std::runtime_error(where + ": a link of " +
                                     std::to_string(std::max(std::abs(row.d), std::abs(row.a))) +
                                     " m; lengths are in metres");
        }
    }
    if (!table.base.matrix().allFinite() || !table.tool.matrix().allFinite()) {
        throw std::runtime_error("serial chain: base or tool transform is not finite");
    }
    if (table.coupling.size() == 0) {
        return;
    }
    if (table.coupling.rows() != n || table.coupling.cols() != n) {
        throw std::runtime_error("serial chain: coupling is " + std::to_string(table.coupling.rows()) +
                                 " x " + std::to_string(table.coupling.cols()) + "; give " +
                                 std::to_string(n) + " x " + std::to_string(n) +
                                 ", one row per joint, one column per motor");
    }
    const double scale = table.coupling.cwiseAbs().maxCoeff();
    if (!table.coupling.allFinite() ||
        !(std::abs(table.coupling.determinant()) > singular_coupling * std::pow(scale, n))) {
        throw std::runtime_error(
            "serial chain: the coupling is singular: two motors would move the same joints");
    }
}

}  // namespace

double SerialChainTable::variable(std::size_t row, std::span<const double> motors) const {
    if (coupling.size() == 0) return motors[row];
    return coupling.row(static_cast<Eigen::Index>(row))
        .dot(Eigen::Map<const Eigen::VectorXd>(motors.data(), coupling.cols()));
}

SerialChain::SerialChain(const SerialChainTable& table)
    : count_((check(table), table.rows.size())),
      coupled_(table.coupling.size() != 0),
      position_only_(table.position_only),
      base_rotation_(table.base.linear()),
      tool_rotation_(table.tool.linear()),
      base_position_(table.base.translation()),
      tool_position_(table.tool.translation()) {
    for (std::size_t i = 0; i < count_; ++i) {
        const DhRow& row = table.rows[i];
        rows_[i] = {.theta = row.theta,
                    .d = row.d,
                    .a = row.a,
                    .cos_alpha = std::cos(row.alpha),
                    .sin_alpha = std::sin(row.alpha),
                    .prismatic = row.prismatic};
        for (std::size_t m = 0; m < count_; ++m) {
            coupling_[i][m] = coupled_
                                  ? table.coupling(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(m))
                                  : static_cast<double>(i == m);
        }
    }
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): in the cycle, a split cost 10 ns of 230
bool SerialChain::forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept {
    if (joints.size() < count_) {
        return false;
    }
    // Frame i-1 by its columns: x, y, z and the origin p; joint i turns about (or slides along) z.
    Eigen::Vector3d x = base_rotation_.col(0), y = base_rotation_.col(1), z = base_rotation_.col(2);
    Eigen::Vector3d p = base_position_;
    std::array<Eigen::Vector3d, max_joints> axis, origin;
    for (std::size_t i = 0; i < count_; ++i) {
        double variable = joints[i];
        if (coupled_) {
            variable = 0;
            for (std::size_t m = 0; m < count_; ++m) {
                variable += coupling_[i][m] * joints[m];
            }
        }
        const Row& row = rows_[i];
        axis[i] = z;
        origin[i] = p;
        const double theta = row.prismatic ? row.theta : row.theta + variable;
        const double d = row.prismatic ? row.d + variable : row.d;
        const double c = std::cos(theta), s = std::sin(theta);
        const Eigen::Vector3d turned_x = c * x + s * y;
        const Eigen::Vector3d turned_y = c * y - s * x;
        p += d * z + row.a * turned_x;
        x = turned_x;
        y = row.cos_alpha * turned_y + row.sin_alpha * z;
        z = row.cos_alpha * z - row.sin_alpha * turned_y;
    }
    p += tool_position_.x() * x + tool_position_.y() * y + tool_position_.z() * z;
    if (!p.allFinite()) {
        return false;
    }
    pose.position = p;
    if (position_only_) {
        pose.orientation.setIdentity();
    } else {
        Eigen::Matrix3d rotation;
        rotation << x, y, z;
        pose.orientation = Eigen::Quaterniond(Eigen::Matrix3d(rotation * tool_rotation_));
    }

    jacobian.setZero();
    for (std::size_t i = 0; i < count_; ++i) {
        const bool prismatic = rows_[i].prismatic;
        const Eigen::Vector3d linear = prismatic ? axis[i] : Eigen::Vector3d(axis[i].cross(p - origin[i]));
        for (std::size_t m = 0; m < count_; ++m) {
            const double share = coupling_[i][m];
            if (share == 0) {
                continue;
            }
            const auto column = static_cast<Eigen::Index>(m);
            jacobian.block<3, 1>(0, column) += share * linear;
            if (!prismatic && !position_only_) {
                jacobian.block<3, 1>(3, column) += share * axis[i];
            }
        }
    }
    return true;
}

}  // namespace knurl::drivers
