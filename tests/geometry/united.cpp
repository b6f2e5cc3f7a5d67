// Parts that touch or cross in one mesh hold the hand like one body: random approaches to floors and walls,
// and to boxes with a gap, a step or an overlap between them. The expected solid is known in closed form,
// and shares no code with the builder.
//
// KNURL_APPROACHES: how many of each kind (scripts/approaches: a million in all).

#include <cstdlib>
#include <iomanip>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <mesh_data.hpp>

#include "verdict.hpp"
#include "walk_tools.hpp"

namespace knurl::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A box of the union, axis-aligned before all of them are turned together.
struct Block {
    Vector3d low, high;
    /// How deep p lies in it (m); < 0: outside.
    double depth(const Vector3d& p) const { return std::min((p - low).minCoeff(), (high - p).minCoeff()); }
};

void append(MadeMesh& to, const Block& block, int divisions) {
    std::vector<double> lines[3];
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i <= divisions; ++i)
            lines[k].push_back(block.low[k] + (block.high[k] - block.low[k]) * i / divisions);
    }
    to.append(blocks(lines[0], lines[1], lines[2], [](int, int, int) { return true; }));
}

Vector3d any_direction(Rng& rng) {
    Vector3d v;
    do {
        v = {between(rng, -1, 1), between(rng, -1, 1), between(rng, -1, 1)};
    } while (!(v.norm() > 0.1 && v.norm() < 1));
    return v.normalized();
}

struct Counts {
    std::uint64_t approaches = 0, cycles = 0, touching = 0, lost = 0, inside = 0;
    double deepest = 0;  // m, of what is inside
};
std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << c.approaches << " approaches, " << c.cycles << " cycles, " << c.touching << " touching, "
               << c.lost << " lost, " << c.inside << " inside, deepest " << c.deepest << " m";
}
std::uint64_t approaches(std::uint64_t usual) {
    const char* asked = std::getenv("KNURL_APPROACHES");
    return asked ? std::strtoull(asked, nullptr, 10) : usual;
}

/// One hand: down onto `entry` against `normal` to the depth `deep`, then along `way`. depth_in(p): the
/// depth of p in the solid (m).
template <class DepthIn>
void approach(const Mesh& mesh, const Matrix3d& turn, const Vector3d& shift, const Vector3d& entry,
              const Vector3d& normal, double deep, const Vector3d& way, double step, double slack,
              DepthIn&& depth_in, Counts& counts) {
    Proxy proxy;
    bool lost = false, within = false;
    const auto cycle = [&](const Vector3d& p) {
        const Vector3d hand = turn * p + shift;
        Foot foot;
        Work work;
        const bool touches = follow(mesh, proxy, hand, 0, foot, work);
        ++counts.cycles;
        counts.touching += touches;
        const double depth = depth_in(p);
        if (depth > slack && !touches) lost = true;
        if (touches) {
            const double in = depth_in(turn.transpose() * (foot.point - shift));
            if (in > slack) within = true, counts.deepest = std::max(counts.deepest, in);
        }
    };
    const double lift = std::max(2 * step, 1e-4);
    const int down = static_cast<int>(std::ceil(std::min((lift + deep) / step, 100.0)));
    for (int i = 0; i <= down; ++i) cycle(entry + normal * (lift - (lift + deep) * i / down));
    const Vector3d pressed = entry - normal * deep;
    const int along = static_cast<int>(std::ceil(way.norm() / step));
    for (int i = 1; i <= along; ++i) cycle(pressed + way * (double(i) / along));
    ++counts.approaches;
    counts.lost += lost;
    counts.inside += within;
}

void expect_held(const Counts& counts, const std::string& of) {
    std::cout << of << ": " << counts << ", KNURL_SEED=" << seed() << '\n';
    EXPECT_EQ(counts.lost, 0U) << of;
    EXPECT_EQ(counts.inside, 0U) << of;
    EXPECT_GT(counts.touching, counts.cycles / 4) << of << " says nothing";
}

constexpr int hands_per_mesh = 50;

enum class Seam { gap, step, overlap, deep };

