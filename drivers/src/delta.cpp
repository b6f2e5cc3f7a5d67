#include <cmath>
#include <stdexcept>
#include <string>

#include <knurl/drivers/delta.hpp>

namespace knurl::drivers {

namespace {

constexpr double longest = 10;  // m: a longer one was probably given in millimetres

void check(const DeltaTable& table) {
    const std::pair<const char*, double> lengths[] = {{"r", table.r}, {"s", table.s}, {"a", table.a},
                                                      {"b", table.b}, {"c", table.c}, {"d", table.d},
                                                      {"e", table.e}, {"f", table.f}};
    for (const auto& [name, length] : lengths) {
        if (!std::isfinite(length) || std::abs(length) > longest) {
            throw std::runtime_error(std::string("delta: ") + name + " is " + std::to_string(length) +
                                     " m; give a finite length in metres, at most 10");
        }
    }
    if (!(table.a > 0) || !(table.b > 0)) {
        throw std::runtime_error("delta: crank a and parallelogram b must be longer than 0 m");
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const double between = table.leg[(i + 1) % 3] - table.leg[i];
        if (!std::isfinite(between) || std::abs(std::remainder(between, 2 * std::numbers::pi)) < 0.01) {
            throw std::runtime_error("delta: two legs stand at the same angle; give three different ones");
        }
    }
    if (!table.base.matrix().allFinite()) {
        throw std::runtime_error("delta: the base transform is not finite");
    }
}

}  // namespace

Delta::Delta(const DeltaTable& table)
    : a_((check(table), table.a)),
      b_(table.b),
      bars_(table.d + table.e),
      enough_(enough * (b_ + std::abs(bars_))),
      outwards_(table.c - table.r),
      across_(table.f - table.s),
      legs_(),
      base_rotation_(table.base.linear()),
      base_position_(table.base.translation()) {
    for (std::size_t i = 0; i < 3; ++i) {
        legs_[i] = {.cosine = std::cos(table.leg[i]), .sine = std::sin(table.leg[i])};
    }
    // (second - first) x (third - first) points along +z or -z, depending on the order of the legs.
    const double turn = (legs_[1].cosine - legs_[0].cosine) * (legs_[2].sine - legs_[0].sine) -
                        (legs_[1].sine - legs_[0].sine) * (legs_[2].cosine - legs_[0].cosine);
    side_ = turn > 0 ? 1 : -1;
}

Delta::Cranks Delta::cranks(std::span<const double, 3> joints) const noexcept {
    Cranks ends;
    for (std::size_t i = 0; i < 3; ++i) {
        ends[i] = {a_ * std::cos(joints[i]), a_ * std::sin(joints[i])};
    }
    return ends;
}

Eigen::Vector3d Delta::three_spheres(const Cranks& ends) const noexcept {
    // Each sphere's centre: the platform's centre if the leg had no length.
    std::array<Eigen::Vector3d, 3> centre;
    for (std::size_t i = 0; i < 3; ++i) {
        const double u = ends[i].x() - outwards_, v = -across_;
        centre[i] = {u * legs_[i].cosine - v * legs_[i].sine, u * legs_[i].sine + v * legs_[i].cosine,
                     ends[i].y()};
    }
    // Circumcentre of the triangle, and from there along its normal.
    const Eigen::Vector3d p = centre[1] - centre[0], q = centre[2] - centre[0];
    const Eigen::Vector3d normal = p.cross(q);
    const double square = normal.squaredNorm();
    const Eigen::Vector3d aside =
        (p.squaredNorm() * q.cross(normal) + q.squaredNorm() * normal.cross(p)) / (2 * square);
    const double radius = b_ + bars_;
    const double up = (radius * radius - aside.squaredNorm()) / square;
    return centre[0] + aside + side_ * std::sqrt(std::max(0.0, up)) * normal;
}

bool Delta::step(const Cranks& ends, const Eigen::Vector3d& position, Eigen::Vector3d& change,
                 Eigen::Matrix3d& jacobian) const noexcept {
    // g = (u - a cos)^2 + (w - a sin)^2 - L^2, halved throughout.
    std::array<Eigen::Vector3d, 3> slope;  // dg/d(position)
    Eigen::Vector3d g, turn;               // g, dg/d(theta)
    for (std::size_t i = 0; i < 3; ++i) {
        const auto [cosine, sine] = legs_[i];
        const double u = position.x() * cosine + position.y() * sine + outwards_;
        const double v = position.y() * cosine - position.x() * sine + across_;
        const double square = b_ * b_ - v * v;
        if (!(square > 0)) {
            return false;
        }
        const double h = std::sqrt(square);
        const double length = bars_ + h;
        const double du = u - ends[i].x(), dw = position.z() - ends[i].y(), dv = length * v / h;
        slope[i] = {du * cosine - dv * sine, du * sine + dv * cosine, dw};
        const auto row = static_cast<Eigen::Index>(i);
        g[row] = 0.5 * (du * du + dw * dw - length * length);
        turn[row] = u * ends[i].y() - position.z() * ends[i].x();
    }
    // The inverse by its columns: (slope2 x slope3) / det and so on.
    const Eigen::Vector3d first = slope[1].cross(slope[2]), second = slope[2].cross(slope[0]),
                          third = slope[0].cross(slope[1]);
    const double volume = slope[0].dot(first);
    const double largest = slope[0].squaredNorm() * slope[1].squaredNorm() * slope[2].squaredNorm();
    if (!(volume * volume > singular * singular * largest)) {
        return false;
    }
    const double inverse = -1 / volume;
    change = inverse * (g[0] * first + g[1] * second + g[2] * third);
    jacobian.col(0) = inverse * turn[0] * first;
    jacobian.col(1) = inverse * turn[1] * second;
    jacobian.col(2) = inverse * turn[2] * third;
    return true;
}

bool Delta::forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept {
    if (joints.size() < 3 || !std::isfinite(joints[0] + joints[1] + joints[2])) {
        return false;
    }
    const Cranks ends = cranks(joints.first<3>());
    Eigen::Vector3d position = three_spheres(ends), change;
    Eigen::Matrix3d here;
    for (int i = 0; i < most_steps; ++i) {
        if (!step(ends, position, change, here)) {
            return false;
        }
        position += change;
        if (change.squaredNorm() < enough_ * enough_) {
            pose.position = base_rotation_ * position + base_position_;
            pose.orientation.setIdentity();
            jacobian.setZero();
            jacobian.topLeftCorner<3, 3>().noalias() = base_rotation_ * here;
            return true;
        }
    }
    return false;
}

bool Delta::inverse(const Eigen::Vector3d& position, std::span<double, 3> joints) const noexcept {
    const Eigen::Vector3d own = base_rotation_.transpose() * (position - base_position_);
    std::array<double, 3> found;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto [cosine, sine] = legs_[i];
        const double u = own.x() * cosine + own.y() * sine + outwards_;
        const double v = own.y() * cosine - own.x() * sine + across_;
        const double w = own.z();
        const double square = b_ * b_ - v * v;
        if (!(square > 0)) {
            return false;
        }
        const double length = bars_ + std::sqrt(square);
        const double away = std::hypot(u, w);
        const double bend = (u * u + w * w + a_ * a_ - length * length) / (2 * a_ * away);
        if (!(std::abs(bend) <= 1)) {
            return false;
        }
        found[i] = std::atan2(w, u) - std::acos(bend);
    }
    std::copy(found.begin(), found.end(), joints.begin());
    return true;
}

}  // namespace knurl::drivers
