// Compares the walk with the reference, for hands on meshes without faults. KNURL_STROKES=long takes
// minutes, with up to 1.3 million triangles (scripts/strokes).

#include <gtest/gtest.h>

#include "fetched.hpp"
#include "spoiled.hpp"
#include "verdict.hpp"

namespace {

using namespace knurl;
using namespace knurl::test;

/// Demands the promised accuracy, no lost contact, no wrong place, and no jumps but the reference's.
void expect_right(Verdict& v, double p99) {
    EXPECT_LE(v.error_at(0.99), p99);
    EXPECT_EQ(v.wrong, 0U);
    EXPECT_EQ(v.lost, 0U);
    EXPECT_EQ(v.not_finite, 0U);
    EXPECT_EQ(v.misfit, 0U);
    EXPECT_EQ(v.over_work, 0U);
    EXPECT_GT(v.touching, v.cycles / 4);
    const std::uint64_t apart =
        v.jumps > v.reference_jumps ? v.jumps - v.reference_jumps : v.reference_jumps - v.jumps;
    EXPECT_LE(apart, 2 * v.other_place + v.capped);
    EXPECT_LE(v.other_place, v.cycles / 200);
}

Verdict stroked(const MadeMesh& shape, bool exact, int times) {
    const Mesh mesh(given(shape), {.exact = exact, .weld = exact ? 0 : 1e-6});
    const exact::Surface truth = surface_of(shape);
    return judge_all(mesh, truth, shape, allowed_of(truth, exact), seed(), times);
}

void judge_shape(const MadeMesh& shape, int times) {
    const double size = shape.size();
    for (const bool exact : {true, false}) {
        SCOPED_TRACE(shape.name + (exact ? ", double" : ", float") +
                     ", KNURL_SEED=" + std::to_string(seed()));
        Verdict v = stroked(shape, exact, times);
        std::cout << shape.name << (exact ? ", double: " : ", float: ") << v << '\n';
        expect_right(v, exact ? 1e-11 * size / 0.2 : 1e-7 * size / 0.2);
    }
}

class CleanMesh : public testing::TestWithParam<int> {};
TEST_P(CleanMesh, IsFeltAsTheReferenceFeelsIt) {
    judge_shape(clean_shapes(seed()).at(static_cast<std::size_t>(GetParam())), long_form() ? 60 : 3);
}
std::string clean_name(const testing::TestParamInfo<int>& shape) {
    std::string name = clean_shapes(1).at(static_cast<std::size_t>(shape.param)).name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Shapes, CleanMesh, testing::Range(0, 8), clean_name);

TEST(CleanMesh, OfNeedles) {
    judge_shape(needle_box(), long_form() ? 60 : 3);
}

/// All lengths scale with the size: the same strokes on meshes of 40 um to 40 m.
TEST(CleanMesh, OfAnySize) {
    for (const double scale : {2e-4, 0.02, 200.0})
        judge_shape(scaled(staircase(), scale), long_form() ? 20 : 1);
}

TEST(CleanMesh, FarFromTheOrigin) {
    for (const double far : {1e3, 1e6}) {
        const MadeMesh shape = moved(torus(96, 48), {far, -far / 3, far / 7});
        const exact::Surface truth = surface_of(shape);
        const Mesh mesh(given(shape), {.exact = true, .weld = 0});
        Verdict v = judge_all(mesh, truth, shape, allowed_of(truth, true), seed(), long_form() ? 20 : 1);
        std::cout << shape.name << ": " << v << '\n';
        expect_right(v, 1e-11 + 2 * far * 0x1p-52);  // the rounding of the place as a double
    }
}

/// A hand may appear anywhere. After a short rest, the proxy is at a place of the surface that holds the
/// hand, or there is no contact.
TEST(CleanMesh, UnderAHandThatIsThrownAbout) {
    for (const MadeMesh& shape : {icosphere(4), noisy_sphere(5, 0.6, seed()), comb()}) {
        const exact::Surface truth = surface_of(shape);
        const Mesh mesh(given(shape), {.exact = true, .weld = 0});
        const double size = shape.size();
        Hands hands(shape, seed());
        constexpr int rest = 60;
        const Hand hand = hands.teleports(long_form() ? 5000 : 100, rest);
        Proxy proxy;
        int touching = 0;
        for (std::size_t i = 0; i < hand.size(); ++i) {
            const Eigen::Vector3d h(hand[i][0], hand[i][1], hand[i][2]);
            Foot foot;
            Work work;
            const bool touches = follow(mesh, proxy, h, 0, foot, work);
            ASSERT_TRUE(within_limits(work)) << shape.name << " cycle " << i;
            if (i % rest != rest - 1 || i / rest == 0) continue;
            touching += touches;
            const exact::V at =
                touches ? exact::V{foot.point.x(), foot.point.y(), foot.point.z()} : exact::to_exact(hand[i]);
            if (touches) {
                const int face = truth.nearest_face_near(at);
                EXPECT_LT(exact::distance(truth.nearest(face, at).point, at), 1e-10 * size)
                    << shape.name << " place " << i / rest;
                EXPECT_LT(truth.gain(truth.nearest(face, at).point, exact::to_exact(hand[i]),
                                     1e-10L * truth.size(), face),
                          1e-14 * size)
                    << shape.name << " place " << i / rest << " KNURL_SEED=" << seed();
            }
        }
        EXPECT_GT(touching, 20) << shape.name;
    }
}

/// A ball touches the surface at the point nearest to its centre, if that is within its radius. Once its
/// centre is inside, it touches as a point does.
TEST(CleanMesh, UnderABall) {
    for (const MadeMesh& shape : {icosphere(3), torus(96, 48), cube(10)}) {
        const exact::Surface truth = surface_of(shape);
        const Mesh mesh(given(shape), {.exact = true, .weld = 0});
        const double radius = 0.002 * shape.size() / 0.2;
        Hands hands(shape, seed());
        int near = 0, inside = 0;
        for (int path = 0; path < (long_form() ? 200 : 12); ++path) {
            Proxy proxy;
            exact::GodObject middle(truth);
            for (const auto& p : path % 3 != 0 ? hands.hover() : hands.stroke()) {
                const exact::V h = exact::to_exact(p);
                Foot foot;
                Work work;
                const bool touches = follow(mesh, proxy, {p[0], p[1], p[2]}, radius, foot, work);
                ASSERT_TRUE(within_limits(work));
                const bool behind = middle.step(h);
                const exact::V place =
                    behind ? middle.at() : truth.nearest(truth.nearest_face_near(h), h).point;
                const exact::Real way = exact::distance(place, h);
                const exact::Real depth = radius + (behind ? way : -way);
                const std::string what =
                    shape.name + ", path " + std::to_string(path) + ", KNURL_SEED=" + std::to_string(seed());
                if (std::fabs(depth) > 1e-12L) {
                    ASSERT_EQ(touches, depth > 0) << what;
                }
                if (!touches) continue;
                ASSERT_NEAR(foot.depth, static_cast<double>(depth), 1e-11) << what;
                ASSERT_LT(exact::distance({foot.point.x(), foot.point.y(), foot.point.z()}, place), 1e-11L)
                    << what;
                ++(behind ? inside : near);
            }
        }
        EXPECT_GT(near, 500) << shape.name;
        EXPECT_GT(inside, 500) << shape.name;
    }
}

class FetchedMesh : public testing::TestWithParam<const char*> {};
TEST_P(FetchedMesh, IsFeltAsTheReferenceFeelsIt) {
    const std::string name = GetParam();
    const auto shape = fetched(name);
    if (!shape) GTEST_SKIP() << name << " is not there: scripts/fetch_meshes fetches it with npm";
    const bool large = shape->triangles.size() > 100'000;
    if (large && !long_form()) GTEST_SKIP() << "in the long form: scripts/strokes";
    if (name == "bunny") {
        judge_shape(*shape, long_form() ? 60 : 3);
        if (long_form()) {
            MadeMesh finer = *shape;
            for (int i = 0; i < 4; ++i) judge_shape(finer = subdivided(finer), 20);
        }
        return;
    }
    // These meshes have holes, crossings and edges of many faces. Where the walk takes another path, its
    // place must still hold the hand. The reference repairs nothing, so cases that it cannot decide are only
    // counted.
    const Mesh mesh(given(*shape), {.exact = true});
    const exact::Surface truth = surface_of(*shape);
    Verdict v = judge_all(mesh, truth, *shape, allowed_of(truth, true, mesh.notes().faces_crossed > 0),
                          seed(), large ? 20 : 2);
    std::cout << name << ": " << v << '\n';
    EXPECT_EQ(v.not_finite, 0U);
    EXPECT_EQ(v.misfit, 0U);
    EXPECT_EQ(v.over_work, 0U);
    EXPECT_EQ(v.lost, 0U);
    EXPECT_LE(v.wrong, v.cycles / 500);
    EXPECT_LE(v.error_at(0.99), 1e-11);
}
INSTANTIATE_TEST_SUITE_P(Npm, FetchedMesh,
                         testing::Values("bunny", "dragon_11k", "dragon_48k", "dragon_203k", "dragon_871k"),
                         [](const auto& mesh) { return std::string(mesh.param); });

/// Hands that once fell in where folds of the decimated dragons, from a common vertex on, pass through each
/// other.
TEST(FetchedMeshes, HoldsHandsThatOnceFellThrough) {
    const std::pair<const char*, std::vector<std::uint64_t>> hands[] = {{"dragon_11k", {8, 33, 45, 141}},
                                                                        {"dragon_48k", {17}}};
    for (const auto& [name, seeds] : hands) {
        const auto shape = fetched(name);
        if (!shape) GTEST_SKIP() << name << " is not there: scripts/fetch_meshes fetches it with npm";
        const Mesh mesh(given(*shape), {.exact = true});
        const exact::Surface truth = surface_of(*shape);
        for (const std::uint64_t s : seeds) {
            const Verdict v = judge_all(mesh, truth, *shape, allowed_of(truth, true, true), s, 4);
            EXPECT_EQ(v.lost, 0U) << name << ", seed " << s << ": " << v.first_wrong;
        }
    }
}

TEST(CleanMesh, OfMoreThanAMillionTriangles) {
    if (!long_form()) GTEST_SKIP() << "in the long form: scripts/strokes";
    judge_shape(noisy_sphere(8, 0.6, seed()), 10);
}

}  // namespace