/// Two boxes side by side along x. In a gap between them only one thing is demanded: a hand that is deeper
/// in it than the gap is wide is held.
Counts boxes(Seam seam, std::uint64_t count, Rng& rng) {
    Counts counts;
    while (counts.approaches < count) {
        Block a{{-between(rng, 0.03, 0.08), -between(rng, 0.02, 0.05), -between(rng, 0.02, 0.05)},
                {0, between(rng, 0.02, 0.05), between(rng, 0.01, 0.03)}};
        Block b{a.low, a.high};
        b.low.x() = 0, b.high.x() = between(rng, 0.03, 0.08);
        const int kind = static_cast<int>(below(rng, 3));  // of the same size; flush on top; of any size
        if (kind > 0) b.low.y() = -between(rng, 0.01, 0.06), b.high.y() = between(rng, 0.01, 0.06);
        if (kind > 1) b.low.z() = -between(rng, 0.01, 0.06), b.high.z() = between(rng, 0.005, 0.04);
        const double size = (a.high.cwiseMax(b.high) - a.low.cwiseMin(b.low)).norm();
        const double part = below(rng, 4) == 0 ? 0 : std::pow(10, between(rng, -9, -4.01));
        double gap = 0;
        if (seam == Seam::gap) gap = part * size;
        if (seam == Seam::overlap) gap = -part * size;
        if (seam == Seam::deep) gap = -between(rng, 0.0002, 0.02);
        b.low.x() += gap;
        if (seam == Seam::step) {
            b.high.z() += (below(rng, 2) == 0 ? -1 : 1) * part * size;
            b.low.x() += (below(rng, 2) == 0 ? 1.0 : -1.0) * std::pow(10, between(rng, -9, -4.01)) * size;
        }
        MadeMesh shape;
        append(shape, a, 1 + static_cast<int>(below(rng, 4)));
        append(shape, b, 1 + static_cast<int>(below(rng, 4)));
        const Matrix3d turn = below(rng, 3) == 0
                                  ? Matrix3d(Matrix3d::Identity())
                                  : AngleAxisd(between(rng, 0, 3), any_direction(rng)).matrix();
        const Vector3d shift = below(rng, 2) == 0 ? Vector3d(0, 0, 0) : 0.3 * any_direction(rng);
        for (auto& v : shape.vertices) {
            const Vector3d p = turn * Vector3d(v[0], v[1], v[2]) + shift;
            v = {p.x(), p.y(), p.z()};
        }
        const bool exact = below(rng, 2) == 0;
        const auto mesh = build(shape, exact);
        Block slit{a.low.cwiseMax(b.low), a.high.cwiseMin(b.high)};
        slit.low.x() = std::min(a.high.x(), b.low.x()) - 0.001;
        slit.high.x() = std::max(a.high.x(), b.low.x()) + 0.001;
        const double slack = 1.5e-4 * size;
        const auto depth = [&](const Vector3d& p) {
            return std::max({a.depth(p), b.depth(p), gap >= -1e-4 * size ? slit.depth(p) : -1.0});
        };
        for (int hand = 0; hand < hands_per_mesh && counts.approaches < count; ++hand) {
            // Onto the top, a side or the bottom of either box, near the seam.
            const double step = 1e-3 * std::pow(10, between(rng, -3, std::log10(0.3)));
            const double length = std::min(0.015, 120 * step);
            const Block& on = below(rng, 2) == 0 ? a : b;
            const int axis = 1 + static_cast<int>(below(rng, 2));
            const double side = below(rng, 2) == 0 ? 1 : -1;
            Vector3d entry, normal = Vector3d::Zero();
            normal[axis] = side;
            for (int k = 1; k < 3; ++k) entry[k] = between(rng, on.low[k], on.high[k]);
            entry[axis] = side > 0 ? on.high[axis] : on.low[axis];
            entry.x() = between(rng, -1, 1) * length;
            entry.x() = std::clamp(entry.x(), on.low.x() + 1e-5, on.high.x() - 1e-5);
            if (depth(entry + normal * std::max(2 * step, 1e-4)) > 0) continue;  // the other box covers it
            const double deep = std::min(std::pow(10, between(rng, -3.5, -2.2)), 0.008);
            Vector3d way{(entry.x() > 0 ? -2 : 2) * length, between(rng, -1, 1) * length, 0};
            way[axis] = 0;
            if (below(rng, 4) == 0) way = any_direction(rng) * length;
            const std::uint64_t failed = counts.lost + counts.inside;
            approach(*mesh, turn, shift, entry, normal, deep, way, step, slack, depth, counts);
            if (failed == 0 && counts.lost + counts.inside > 0) {
                std::cout << std::setprecision(17) << "first: boxes " << a.low.transpose() << " to "
                          << a.high.transpose() << " and " << b.low.transpose() << " to "
                          << b.high.transpose() << " turned by " << turn << " shifted by "
                          << shift.transpose() << (exact ? " exact" : "") << ", hand " << entry.transpose()
                          << " by " << way.transpose() << " deep " << deep << ", faces crossed "
                          << mesh->notes().faces_crossed << ", parts " << mesh->notes().parts << ", open "
                          << mesh->notes().edges_open << std::setprecision(6) << '\n';
            }
        }
    }
    return counts;
}

