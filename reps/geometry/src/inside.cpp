// Finds the faces inside a body that touches or crosses them: no hand can reach them.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include <Eigen/Geometry>

#include "unite.hpp"

namespace knurl::build {
namespace {

using Eigen::Vector3d;

struct Side {
    std::uint32_t near, far, face;
    bool forward;
};

/// Faces that are connected over edges of two faces: a patch is inside a body as a whole or not at all.
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

/// The sides, sorted by edge.
std::vector<Side> sorted_sides(const Faces& faces, Slices& slices) {
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
    return sides;
}

/// Calls `with(sides)` for each edge; false when it returns false.
template <class With>
bool for_each_edge(std::span<const Side> sides, Slices& slices, With with) {
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end, slices()) {
        for (end = i;
             end < sides.size() && sides[end].near == sides[i].near && sides[end].far == sides[i].far;)
            ++end;
        if (!with(sides.subspan(i, end - i))) return false;
    }
    return true;
}

Patches find_patches(std::span<const Side> sides, std::size_t faces, Slices& slices) {
    Patches patches(faces);
    for_each_edge(sides, slices, [&](std::span<const Side> edge) {
        if (edge.size() == 2 && edge[0].forward != edge[1].forward) patches.join(edge[0].face, edge[1].face);
        return true;
    });
    return patches;
}

/// How often closed parts wind around x; parts from `end` on are left out.
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

namespace {

/// Are bodies still closed without the faces that go? As many of their faces must run forwards along each
/// edge as backwards.
template <class Goes>
bool stays_closed(std::span<const Side> sides, const std::vector<std::uint32_t>& part,
                  const std::vector<bool>& closed, Slices& slices, Goes goes) {
    return for_each_edge(sides, slices, [&](std::span<const Side> edge) {
        int sum = 0;
        for (const Side& side : edge) {
            if (closed[part[side.face]] && !goes(side.face)) sum += side.forward ? 1 : -1;
        }
        return sum == 0;
    });
}

/// The widest changed faces of each patch, one in each of six directions. They show where the patch is. They
/// agree, unless a missing cut leaves the patch connected.
struct Witness {
    double width = 0;  // m
    std::uint32_t face = 0;
};
using Witnesses = std::array<Witness, 6>;

struct Geometry {
    Vector3d middle, normal;
    double width;  // m
};
Geometry geometry_of(const Faces& faces, std::uint32_t f) {
    const Triangle& t = faces.corners[f];
    const Vector3d a(faces.at[t[0]].data()), b(faces.at[t[1]].data()), c(faces.at[t[2]].data());
    const Vector3d normal = (b - a).cross(c - a);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return {(a + b + c) / 3, normal.normalized(), normal.norm() / longest};
}

std::size_t direction_of(const Vector3d& normal) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return static_cast<std::size_t>(2 * axis + (normal[axis] < 0));
}

std::unordered_map<std::uint32_t, Witnesses> find_witnesses(const Faces& faces, Patches& patches,
                                                            const std::vector<bool>& changed,
                                                            Slices& slices) {
    std::unordered_map<std::uint32_t, Witnesses> found;
    for (std::uint32_t f = 0; f < faces.corners.size(); ++f, slices(2)) {
        if (!changed[f]) continue;
        const Geometry g = geometry_of(faces, f);
        if (!(g.width > 0)) continue;
        Witness& most = found[patches.of(f)][direction_of(g.normal)];
        if (g.width > most.width) most = {g.width, f};
    }
    return found;
}

}  // namespace

std::optional<std::uint64_t> drop_inside(Faces& faces, const std::vector<std::uint32_t>& part,
                                         const std::vector<bool>& changed, const std::vector<bool>& closed,
                                         const Near& near, Slices& slices) {
    slices.ask();
    const std::size_t n = faces.corners.size();
    const std::vector<Side> sides = sorted_sides(faces, slices);
    Patches patches = find_patches(sides, n, slices);
    constexpr std::uint64_t long_enough = 4'000'000'000;  // faces tested in total
    std::uint64_t asked = 0;
    const auto lies_inside = [&](std::uint32_t f) {
        asked += n;
        const Geometry g = geometry_of(faces, f);
        // Farther than the distance within which two walls become one.
        const Vector3d off = g.normal * (2 * near.touch);
        constexpr std::uint32_t all = 0xffffffff;
        return winding(faces, part, closed, all, g.middle + off, slices) > 0.5 ||
               // Where two bodies have faces in one plane, the body with the lower number keeps its own.
               (closed[part[f]] && winding(faces, part, closed, part[f], g.middle - off, slices) > 0.5 &&
                winding(faces, part, closed, part[f], g.middle + off, slices) < 0.5);
    };
    std::vector<bool> inside(n);
    for (const auto& [patch, witnesses] : find_witnesses(faces, patches, changed, slices)) {
        const double most = std::max_element(witnesses.begin(), witnesses.end(), [](auto& a, auto& b) {
                                return a.width < b.width;
                            })->width;
        // A narrower face may have any orientation: it counts only where there is no other.
        const double least = std::min(most, 16 * near.touch);
        int within = 0, without = 0;
        for (const auto& [width, f] : witnesses) {
            if (!(width > 0) || width < least || asked > long_enough) continue;
            (lies_inside(f) ? within : without) += 1;
        }
        if (within > 0 && without > 0) return std::nullopt;
        inside[patch] = within > 0;
    }
    const auto goes = [&](std::uint32_t f) { return inside[patches.of(f)]; };
    if (!stays_closed(sides, part, closed, slices, goes)) return std::nullopt;
    std::size_t kept = 0;
    for (std::uint32_t f = 0; f < n; ++f, slices()) {
        if (goes(f)) continue;
        faces.corners[kept] = faces.corners[f];
        faces.given[kept++] = faces.given[f];
    }
    faces.corners.resize(kept);
    faces.given.resize(kept);
    if (kept == 0) return std::nullopt;
    return n - kept;
}

}  // namespace knurl::build
