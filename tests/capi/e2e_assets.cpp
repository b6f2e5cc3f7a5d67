// Meshes and height fields from memory to the hand.

#include <generators.hpp>
#include <poll.h>

#include "e2e_support.hpp"

namespace capi_test {
namespace {

struct CAssets : CHand {
    const knurl::test::MadeMesh ball = knurl::test::icosphere(3, 0.1);
    knurl_mesh mesh = sized<knurl_mesh>();
    std::vector<double> flat = std::vector<double>(41 * 31, 0.001);
    knurl_heights heights = sized<knurl_heights>();
    knurl_sent sent = sized<knurl_sent>();

    void SetUp() override {
        CHand::SetUp();
        mesh.vertices = ball.vertices[0].data();
        mesh.vertex_count = ball.vertices.size();
        mesh.triangles = ball.triangles[0].data();
        mesh.triangle_count = ball.triangles.size();
        heights.heights = flat.data();
        heights.columns = 41;
        heights.rows = 31;
        heights.dx = heights.dy = 2e-3;
        heights.corner = {-0.04, -0.03, 0};
    }
    knurl_shape placed(std::uint32_t asset, double below) {
        knurl_shape shape;
        knurl_default_shape(&shape);
        shape.asset = asset;
        shape.stiffness = 200;
        shape.recovery = 0;
        const knurl_vec3& at = device.workspace_centre;
        shape.position = {at.x, at.y, at.z - below};
        return shape;
    }
    /// Comes from below, and is felt.
    void press(std::uint32_t asset, double top) {
        knurl_shape shape = placed(asset, top + 0.005);
        const knurl_id id = add(KNURL_SHAPE, shape);
        ASSERT_TRUE(did(knurl_arm(hand)));
        apply();
        read_until(hand, is_active);
        shape = placed(asset, top - 0.001);
        ASSERT_TRUE(did(knurl_set(hand, id, KNURL_SHAPE, &shape)));
        knurl_feedback felt = sized<knurl_feedback>();
        read_until(hand, [&](const knurl_report&) {
            return knurl_feedback_of(hand, id, &felt) == KNURL_OK && felt.force.z > 0.02;
        });
        EXPECT_NEAR(felt.force.x, 0, 0.2 * felt.force.z);
        ASSERT_TRUE(did(knurl_remove(hand, id)));
    }
};

TEST_F(CAssets, a_mesh_is_sent_felt_and_forgotten) {
    ASSERT_TRUE(did(knurl_send_mesh(hand, &mesh, &sent)));
    EXPECT_EQ(sent.faces, ball.triangles.size());
    EXPECT_EQ(sent.parts, 1u);
    EXPECT_EQ(sent.edges_open, 0u);
    EXPECT_NEAR(sent.high.z, 0.1, 1e-3);
    press(sent.asset, 0.1);
    ASSERT_TRUE(did(knurl_forget(hand, sent.asset)));
    EXPECT_LT(knurl_forget(hand, 77), 0);
    EXPECT_TRUE(one_line(knurl_error(hand)));
}

TEST_F(CAssets, a_mesh_in_single_precision_with_materials_and_scale_is_the_same) {
    std::vector<float> vertices;
    for (const auto& vertex : ball.vertices)
        for (const double x : vertex) vertices.push_back(static_cast<float>(1000 * x));
    const std::vector<std::uint8_t> of(ball.triangles.size(), 1);
    const knurl_asset_material materials[] = {{1, 1, 1}, {0.5, 1, 1}};
    mesh.vertices = nullptr;
    mesh.vertices_float = vertices.data();
    mesh.scale = 1e-3;
    mesh.triangle_materials = of.data();
    mesh.materials = materials;
    mesh.material_count = 2;
    mesh.exact = mesh.no_crossings = 1;
    ASSERT_TRUE(did(knurl_send_mesh(hand, &mesh, &sent)));
    EXPECT_EQ(sent.faces, ball.triangles.size());
    EXPECT_NEAR(sent.low.x, -0.1, 1e-3);
}

TEST_F(CAssets, heights_are_sent_and_felt) {
    ASSERT_TRUE(did(knurl_send_heights(hand, &heights, &sent)));
    EXPECT_EQ(sent.faces, 2u * 40 * 30);
    EXPECT_NEAR(sent.low.z, 0.001, 1e-6);
    press(sent.asset, 0.001);
}

TEST_F(CAssets, are_sent_in_steps_while_the_program_goes_on) {
    knurl_sending *a = nullptr, *b = nullptr;
    ASSERT_TRUE(did(knurl_begin_sending_mesh(hand, &mesh, &a)));
    ASSERT_TRUE(did(knurl_begin_sending_heights(hand, &heights, &b)));
    // What was given is the caller's again.
    std::fill(flat.begin(), flat.end(), NAN);
    int fd = -1;
    ASSERT_TRUE(did(knurl_sending_fd(a, &fd)));
    pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&ready, 1, 20'000), 1);
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_sending_done(a, 0, nullptr)));
    knurl_sent wrong{};
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_sending_done(a, 0, &wrong)));
    ASSERT_TRUE(did(knurl_sending_done(a, KNURL_FOREVER, &sent))) << "a mistake has not closed it";
    const std::uint32_t first = sent.asset;
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_sending_done(a, 0, &sent), "closed"));
    int code = KNURL_NOTHING;
    ASSERT_TRUE(eventually([&] {
        knurl_commit(hand, nullptr);
        code = knurl_sending_done(b, 0, &sent);
        return code != KNURL_NOTHING;
    }));
    ASSERT_TRUE(did(code));
    EXPECT_NE(sent.asset, first);
    EXPECT_NEAR(sent.high.z, 0.001, 1e-6);
}