TEST(United, BoxesWithAGapBetweenThem) {
    Rng rng(seed());
    expect_held(boxes(Seam::gap, approaches(3000), rng), "gap");
}
TEST(United, BoxesWithAStepBetweenThem) {
    Rng rng(seed() + 1000);
    expect_held(boxes(Seam::step, approaches(3000), rng), "step");
}
TEST(United, BoxesThatOverlapALittle) {
    Rng rng(seed() + 2000);
    expect_held(boxes(Seam::overlap, approaches(3000), rng), "overlap");
}
TEST(United, BoxesThatOverlap) {
    Rng rng(seed() + 3000);
    expect_held(boxes(Seam::deep, approaches(3000), rng), "boxes that overlap");
}

double volume_of(const Mesh& mesh) {
    double six = 0;
    const auto add = [&](const auto& faces) {
        for (const auto& face : faces) {
            Vector3d p[3];
            for (int i = 0; i < 3; ++i) p[i] = {face.corner[i][0], face.corner[i][1], face.corner[i][2]};
            six += p[0].dot(p[1].cross(p[2]));
        }
    };
    add(mesh.data().faces);
    add(mesh.data().exact_faces);
    return six / 6;
}

// The step is about as high as the distance within which two points become one. So edges lie a little beside
// each other everywhere, and cuts would stay open; the builder then has to cut with a coarser tolerance.
TEST(United, BoxesThatAreFlushButForAPointsSizeStayWhole) {
    Rng rng(seed() + 6000);
    const int count = static_cast<int>(approaches(3000) / 30);
    for (int i = 0; i < count; ++i) {
        Block a{{-0.07, -0.045, -0.04}, {0, 0.04, 0.02}}, b{a.low, a.high};
        b.high.x() = 0.06;
        const double size = (b.high - a.low).norm();
        b.high.z() += between(rng, 1.3e-6, 2.1e-6) * size;
        b.low.x() = (below(rng, 2) == 0 ? 1 : -1) * std::pow(10, between(rng, -6.5, -5)) * size;
        MadeMesh shape;
        append(shape, a, 4), append(shape, b, 4);
        const Matrix3d turn = AngleAxisd(between(rng, 0, 3), any_direction(rng)).matrix();
        for (auto& v : shape.vertices) {
            const Vector3d p = turn * Vector3d(v[0], v[1], v[2]);
            v = {p.x(), p.y(), p.z()};
        }
        std::unique_ptr<Mesh> mesh;
        ASSERT_NO_THROW(mesh = build(shape, below(rng, 2) == 0)) << i << ", KNURL_SEED=" << seed();
        const double whole = (b.high.x() - a.low.x()) * (a.high.y() - a.low.y()) * (a.high.z() - a.low.z());
        EXPECT_EQ(mesh->notes().edges_open, 0U) << i << ", KNURL_SEED=" << seed();
        EXPECT_GT(mesh->notes().vertices_moved + mesh->notes().faces_inside, 0U)
            << i << ", KNURL_SEED=" << seed();
        EXPECT_EQ(mesh->notes().not_united, 0U) << i << ", KNURL_SEED=" << seed();
        EXPECT_NEAR(volume_of(*mesh), whole, 1e-3 * whole) << i << ", KNURL_SEED=" << seed();
    }
}

