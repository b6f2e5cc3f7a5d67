#pragma once
// Converts Knurl's parameters to those of the reference.

#include <vector>

#include <Eigen/Geometry>

#include <knurl/reps/box.hpp>
#include <knurl/reps/friction.hpp>
#include <knurl/reps/half_plane.hpp>
#include <knurl/reps/polygon.hpp>
#include <knurl/reps/probe.hpp>

#include "exact/effects.hpp"
#include "exact/friction.hpp"
#include "exact/pieces.hpp"
#include "exact/solids.hpp"

namespace exact {

inline V real(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}
inline V real(const knurl::Vec3& v) {
    return {v.x, v.y, v.z};
}
inline Turn real(const Eigen::Quaterniond& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}
inline Turn real(const knurl::Quat& q) {
    return {q.w, q.x, q.y, q.z};
}
inline Eigen::Vector3d rounded(const V& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

inline Tip tip_of(const knurl::Probe& p) {
    return {real(p.position), real(p.orientation), real(p.velocity), real(p.angular_velocity)};
}

/// The friction on a surface of that stiffness (N/m). A snag with a stiffness replaces Coulomb friction.
inline Law law_of(const knurl::Friction& friction, const knurl::Snag& snag, Real stiffness,
                  const knurl::Limits& limits) {
    Law law;
    law.viscous = friction.viscous;
    law.max_stiffness = limits.max_stiffness;
    law.resolution = limits.resolution;
    if (!(snag.k_stick > 0)) {
        law.stiffness = std::min(stiffness, law.max_stiffness);
        law.dynamic = friction.dynamic;
        law.static_ = friction.static_ < 0 ? friction.dynamic : friction.static_;
        return law;
    }
    law.d_snap = snag.d_snap, law.d_mean = snag.d_mean, law.d_spread = snag.d_spread;
    law.seed = snag.seed;
    law.static_ = Real(snag.k_stick) * snag.d_snap;
    if (snag.law == knurl::SnagLaw::paper) {
        law.kind = Law::Kind::paper;
        law.stiffness = snag.k_stick;
        law.dynamic = snag.k_kinetic;
    } else {
        law.kind = Law::Kind::snag;
        law.stiffness = std::min(Real(snag.k_stick), law.max_stiffness);
        law.dynamic = std::min(Real(snag.k_kinetic), law.static_);
    }
    return law;
}

inline Piece piece_of(const knurl::Polygon& polygon) {
    std::vector<V> corners;
    for (std::uint32_t i = 0; i < polygon.vertices.count; ++i)
        corners.push_back(real(polygon.vertices.at[i]));
    return exact::polygon(corners, polygon.sides == knurl::Sides::both);
}
inline Piece piece_of(const knurl::HalfPlane& half) {
    return half_plane(real(half.normal), half.offset, real(half.edge), half.edge_offset,
                      half.sides == knurl::Sides::both);
}

inline Box box_of(const knurl::Box& box) {
    return {real(box.center), real(box.half_size), real(box.orientation)};
}

/// A sphere, capsule, cylinder or torus.
template <class R>
Solid solid_of(const R& s) {
    Solid solid{.center = real(s.center), .radius = s.radius, .hollow = s.side == knurl::Side::inside};
    if constexpr (requires { s.axis; }) solid.axis = real(s.axis);
    if constexpr (requires { s.half_length; }) {
        solid.kind = requires {
            R::max_contacts;
        }
        ? Solid::Kind::cylinder : Solid::Kind::capsule;
        solid.half_length = s.half_length;
    }
    if constexpr (requires { s.tube; }) {
        solid.kind = Solid::Kind::torus;
        solid.tube = s.tube;
    }
    return solid;
}

}  // namespace exact
