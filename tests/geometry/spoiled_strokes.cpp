// Hands on faulty meshes, and on surfaces that are not manifolds. The surface is that of a good mesh, or
// known in closed form. So either the hand must feel that surface, or the builder refuses the mesh and
// states why.

#include <gtest/gtest.h>

#include "spoiled.hpp"
#include "verdict.hpp"

namespace {

using namespace knurl;
using namespace knurl::test;
using exact::Real;
using exact::V;

/// Compares what is felt of `bad` with the surface of `good`.
Verdict felt(const MadeMesh& bad, const MadeMesh& good, bool exact = true) {
    const Mesh mesh(given(bad), {.exact = exact});
    const exact::Surface truth = surface_of(good);
    const double weld = 1e-6 * good.size();
    Allowed allowed = allowed_of(truth, exact, mesh.notes().faces_crossed > 0);
    if (bad.name.find("jitter") != std::string::npos) allowed = {.same = 4 * weld};
    return judge_all(mesh, truth, good, allowed, seed(), long_form() ? 20 : 1);
}
void expect_right(const MadeMesh& bad, const MadeMesh& good) {
    SCOPED_TRACE(bad.name + ", KNURL_SEED=" + std::to_string(seed()));
    const Verdict v = felt(bad, good);
    std::cout << bad.name << ": " << v << '\n';
    EXPECT_EQ(v.wrong, 0U);
    EXPECT_EQ(v.lost, 0U);
    EXPECT_EQ(v.not_finite, 0U);
    EXPECT_EQ(v.misfit, 0U);
    EXPECT_EQ(v.over_work, 0U);
    EXPECT_LE(v.other_place, v.cycles / 200);
    EXPECT_GT(v.touching, v.cycles / 4);
}

/// A row of the table for each way to spoil a mesh.
class Spoiled : public testing::TestWithParam<int> {
  protected:
    Rng rng{seed()};
    const MadeMesh good[3] = {plane_grid(), torus(48, 24), staircase()};
    const MadeMesh& shape() const { return good[GetParam()]; }
};
TEST_P(Spoiled, Unwelded) {
    expect_right(unwelded(shape()), shape());
}
TEST_P(Spoiled, UnweldedAndShuffled) {
    expect_right(shuffled(unwelded(shape()), rng), shape());
}
TEST_P(Spoiled, UnweldedAndJittered) {
    // A fifth of the welding tolerance, so all corners of a vertex are welded again.
    expect_right(jittered(unwelded(shape()), 2e-7 * shape().size(), rng), shape());
}
TEST_P(Spoiled, FacesTwice) {
    expect_right(duplicated(shape(), 0.3, rng), shape());
    expect_right(unwelded(duplicated(shape(), 0.3, rng)), shape());
}
TEST_P(Spoiled, DegenerateFaces) {
    expect_right(with_degenerate(shape(), 0.3, rng), shape());
    expect_right(shuffled(with_degenerate(shape(), 0.3, rng), rng), shape());
}
TEST_P(Spoiled, TJunctions) {
    expect_right(with_t_junctions(shape(), 0.3, rng), shape());
}
TEST_P(Spoiled, SomeFacesTurned) {
    expect_right(flipped(shape(), 0.3, rng), shape());
}
TEST_P(Spoiled, AVertexThatIsNotANumber) {
    const auto vertex = static_cast<std::uint32_t>(shape().vertices.size() / 2);
    const MadeMesh bad = with_hole_of_nan(shape(), vertex);
    EXPECT_EQ(Mesh(given(bad)).notes().vertices_not_finite, 1U);
    expect_right(bad, without_vertex(shape(), vertex));
}
TEST_P(Spoiled, AVertexFarAway) {
    expect_right(with_far_vertex(shape()), shape());
}
INSTANTIATE_TEST_SUITE_P(Shapes, Spoiled, testing::Range(0, 3), [](const auto& shape) {
    return std::string(shape.param == 0 ? "plane" : shape.param == 1 ? "torus" : "staircase");
});

/// Follows `hand`, and compares the proxy's place with `known`.
template <class Known>
void expect_known(const MadeMesh& shape, const Hand& hand, double tolerance, Known&& known) {
    SCOPED_TRACE(shape.name);
    const Mesh mesh(given(shape), {.exact = true});
    Proxy proxy;
    std::uint64_t off = 0;
    std::size_t first = 0;
    double worst = 0;
    for (std::size_t i = 0; i < hand.size(); ++i) {
        const V h = exact::to_exact(hand[i]);
        Foot foot;
        Work work;
        const bool touches = follow(mesh, proxy, {hand[i][0], hand[i][1], hand[i][2]}, 0, foot, work);
        ASSERT_TRUE(within_limits(work)) << i;
        const V at = touches ? V{foot.point.x(), foot.point.y(), foot.point.z()} : h;
        const double apart = static_cast<double>(exact::distance(at, known(h)));
        worst = std::max(worst, std::isfinite(apart) ? apart : INFINITY);
        if (!(apart <= tolerance) && off++ == 0) first = i;
    }
    EXPECT_EQ(off, 0U) << "of " << hand.size() << " cycles; first " << first << ", hand " << hand[first][0]
                       << ' ' << hand[first][1] << ' ' << hand[first][2] << "; worst " << worst << " m";
}

/// A path along x from `from` to `to`, at that depth (m).
Hand slide(double from, double to, double y, double depth, double step = 0.0002) {
    Hand hand{{from, y, 0.001}};
    const double way = to > from ? step : -step;
    for (double x = from; (to - x) * way > 0; x += way) hand.push_back({x, y, -depth});
    return hand;
}
V corner_of(const V& h) {  // of a floor z = 0 and a wall x = 0
    return {std::max<Real>(h.x, 0), h.y, std::max<Real>(h.z, 0)};
}

TEST(NoManifold, AWallThatCrossesTheFloorStopsTheProxy) {
    const MadeMesh shape = crossing_sheets();
    const double delta = 1e-6 * shape.size();
    for (const double y : {0.0, 0.0123, -0.031}) {
        for (const double depth : {0.0001, 0.002}) {
            expect_known(shape, slide(0.05, -0.02, y, depth), delta, corner_of);
            Hand hand = slide(0.05, -0.01, y, depth);  // and up the wall, and away
            for (int i = 1; i <= 300; ++i) hand.push_back({-0.01, y + 5e-5 * i, -depth + 1e-4 * i});
            for (int i = 1; i <= 200; ++i) hand.push_back({-0.01 + 1e-4 * i, y, 0.03 - depth});
            for (int i = 1; i <= 400; ++i) hand.push_back({0.01, y, 0.03 - depth - 1e-4 * i});
            expect_known(shape, hand, delta, corner_of);
        }
    }
}

TEST(NoManifold, ThreeSheetsAtAnEdge) {
    for (const double y : {0.0, 0.0123}) {
        expect_known(three_sheets(), slide(0.03, -0.03, y, 0.002), 1e-11, corner_of);
        expect_known(three_sheets(), slide(-0.03, 0.03, y, 0.002), 1e-11,  // through the fin from its back
                     [](const V& h) {
                         return V{h.x, h.y, std::max<Real>(h.z, 0)};
                     });
    }
}

TEST(NoManifold, TwoSidedSheetHoldsFromBothSides) {
    for (const int side : {1, -1}) {
        Hand hand;
        for (int i = 0; i < 300; ++i)
            hand.push_back({-0.01 + 5e-5 * i, 3e-5 * i, side * (0.0005 - 2e-5 * i)});
        expect_known(two_sided_sheet(), hand, 1e-11, [&](const V& h) {
            return V{h.x, h.y, side > 0 ? std::max<Real>(h.z, 0) : std::min<Real>(h.z, 0)};
        });
    }
}

/// The tip slips off as off the edge of a table. A thin plate lets go in the same way.
TEST(NoManifold, ASheetWithTwoSidesLetsGoBeyondItsEdge) {
    for (const auto& way : {V{1, 0, 0}, V{0.6L, -0.8L, 0}, V{0, 1, 0}}) {
        for (const MadeMesh& shape : {plane_grid(), two_sided_sheet()}) {
            Hand hand{{0.00035, 0.00011, 0.001}};
            for (int i = 0; i < 300; ++i) {
                const V h = V{0.00035L, 0.00011L, -0.001L} + 0.0001L * i * way;
                hand.push_back({static_cast<double>(h.x), static_cast<double>(h.y), -0.001});
            }
            expect_known(shape, hand, 1e-11, [](const V& h) {
                return h.z > 0 || std::max(std::fabs(h.x), std::fabs(h.y)) > 0.02L ? h : V{h.x, h.y, 0};
            });
        }
    }
}

TEST(NoManifold, CubesThatShareAnEdgeOrACorner) {
    for (const MadeMesh& shape : {cubes_at_an_edge(), cubes_at_a_corner()}) expect_right(shape, shape);
}

/// A Moebius strip has only one side. The built surface must be in its place, or the mesh is refused in one
/// line.
TEST(NoManifold, AMoebiusStripIsHeldToItsSurfaceOrRefused) {
    const MadeMesh shape = moebius();
    try {
        const Mesh mesh(given(shape), {.exact = true});
        const exact::Surface truth = surface_of(shape);
        Hands hands(shape, seed());
        for (int i = 0; i < 10; ++i) {
            Proxy proxy;
            for (const auto& h : hands.stroke()) {
                Foot foot;
                Work work;
                if (!follow(mesh, proxy, {h[0], h[1], h[2]}, 0, foot, work)) continue;
                ASSERT_TRUE(within_limits(work));
                const V at{foot.point.x(), foot.point.y(), foot.point.z()};
                ASSERT_LT(exact::distance(truth.nearest(truth.nearest_face_near(at), at).point, at), 1e-11);
            }
        }
    } catch (const MeshError& refused) {
        EXPECT_NE(std::string(refused.what()), "");
        EXPECT_EQ(std::string(refused.what()).find('\n'), std::string::npos);
    }
}

/// A hand whose position is not finite feels nothing, whatever held the proxy, and the next cycle starts
/// anew.
TEST(NoManifold, AHandThatIsNotANumberFeelsNothing) {
    const Mesh mesh(given(crossing_sheets()));
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const bool corner : {false, true}) {  // on the floor; between floor and wall
                Proxy proxy;
                Foot foot;
                Work work;
                const double to = corner ? -0.001 : 0.05;
                for (int i = 0; i <= 200; ++i) {
                    const double x = 0.08 + i * (to - 0.08) / 200;
                    follow(mesh, proxy, {x, 0.001, i == 0 ? 0.001 : -0.001}, 0, foot, work);
                }
                Eigen::Vector3d hand(to, 0.001, -0.001);
                EXPECT_TRUE(follow(mesh, proxy, hand, 0, foot, work));
                hand[axis] = bad;
                EXPECT_FALSE(follow(mesh, proxy, hand, 0, foot, work))
                    << bad << " axis " << axis << " corner " << corner;
                EXPECT_FALSE(follow(mesh, proxy, {to, 0.001, 0.002}, 0, foot, work));
                EXPECT_TRUE(follow(mesh, proxy, {0.05, 0.001, -0.001}, 0, foot, work) || corner);
            }
        }
    }
}

TEST(NoManifold, SheetsThatCrossAreFoundAndOthersAreNot) {
    EXPECT_GT(Mesh(given(crossing_sheets()), {.unite = false}).notes().faces_crossed, 0U);
    EXPECT_EQ(Mesh(given(crossing_sheets())).notes().faces_crossed, 0U);  // cut there
    EXPECT_GT(Mesh(given(crossing_sheets())).notes().faces_cut, 0U);
    for (const MadeMesh& shape : clean_shapes(seed()))
        EXPECT_EQ(Mesh(given(shape)).notes().faces_crossed, 0U) << shape.name;
}

}  // namespace