/// A floor z = 0 and a wall that leans over it by `angle`, through it or on it. Their fronts face up, and
/// into the wedge between them.
Counts leaning(bool through, std::uint64_t count, Rng& rng) {
    Counts counts;
    while (counts.approaches < count) {
        const double angle = between(rng, 5, 85) * M_PI / 180;
        const double half = 0.05;
        const int n = 1 + static_cast<int>(below(rng, 10)), m = 1 + static_cast<int>(below(rng, 10));
        MadeMesh shape = grid(n, n, 2 * half / n, 2 * half / n);
        // The front of a grid is z up. Turned about y it leans, and its front looks down into the wedge.
        MadeMesh wall = grid(m, m, 2 * half / m, 2 * half / m);
        const Vector3d up(std::cos(angle), 0, std::sin(angle)), y(0, 1, 0);
        const double low = through ? -between(rng, 0.001, 0.04) : 0;
        const bool acute = below(rng, 2) == 0;  // the free wedge is under the wall, or over it
        for (auto& v : wall.vertices) {
            const Vector3d p = up * (v[0] + half + low) + y * (acute ? -v[1] : v[1]) * 1.01;
            v = {p.x() + 1e-3, p.y(), p.z()};
        }
        shape.append(wall);
        const Vector3d front = acute ? Vector3d(std::sin(angle), 0, -std::cos(angle))
                                     : Vector3d(-std::sin(angle), 0, std::cos(angle));
        const Matrix3d turn = AngleAxisd(between(rng, 0, 3), any_direction(rng)).matrix();
        for (auto& v : shape.vertices) {
            const Vector3d p = turn * Vector3d(v[0], v[1], v[2]);
            v = {p.x(), p.y(), p.z()};
        }
        const auto mesh = build(shape, below(rng, 2) == 0);
        const double slack = 2e-6 * shape.size();
        const auto depth = [&](const Vector3d& p) {
            return std::max(-p.z(), -front.dot(p - Vector3d(1e-3, 0, 0)));
        };
        for (int hand = 0; hand < hands_per_mesh && counts.approaches < count; ++hand) {
            const double step = 1e-3 * std::pow(10, between(rng, 0, std::log10(300))) * 1e-3 * 1e0;
            const double length = std::min(0.01, 120 * step);
            const double s = between(rng, 0.05, 1) * length;  // from the corner
            const bool floor = below(rng, 2) == 0;
            const Vector3d along = floor ? Vector3d(acute ? 1 : -1, 0, 0) : up;
            const Vector3d normal = floor ? Vector3d(0, 0, 1) : front;
            const Vector3d entry = Vector3d(1e-3, between(rng, -0.02, 0.02), 0) + along * s;
            const double room = s * std::sin(acute ? angle : M_PI - angle);
            if (room < 3 * std::max(2 * step, 1e-4)) continue;
            const double deep = std::pow(10, between(rng, -4, -2.7));
            const Vector3d way = -along * 2 * length + y * between(rng, -1, 1) * length;
            approach(*mesh, turn, Vector3d(0, 0, 0), entry, normal, deep, way, step, slack, depth, counts);
        }
    }
    return counts;
}

TEST(United, AFloorAndAWallThroughItThatLeans) {
    Rng rng(seed() + 4000);
    expect_held(leaning(true, approaches(3000), rng), "floor and wall");
}
TEST(United, AWallThatStandsOnTheFloorAndLeans) {
    Rng rng(seed() + 5000);
    expect_held(leaning(false, approaches(3000), rng), "wall on the floor");
}

}  // namespace
}  // namespace knurl::test
