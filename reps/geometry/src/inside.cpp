// What lies inside of a body that it touches or crosses: no hand comes there.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include <Eigen/Geometry>

#include "unite.hpp"

namespace knurl::build {
namespace {

using Eigen::Vector3d;

struct Side {
    std::uint32_t near, far, face;
    bool forward;
};

/// Faces that hang together over edges of two faces: a patch is inside of a body with all of it or not at all.
class Patches {
  public:
    explicit Patches(std::size_t faces) : parent_(faces) { std::iota(parent_.begin(), parent_.end(), 0U); }
    std::uint32_t of(std::uint32_t f) {
        while (parent_[f] != f) f = parent_[f] = parent_[parent_[f]];
        return f;
    }
    void join(std::uint32_t f, std::uint32_t g) { parent_[std::max(of(f), of(g))] = std::min(of(f), of(g)); }

  private:
    std::vector<std::uint32_t> parent_;
};

Patches find_patches(const Faces& faces, Slices& slices) {
    std::vector<Side> sides;
    sides.reserve(3 * faces.corners.size());
    for (std::uint32_t f = 0; f < faces.corners.size(); ++f, slices(2)) {
        const Triangle& t = faces.corners[f];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i], b = t[(i + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), f, a < b});
        }
    }
    std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
        slices();
        return std::tuple(a.near, a.far, a.face) < std::tuple(b.near, b.far, b.face);
    });
    Patches patches(faces.corners.size());
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
        for (end = i;
             end < sides.size() && sides[end].near == sides[i].near && sides[end].far == sides[i].far;)
            ++end;
        if (end == i + 2 && sides[i].forward != sides[i + 1].forward)
            patches.join(sides[i].face, sides[i + 1].face);
        slices();
    }
    return patches;
}

/// How often closed parts wind around x; those from `end` on are left out.
double winding(const Faces& faces, const std::vector<std::uint32_t>& part, const std::vector<bool>& closed,
               std::uint32_t end, const Vector3d& x, Slices& slices) {
    double sum = 0;
    for (std::size_t f = 0; f < faces.corners.size(); ++f, slices()) {
        if (part[f] >= end || !closed[part[f]]) continue;
        const Triangle& t = faces.corners[f];
        const Vector3d a = Vector3d(faces.at[t[0]].data()) - x, b = Vector3d(faces.at[t[1]].data()) - x,
                       c = Vector3d(faces.at[t[2]].data()) - x;
        const double i = a.norm(), j = b.norm(), k = c.norm();
        sum += std::atan2(a.dot(b.cross(c)), i * j * k + a.dot(b) * k + b.dot(c) * i + c.dot(a) * j);
    }
    return sum / (2 * std::numbers::pi);
}

}  // namespace

std::uint64_t drop_inside(Faces& faces, const std::vector<std::uint32_t>& part,
                          const std::vector<bool>& changed, const std::vector<bool>& closed, const Near& near,
                          Slices& slices) {
    slices.ask();
    const std::size_t n = faces.corners.size();
    std::uint64_t count = 0;
    Patches patches = find_patches(faces, slices);
    // The widest changed face of each patch tells where the patch is.
    std::vector<std::pair<double, std::uint32_t>> widest(n, {0, 0});
    for (std::uint32_t f = 0; f < n; ++f, slices(2)) {
        if (!changed[f]) continue;
        const Triangle& t = faces.corners[f];
        const Vector3d a(faces.at[t[0]].data()), b(faces.at[t[1]].data()), c(faces.at[t[2]].data());
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        auto& most = widest[patches.of(f)];
        most = std::max(most, {(b - a).cross(c - a).norm() / longest, f});
    }
    constexpr std::uint64_t long_enough = 4'000'000'000;  // faces that are asked, in all
    std::uint64_t asked = 0;
    std::vector<bool> inside(n);
    for (std::uint32_t p = 0; p < n; ++p, slices()) {
        const auto [width, f] = widest[p];
        if (!(width > 0) || (asked += n) > long_enough) continue;
        const Triangle& t = faces.corners[f];
        const Vector3d a(faces.at[t[0]].data()), b(faces.at[t[1]].data()), c(faces.at[t[2]].data());
        const Vector3d normal = (b - a).cross(c - a).normalized();
        // Farther than what makes one wall of two.
        const Vector3d middle = (a + b + c) / 3, off = normal * (2 * near.touch);
        constexpr std::uint32_t all = 0xffffffff;
        inside[p] = winding(faces, part, closed, all, middle + off, slices) > 0.5 ||
                    // Two bodies' faces in one plane: the one with the lower number keeps its own.
                    (closed[part[f]] && winding(faces, part, closed, part[f], middle - off, slices) > 0.5 &&
                     winding(faces, part, closed, part[f], middle + off, slices) < 0.5);
    }
    std::size_t kept = 0;
    for (std::uint32_t f = 0; f < n; ++f, slices()) {
        if (inside[patches.of(f)]) {
            ++count;
            continue;
        }
        faces.corners[kept] = faces.corners[f];
        faces.given[kept++] = faces.given[f];
    }
    faces.corners.resize(kept);
    faces.given.resize(kept);
    return count;
}

}  // namespace knurl::build
