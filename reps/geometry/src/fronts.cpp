// Queries of a surface about paths and places near it, apart from the walk. They serve where it touches
// another surface.

#include <knurl/geometry/proxy.hpp>

#include "on_surface.hpp"
#include "sweep.hpp"

namespace knurl {

using detail::Corners;
using detail::Nearest;
using detail::nearest_on;
using detail::on_surface;
using detail::to_eigen;
using detail::to_vec;
using detail::unit_or_zero;
using detail::Vec;
using Eigen::Vector3d;

namespace {

template <class S>
void put(const S& s, const Vec& origin, std::uint32_t face, const Vec& point, Foot& foot) noexcept {
    foot.point = to_eigen(origin + point);
    foot.normal = to_eigen(unit_or_zero(s.corners(face).normal()));
    foot.depth = 0;
    foot.face = face;
    foot.triangle = s.triangle(face);
    foot.material = s.material(face);
}

/// The face that the path passes from its front, within `reach`.
template <class S>
void pass_beside(const S& s, const Vec& p, const Vec& q, const Vec& side, double reach, detail::Hit& hit,
                 Work& work) noexcept {
    constexpr double facing = 0.1;  // cosine: below it the face is a wall beside the path
    const Vec d = q - p;
    const double least = facing * side.norm();
    s.overlapping(detail::low_of(p, q, reach), detail::high_of(p, q, reach), work, [&](std::uint32_t face) {
        const Corners corners = s.corners(face);
        const Vec normal = unit_or_zero(corners.normal());
        const double against = normal.dot(d), above = normal.dot(p - corners.at[0]);
        if (!(against < 0) || !(above >= 0) || !(normal.dot(side) >= least)) return;
        const double t = above / -against;
        if (!(t <= 1 && t < hit.t)) return;
        const Vec point = p + d * t;
        if (!(nearest_on(corners, point).square <= reach * reach)) return;
        hit.t = t;
        hit.face = face;
        hit.point = point;
    });
}

/// Of the faces that meet where the path meets the surface: the one that it meets at the steepest angle. At
/// an edge another one might be a wall along the path.
template <class S>
void meet_squarely(const S& s, const Vec& d, detail::Hit& hit, Work& work) noexcept {
    const double near = 1e-9 * s.size();
    double most = 0;
    s.overlapping(detail::low_of(hit.point, hit.point, near), detail::high_of(hit.point, hit.point, near),
                  work, [&](std::uint32_t face) {
                      const Corners corners = s.corners(face);
                      const double against = -unit_or_zero(corners.normal()).dot(d);
                      if (!(against > most) || !(nearest_on(corners, hit.point).square <= near * near))
                          return;
                      most = against;
                      hit.face = face;
                  });
}

}  // namespace

[[gnu::cold]] double first_front(const Asset& asset, const Vector3d& from, const Vector3d& to, double reach,
                                 const Vector3d& side, Foot& foot, Work& work) noexcept {
    return on_surface(asset, [&](const auto& surface, const Vec& origin) {
        const Vec p = to_vec(from) - origin, q = to_vec(to) - origin;
        if (!(p.sum_of_sizes() < 1e12 && q.sum_of_sizes() < 1e12)) return 2.0;
        const double hair = detail::hair_of_size * surface.size();
        const Vec d = q - p;
        // A face along the path must not be met by rounding.
        const auto against = [&](std::uint32_t, const Corners& corners, double) {
            return -unit_or_zero(corners.normal()).dot(d) > 1e-9 * d.norm();
        };
        detail::Hit hit = detail::sweep(surface, p, q, hair / 2, work, against);
        if (hit.face == detail::no_face && reach > 0) {
            hit.t = HUGE_VAL;
            pass_beside(surface, p, q, to_vec(side), reach, hit, work);
        }
        if (hit.face == detail::no_face) return 2.0;
        meet_squarely(surface, d, hit, work);
        put(surface, origin, hit.face, nearest_on(surface.corners(hit.face), hit.point).point, foot);
        return std::clamp(hit.t, 0.0, 1.0);
    });
}

[[gnu::cold]] bool facing_near(const Asset& asset, const Vector3d& place, double within,
                               const Vector3d& normal, double least, Foot& foot, Work& work) noexcept {
    return on_surface(asset, [&](const auto& surface, const Vec& origin) {
        const Vec p = to_vec(place) - origin, n = to_vec(normal);
        double best = least, square = HUGE_VAL;
        std::uint32_t found = detail::no_face;
        Vec point{0, 0, 0};
        surface.overlapping(
            detail::low_of(p, p, within), detail::high_of(p, p, within), work, [&](std::uint32_t face) {
                const Corners corners = surface.corners(face);
                const Nearest near = nearest_on(corners, p);
                if (!(near.square <= within * within)) return;
                constexpr double alike = 1e-9;  // difference of two cosines that counts as none
                const double facing = unit_or_zero(near.normal).dot(n);
                if (facing < best - alike || (facing <= best + alike && !(near.square < square))) return;
                best = facing;
                square = near.square;
                found = face;
                point = near.point;
            });
        if (found == detail::no_face) return false;
        put(surface, origin, found, point, foot);
        return true;
    });
}

}  // namespace knurl
