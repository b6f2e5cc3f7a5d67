// Edges where more than two faces meet.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <Eigen/Geometry>

#include "edges.hpp"

namespace knurl::build {
namespace {

// rad: a smaller difference of angles counts as none. Bodies that touch may overlap slightly there.
constexpr double alike_in_space = 1e-6, alike_in_solid = 1e-3;

struct Spoke {
    double angle;
    bool backward;  // its front faces smaller angles
    Link half;
};

using Eigen::Vector3d;

Vector3d vector(const Point3& p) {
    return {p[0], p[1], p[2]};
}

}  // namespace

void pair_radially(const Faces& faces, std::span<const Link> halves, Through through,
                   std::vector<std::pair<Link, Link>>& pairs, Slices& slices) {
    const double alike = through == Through::space ? alike_in_space : alike_in_solid;
    const auto corner = [&](Link h, std::uint32_t c) {
        return faces.corners[face_of(h)][(edge_of(h) + c) % 3];
    };
    const std::uint32_t first = corner(halves[0], 0);
    const Vector3d foot = vector(faces.at[first]);
    const Vector3d along = (vector(faces.at[corner(halves[0], 1)]) - foot).normalized();
    Vector3d u = Vector3d::Zero(), v = u;
    std::vector<Spoke> spokes;
    spokes.reserve(halves.size());
    for (const Link h : halves) {
        slices(4);
        const Vector3d out = vector(faces.at[corner(h, 2)]) - foot;
        if (spokes.empty()) {
            u = (out - out.dot(along) * along).normalized();
            v = along.cross(u);
        }
        double angle = std::atan2(out.dot(v), out.dot(u));
        if (angle < -alike) angle += 2 * std::numbers::pi;
        spokes.push_back({angle, (corner(h, 0) != first) == (through == Through::space), h});
    }
    // At equal angles, backward faces come first. Else the two sides of a sheet without thickness would be
    // neighbours, and the sheet a crack.
    const auto before = [&slices](const Spoke& a, const Spoke& b) {
        slices();
        return std::tuple(a.angle, !a.backward, a.half) < std::tuple(b.angle, !b.backward, b.half);
    };
    std::sort(spokes.begin(), spokes.end(), before);
    double last = spokes[0].angle;
    for (std::size_t i = 1; i < spokes.size(); ++i, slices()) {
        const double angle = spokes[i].angle;
        if (angle - last < alike) spokes[i].angle = spokes[i - 1].angle;
        last = angle;
    }
    std::sort(spokes.begin(), spokes.end(), before);
    // Matches them like parentheses, twice around: a forward face sees the next backward one that no other
    // face between them sees.
    std::vector<Link> waiting;
    waiting.reserve(spokes.size());
    std::vector<bool> done(spokes.size());
    for (int round = 0; round < 2; ++round) {
        for (std::size_t i = 0; i < spokes.size(); ++i, slices()) {
            const Link h = spokes[i].half;
            if (done[i]) continue;
            if (!spokes[i].backward) {
                if (round == 0) waiting.push_back(h);
                continue;
            }
            if (waiting.empty()) continue;
            const Link other = waiting.back();
            waiting.pop_back();
            done[i] = true;
            pairs.emplace_back(h, other);
        }
    }
}

}  // namespace knurl::build
