#include <knurl/geometry/proxy.hpp>

#include "cycle.hpp"
#include "on_surface.hpp"

namespace knurl {
namespace {

using detail::on_surface;
using detail::to_eigen;
using detail::to_vec;
using detail::Vec;
using Eigen::Vector3d;

void add(Work& to, const Work& work) noexcept {
    to.faces += work.faces;
    to.nodes += work.nodes;
    to.pieces += work.pieces;
    to.sweeps += work.sweeps;
    to.guards += work.guards;
    to.fans += work.fans;
    to.tangles += work.tangles;
}

}  // namespace

bool follow(const Asset& asset, Proxy& proxy, const Vector3d& hand, double radius, Foot& foot,
            Work& work) noexcept {
    Work cycle;
    const bool touches = on_surface(asset, [&](const auto& surface, const Vec& origin) {
        return detail::Cycle(surface, origin, proxy, to_vec(hand), radius, foot, cycle).run();
    });
    add(work, cycle);
    return touches;
}

void adopt(const Asset& asset, Proxy& proxy, const Vector3d& hand, Work& work) noexcept {
    const bool touched = proxy.phase == Proxy::Phase::touching || proxy.phase == Proxy::Phase::tangled;
    const Proxy before = proxy;
    proxy = Proxy{};
    if (!touched) return;
    Work cycle;
    on_surface(asset, [&](const auto& surface, const Vec& origin) {
        const Vec p = Vec{before.at[0], before.at[1], before.at[2]} - origin;
        double square = HUGE_VAL;
        surface.nearer(p, square, cycle, [&](std::uint32_t face) {
            const detail::Nearest near = detail::nearest_on(surface.corners(face), p);
            if (!(near.square < square)) return;
            square = near.square;
            proxy.phase = Proxy::Phase::touching;
            proxy.face = face;
            for (int axis = 0; axis < 3; ++axis) {
                proxy.at[axis] = origin[axis] + near.point[axis];
                proxy.last[axis] = hand[axis];
            }
        });
        return 0;
    });
    add(work, cycle);
}

Vector3d shaded_normal(const Asset& asset, const Foot& foot) noexcept {
    return on_surface(asset, [&](const auto& surface, const Vec& origin) -> Vector3d {
        if (!surface.has(foot.face)) return foot.normal;
        const detail::Corners face = surface.corners(foot.face);
        const Vec x = to_vec(foot.point) - origin, normal = face.normal();
        Vec sum{0, 0, 0};
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t j = detail::after(i);
            // the weight of corner i, times twice the area squared
            const double share = normal.dot(face.side(j).cross(x - face.at[j]));
            detail::Nearest corner;
            corner.normal = normal;
            corner.place = i;
            sum +=
                detail::unit_or_zero(detail::pseudonormal(surface, foot.face, corner)) * std::max(share, 0.0);
        }
        const double length = sum.norm();
        return length > 0 ? to_eigen(sum * (1 / length)) : foot.normal;
    });
}

}  // namespace knurl
