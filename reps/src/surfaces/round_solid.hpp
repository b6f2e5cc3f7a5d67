#pragma once
// All points within `reach` of a straight core: a point (sphere) or a segment (capsule).

#include "surfaces/bend.hpp"
#include "surfaces/solid.hpp"

namespace knurl {

struct RoundSolid {
    Eigen::Vector3d axis;  // unit
    double half_length;    // m, of the core; 0: the core is a point
    double reach;          // m, with the probe's radius
    double margin;         // m: half way to the core, beyond which the nearest surface turns quickly

    RoundSolid(const Eigen::Vector3d& along, double length, double radius) noexcept
        : axis(along), half_length(length), reach(radius), margin(radius / 2) {}
    double ball() const noexcept { return half_length + reach; }
    Eigen::Vector3d from_core(const Eigen::Vector3d& q) const noexcept {
        if (half_length == 0) return q;
        return q - std::clamp(axis.dot(q), -half_length, half_length) * axis;
    }
    Facing natural(const Eigen::Vector3d& q, const SolidHold& hold) const noexcept {
        const Eigen::Vector3d away = from_core(q);
        const double length = away.norm();
        return {direction_or(away, length, hold.normal, axis), length - reach};
    }
    /// The nearest surface at q and how it bends.
    CurvedContact curved(const Eigen::Vector3d& q) const noexcept {
        const Eigen::Vector3d away = from_core(q);
        const double length = away.norm();
        CurvedContact out{.normal = direction_or(away, length, Vec3{}, axis), .height = length - reach};
        out.bend = bend_about_point(out.normal, length);
        if (std::abs(axis.dot(q)) < half_length && length > 1e-100) out.bend -= bend_along(axis, 1 / length);
        return out;
    }
    std::optional<Facing> entered(const Eigen::Vector3d& last, const Eigen::Vector3d& q,
                                  const SolidHold& hold) const noexcept {
        const auto at = where_entered(
            last, q, reach, [&](const Eigen::Vector3d& p) { return from_core(p).norm() - (reach - margin); });
        if (!at) return std::nullopt;
        return natural(*at, hold);
    }
    Aim aim(const Eigen::Vector3d& q, const Eigen::Vector3d& n, std::uint32_t,
            const Facing& natural) const noexcept {
        const Aim lets_go{Aim::Kind::natural, natural.normal}, keeps{Aim::Kind::keep, n};
        if (natural.height < -margin) return keeps;
        if (n.dot(from_core(q)) > 0) return lets_go;  // in front: the probe is back where it came in
        // Behind the core. Does the line along n through q meet it?
        const Eigen::Vector3d aside = q - n.dot(q) * n, core = axis - n.dot(axis) * n;
        const double square = core.squaredNorm();
        const double along = square > 0 ? std::clamp(core.dot(aside) / square, -half_length, half_length) : 0;
        return (aside - along * core).squaredNorm() <= reach * reach ? keeps : lets_go;
    }
    double over(const Eigen::Vector3d& q, const Eigen::Vector3d& n, std::uint32_t) const noexcept {
        return n.dot(q) - half_length * std::abs(n.dot(axis)) - reach;
    }
};

}  // namespace knurl
