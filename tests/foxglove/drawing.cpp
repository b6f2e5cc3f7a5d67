// Representations as markers: where they are, in the device's frame.

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/messages/drawing.hpp>
#include <knurl/reps/all.hpp>

namespace knurl::test {
namespace {

using namespace messages;

template <class R>
std::vector<std::byte> bytes_of(const R& params) {
    std::vector<std::byte> bytes(sizeof params);
    std::memcpy(bytes.data(), &params, sizeof params);
    return bytes;
}

const Surroundings around{.hand = {0.01, 0.02, 0.03}, .reach = 0.1};

template <class R>
std::vector<Marker> drawn(const R& params, Item item = {}) {
    const std::vector<std::byte> bytes = bytes_of(params);
    item.kind = kind_of<R>;
    item.params = bytes;
    return draw(item, around, "claim 1", 80);
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
    EXPECT_LT((to_eigen(a) - to_eigen(b)).norm(), tolerance)
        << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

template <class... R>
void each_kind(TypeList<R...>, auto visit) {
    (visit(R{}), ...);
}

TEST(Drawing, NoKindIsForgotten) {
    each_kind(Representations{}, []<class R>(R params) {
        // What has no force by default has nothing to show.
        if constexpr (requires { params.force; }) params.force = {1, 0, 0};
        if constexpr (requires { params.mass; }) params.mass = 0.1;
        if constexpr (requires { params.amplitude; }) params.amplitude = 1;
        if constexpr (requires { params.damping; }) params.damping = 1;
        if constexpr (requires { params.asset; }) params.asset = 5;
        const std::vector<Marker> markers = drawn(params);
        ASSERT_FALSE(markers.empty()) << Describe<R>::name;
        EXPECT_LE(markers.size(), most_parts) << Describe<R>::name;
        for (std::size_t i = 0; i < markers.size(); ++i) {
            EXPECT_EQ(markers[i].id, 80 + static_cast<int>(i)) << Describe<R>::name;
            EXPECT_EQ(markers[i].ns, "claim 1");
        }
    });
}

TEST(Drawing, APlaneIsAPatchUnderTheHand) {
    // x + y = 0.2 / sqrt 2, given with a normal of length 2.
    const Plane plane{.normal = {std::sqrt(2), std::sqrt(2), 0}, .offset = 0.2};
    const Marker patch = drawn(plane).front();
    EXPECT_EQ(patch.type, Marker::cube);
    const Eigen::Vector3d n = Eigen::Vector3d(1, 1, 0).normalized(), hand = to_eigen(around.hand);
    const Eigen::Vector3d foot = hand - n * (n.dot(hand) - 0.1);
    // The upper face of the thin cube is the plane.
    expect_near(to_plain(Eigen::Vector3d(to_eigen(patch.position) + n * patch.scale.z / 2)), to_plain(foot));
    expect_near(to_plain(Eigen::Vector3d(to_eigen(patch.orientation) * Eigen::Vector3d::UnitZ())),
                to_plain(n));
    EXPECT_DOUBLE_EQ(patch.scale.x, 0.1);
}

TEST(Drawing, AClaimsWorldIsScaledAndMoved) {
    Item item;
    item.frame = {.device_centre = {0, 0, 0.1}, .world_centre = {10, 0, 0}, .scale = 100, .force_scale = 1};
    const std::vector<Marker> markers =
        drawn(Capsule{.center = {10, 5, 0}, .axis = {0, 3, 0}, .half_length = 2, .radius = 1}, item);
    ASSERT_EQ(markers.size(), 3u);
    EXPECT_EQ(markers[0].type, Marker::cylinder);
    expect_near(markers[0].position, {0, 0.05, 0.1});
    expect_near(markers[0].scale, {0.02, 0.02, 0.04});
    EXPECT_EQ(markers[1].type, Marker::sphere);
    expect_near(markers[1].position, {0, 0.03, 0.1});
    expect_near(markers[2].position, {0, 0.07, 0.1});
}

TEST(Drawing, ATorusCapAndPolygonLieOnTheirSurface) {
    const Torus torus{.center = {0.1, 0, 0}, .axis = {1, 2, 3}, .radius = 0.02, .tube = 0.005};
    const Marker ring = drawn(torus).front();
    ASSERT_EQ(ring.points.size() % 3, 0u);
    const Eigen::Vector3d n = Eigen::Vector3d(1, 2, 3).normalized();
    for (const Vec3& p : ring.points) {
        const Eigen::Vector3d d = to_eigen(p) - to_eigen(torus.center);
        const double along = d.dot(n), out = (d - along * n).norm();
        EXPECT_NEAR(std::hypot(out - torus.radius, along), torus.tube, 1e-12);
    }
    const Cap cap{.foot = {0, 0, 0.01}, .normal = {0, 0, 1}, .curvature = -2, .rim = 0.05};
    const Marker dome = drawn(cap).front();
    ASSERT_FALSE(dome.points.empty());
    for (const Vec3& p : dome.points) {
        const double r = std::hypot(p.x, p.y);
        EXPECT_LE(r, cap.rim / 2 + 1e-12) << "within the rim";
        const double sphere = 0.01 - (0.5 - std::sqrt(0.25 - r * r));
        EXPECT_NEAR(p.z, sphere, 1e-5) << "a sphere of radius 0.5 m below its foot";
    }
    EXPECT_EQ(drawn(Polygon{}).front().points.size(), 6u);
}

TEST(Drawing, AHalfPlaneEndsAtItsEdge) {
    const HalfPlane shelf{.normal = {0, 0, 1}, .offset = 0, .edge = {1, 0, 0}, .edge_offset = -0.02};
    const Marker patch = drawn(shelf).front();
    EXPECT_NEAR(patch.position.x + patch.scale.x / 2, -0.02, 1e-12) << "the hand is beyond it";
}

TEST(Drawing, AMeshIsPosedByItsMarker) {
    const std::vector<float> vertices{0, 0, 0, 1, 0, 0, 0, 2, 0};
    const std::vector<std::uint32_t> corners{0, 1, 2, 0, 1, 9 /* none: left out */};
    const Triangles triangles{vertices, corners};
    Item item;
    item.triangles = &triangles;
    item.frame.scale = 10;
    const Marker mesh =
        drawn(Shape{.asset = 1, .position = {5, 0, 0}, .orientation = {0, 0, 0, 2}}, item).front();
    EXPECT_EQ(mesh.type, Marker::triangle_list);
    ASSERT_EQ(mesh.points.size(), 3u);
    expect_near(mesh.position, {0.5, 0, 0});
    expect_near(mesh.points[2], {0, 0.2, 0});
    EXPECT_DOUBLE_EQ(mesh.orientation.z, 1);
    const std::vector<std::uint32_t> some(3 * (triangles_of_marker + 1));
    const Triangles two{vertices, some};
    item.triangles = &two;
    const std::vector<Marker> parts = drawn(Shape{.asset = 1}, item);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].points.size(), 3 * triangles_of_marker);
    EXPECT_EQ(parts[1].points.size(), 3u);
    const std::vector<std::uint32_t> many(3 * (most_triangles + 1));
    const Triangles large{vertices, many};
    item.triangles = &large;
    EXPECT_EQ(drawn(Shape{.asset = 1}, item).front().type, Marker::cube) << "a box around what is too large";
}

TEST(Drawing, AFieldsArrowsPointAlongItsForce) {
    const Taylor field{.origin = {0, 0, 0}, .force = {2, 0, 0}, .radius = 0.05};
    const Marker arrows = drawn(field).front();
    EXPECT_EQ(arrows.type, Marker::line_list);
    ASSERT_GT(arrows.points.size(), 6u * 27);
    for (std::size_t i = 0; i + 5 < arrows.points.size(); i += 6) {
        const Vec3 &from = arrows.points[i], &to = arrows.points[i + 1];
        expect_near(to, {from.x + 0.02, from.y, from.z});
    }
}

TEST(Drawing, LooksAsItFeels) {
    const Sphere ball;
    const float whole = drawn(ball).front().colour.a;
    Item item;
    item.fading = true;
    EXPECT_LT(drawn(ball, item).front().colour.a, 0.5F * whole);
    item = {};
    item.asleep = true;
    const Colour grey = drawn(ball, item).front().colour;
    EXPECT_TRUE(grey.r == grey.g && grey.g == grey.b);
    item = {};
    item.touching = true;
    EXPECT_FALSE(drawn(ball, item).front().colour == drawn(ball).front().colour);
}

TEST(Drawing, DrawsNothingOfWhatIsNoRepresentation) {
    EXPECT_TRUE(draw({.kind = 10'000, .params = {}, .frame = {}}, around, "", 0).empty());
    const std::vector<std::byte> bytes = bytes_of(Plane{});
    EXPECT_TRUE(
        draw({.kind = kind_of<Plane>, .params = std::span(bytes).first(8), .frame = {}}, around, "", 0)
            .empty());
    protocol::Frame flat;
    flat.scale = 0;
    EXPECT_TRUE(draw({.kind = kind_of<Plane>, .params = bytes, .frame = flat}, around, "", 0).empty());
    EXPECT_TRUE(draw({.kind = kind_of<Plane>, .params = bytes, .frame = {}}, {.hand = {}, .reach = 0}, "", 0)
                    .empty());
}

TEST(Drawing, AnyBytesAreDrawnWithinBounds) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    for (int turn = 0; turn < 2000; ++turn)
        for (Kind kind = 0; kind < kinds().size(); ++kind) {
            std::vector<std::byte> bytes(kinds()[kind].size);
            for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
            const auto markers = draw({.kind = kind, .params = bytes, .frame = {}}, around, "", 0);
            ASSERT_LE(markers.size(), most_parts);
            for (const Marker& marker : markers) ASSERT_LE(marker.points.size(), 10'000u);
        }
}

}  // namespace
}  // namespace knurl::test