TEST_F(CAssets, one_that_is_closed_is_called_off) {
    knurl_sending* sending = nullptr;
    ASSERT_TRUE(did(knurl_begin_sending_mesh(hand, &mesh, &sending)));
    ASSERT_TRUE(did(knurl_close(sending)));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(sending)));
    ASSERT_TRUE(did(knurl_begin_sending_mesh(hand, &mesh, &sending)));
    ASSERT_TRUE(did(knurl_close(hand)));
    int fd = 0;
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_sending_fd(sending, &fd))) << "with its hand";
    hand = nullptr;
    claim();
    ASSERT_TRUE(did(knurl_send_mesh(hand, &mesh, &sent)));
}

TEST_F(CAssets, what_is_none_is_refused_in_one_line) {
    const auto refused = [&](auto change, int code) {
        knurl_mesh bad = mesh;
        change(bad);
        knurl_sending* sending = nullptr;
        EXPECT_TRUE(fails(code, knurl_send_mesh(hand, &bad, &sent)));
        const int begun = knurl_begin_sending_mesh(hand, &bad, &sending);
        if (begun == KNURL_OK) {  // the servo's refusal comes later
            EXPECT_LT(knurl_sending_done(sending, 20 * s, &sent), 0);
            EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(sending))) << "an answer closes it";
        }
    };
    refused([](knurl_mesh& m) { m.vertices = nullptr; }, KNURL_BAD_ARGUMENT);
    refused([](knurl_mesh& m) { m.triangles = nullptr; }, KNURL_BAD_ARGUMENT);
    refused([](knurl_mesh& m) { m.vertex_count = std::uint64_t{1} << 60; }, KNURL_BAD_PARAMETERS);
    refused([](knurl_mesh& m) { m.triangle_count = ~std::uint64_t{0}; }, KNURL_BAD_PARAMETERS);
    refused([](knurl_mesh& m) { m.vertex_count = 3; }, KNURL_BAD_PARAMETERS);
    refused([](knurl_mesh& m) { m.triangle_count = 0; }, KNURL_BAD_PARAMETERS);
    refused([](knurl_mesh& m) { m.scale = -1; }, KNURL_BAD_PARAMETERS);
    refused([](knurl_mesh& m) { m.material_count = 300; }, KNURL_BAD_ARGUMENT);
    refused([](knurl_mesh& m) { m.size = 8; }, KNURL_BAD_ARGUMENT);
    knurl_heights bad = heights;
    bad.heights_float = reinterpret_cast<const float*>(flat.data());
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_send_heights(hand, &bad, &sent)));
    bad = heights;
    bad.dx = 0;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_send_heights(hand, &bad, &sent)));
    flat[100] = NAN;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_send_heights(hand, &heights, &sent), "column"));
    knurl_sending* sending = nullptr;
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_send_mesh(hand, nullptr, &sent)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_send_mesh(hand, &mesh, nullptr)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_send_heights(hand, nullptr, &sent)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_begin_sending_mesh(hand, &mesh, nullptr)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_begin_sending_heights(hand, nullptr, &sending)));
    ASSERT_TRUE(did(knurl_send_mesh(hand, &mesh, &sent)));
    EXPECT_EQ(sent.asset, 1u) << "the refused ones took no number";
}

}  // namespace
}  // namespace capi_test
