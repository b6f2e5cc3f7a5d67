// libknurl-offline against closed forms, against itself, and against the servo's cycle as C++ has it.

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <thread>

#include <generators.hpp>

#include <knurl/drivers/registry.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/servo/offline.hpp>

#include "probe_device.hpp"
#include "support.hpp"

namespace capi_test {
namespace {

struct COffline : testing::Test {
    void SetUp() override { ASSERT_TRUE(did(knurl_offline_open(nullptr, nullptr, &servo))); }
    void TearDown() override { EXPECT_TRUE(did(knurl_offline_close(servo))); }

    template <class T>
    knurl_id add(std::uint32_t kind, const T& params) {
        knurl_id id = 0;
        EXPECT_TRUE(did(knurl_offline_add(servo, kind, &params, nullptr, &id)));
        return id;
    }
    knurl_cycle step(const knurl_pose& pose) {
        knurl_cycle cycle = sized<knurl_cycle>();
        EXPECT_TRUE(did(knurl_offline_step(servo, &pose, &cycle)));
        return cycle;
    }
    static knurl_pose at(double x, double y, double z) {
        knurl_pose pose = KNURL_POSE_INIT;
        pose.position = {x, y, z};
        return pose;
    }

    knurl_offline* servo = nullptr;
};

TEST_F(COffline, a_plane_pushes_by_depth) {
    const knurl_id floor = add(KNURL_PLANE, plane(0.01, 800));
    for (int i = 0; i < 100; ++i) {
        const double z = 0.012 - 0.0001 * i;
        const knurl_cycle cycle = step(at(0.003, -0.002, z));
        EXPECT_DOUBLE_EQ(cycle.time, i / 1000.0);
        EXPECT_EQ(cycle.position.z, z);
        EXPECT_NEAR(cycle.force.z, std::max(0.0, 800 * (0.01 - z)), 1e-12);
        EXPECT_EQ(cycle.force.x, 0);
        EXPECT_EQ((cycle.flags & KNURL_REPORT_TOUCHING) != 0, cycle.force.z > 0);
        EXPECT_NEAR(cycle.contact_point.z, std::max(z, 0.01), 1e-12);
        EXPECT_NEAR(cycle.velocity.z, i == 0 ? 0 : -0.1, 1e-9);
        knurl_feedback felt = sized<knurl_feedback>();
        ASSERT_TRUE(did(knurl_offline_feedback_of(servo, floor, &felt)));
        EXPECT_EQ(felt.force.z, cycle.force.z);
        EXPECT_EQ(felt.stiffness, 800);
        EXPECT_EQ((felt.flags & KNURL_FEEDBACK_TOUCHING) != 0, cycle.force.z > 0);
    }
}

TEST_F(COffline, a_spring_pulls_by_stretch_and_forces_add) {
    knurl_spring spring;
    knurl_default_spring(&spring);
    spring.anchor = {0.01, 0.02, 0};
    spring.rest_length = 0.005;
    spring.stiffness = 300;
    add(KNURL_SPRING, spring);
    add(KNURL_CONSTANT_FORCE, at_once(0.25, 0, -0.5));
    const knurl_cycle cycle = step(at(-0.02, -0.02, 0));
    // Near its anchor it is smooth over e: reps/README.md.
    const double length = 0.05, e = 0.005 / 20, pull = 300 * (1 - 0.005 / std::hypot(length, e)) * length;
    EXPECT_NEAR(cycle.force.x, 0.25 + pull * 0.03 / length, 1e-12);
    EXPECT_NEAR(cycle.force.y, pull * 0.04 / length, 1e-12);
    EXPECT_NEAR(cycle.force.z, -0.5, 1e-12);
}

TEST_F(COffline, given_velocities_are_taken) {
    knurl_viscosity oil;
    knurl_default_viscosity(&oil);
    knurl_field field = sized<knurl_field>();
    ASSERT_TRUE(did(knurl_field_at(KNURL_VISCOSITY, 0, &field)));
    oil.damping = 2;
    add(KNURL_VISCOSITY, oil);
    knurl_pose pose = at(0, 0, 0);
    pose.has_velocity = 1;
    pose.velocity = {0.1, -0.2, 0.3};
    pose.buttons = 5;
    knurl_cycle cycle;
    for (int i = 0; i < 2000; ++i) cycle = step(pose);  // whatever the filter, it has settled
    EXPECT_NEAR(cycle.force.x, -0.2, 1e-6);
    EXPECT_NEAR(cycle.force.y, 0.4, 1e-6);
    EXPECT_NEAR(cycle.force.z, -0.6, 1e-6);
    EXPECT_EQ(cycle.buttons, 5u);
}

TEST_F(COffline, a_probe_on_a_lever_turns) {
    const knurl_vec3 lever{0, 0, -0.1};
    ASSERT_TRUE(did(knurl_offline_place_probe(servo, 2, &lever, 0)));
    const knurl_constant_force push = at_once(1, 0, 0);
    knurl_add_options options;
    knurl_default_add_options(&options);
    options.probe = 2;
    knurl_id id = 0;
    ASSERT_TRUE(did(knurl_offline_add(servo, KNURL_CONSTANT_FORCE, &push, &options, &id)));
    EXPECT_NEAR(step(at(0, 0, 0)).torque.y, -0.1, 1e-12) << "r x F";
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_place_probe(servo, 16, nullptr, 0), "16"));
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_place_probe(servo, 0, nullptr, -1), "-1"));
}

TEST_F(COffline, what_was_removed_fades_and_its_name_is_stale) {
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(1, 0, 0));
    EXPECT_EQ(step(at(0, 0, 0)).force.x, 1);
    knurl_constant_force other = at_once(2, 0, 0);
    ASSERT_TRUE(did(knurl_offline_set(servo, push, KNURL_CONSTANT_FORCE, &other)));
    EXPECT_EQ(step(at(0, 0, 0)).force.x, 2);
    ASSERT_TRUE(did(knurl_offline_remove(servo, push)));
    EXPECT_EQ(step(at(0, 0, 0)).force.x, 0);
    EXPECT_TRUE(fails_offline(KNURL_STALE, knurl_offline_remove(servo, push)));
    EXPECT_TRUE(fails_offline(KNURL_STALE, knurl_offline_set(servo, push, KNURL_CONSTANT_FORCE, &other)));
    knurl_feedback felt = sized<knurl_feedback>();
    EXPECT_TRUE(fails_offline(KNURL_STALE, knurl_offline_feedback_of(servo, push, &felt)));
    const knurl_id again = add(KNURL_CONSTANT_FORCE, other);
    EXPECT_NE(again, push);
    knurl_plane floor = plane(0, 1);
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_set(servo, again, KNURL_PLANE, &floor),
                              "constant_force"));
    EXPECT_EQ(knurl_offline_feedback_of(servo, again, &felt), KNURL_NOTHING) << "not evaluated yet";
}

/// A way through space with every kind of motion, from a seed.
std::vector<knurl_pose> wander(std::uint64_t seed, std::size_t count) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<knurl_pose> way;
    knurl_pose pose = KNURL_POSE_INIT;
    knurl_vec3 velocity{};
    for (std::size_t i = 0; i < count; ++i) {
        for (double* v : {&velocity.x, &velocity.y, &velocity.z}) *v = 0.995 * *v + 0.01 * normal(random);
        pose.position = {pose.position.x + 1e-3 * velocity.x, pose.position.y + 1e-3 * velocity.y,
                         0.99 * pose.position.z + 1e-3 * velocity.z};
        pose.orientation = {pose.orientation.w + 0.001 * normal(random),
                            pose.orientation.x + 0.001 * normal(random), 0, 0.1};
        pose.buttons = static_cast<std::uint32_t>(i / 100 % 3);
        way.push_back(pose);
    }
    return way;
}
void add_scene(knurl_offline* servo) {
    knurl_id id = 0;
    knurl_plane floor = plane(0, 900);
    floor.friction_static = 0.6;
    floor.friction_dynamic = 0.4;
    floor.damping = 1;
    knurl_sphere ball;
    knurl_default_sphere(&ball);
    ball.stiffness = 500;
    ASSERT_TRUE(did(knurl_offline_add(servo, KNURL_PLANE, &floor, nullptr, &id)));
    ASSERT_TRUE(did(knurl_offline_add(servo, KNURL_SPHERE, &ball, nullptr, &id)));
}
bool same(const std::vector<knurl_cycle>& a, const std::vector<knurl_cycle>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(knurl_cycle)) == 0;
}

TEST_F(COffline, many_cycles_in_one_call_are_those_one_by_one_and_after_a_reset_again) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<knurl_pose> way = wander(seed, 3000);
    add_scene(servo);
    std::vector<knurl_cycle> one_by_one(way.size(), sized<knurl_cycle>()), at_once = one_by_one,
                                                                           after_reset = one_by_one;
    for (std::size_t i = 0; i < way.size(); ++i)
        ASSERT_TRUE(did(knurl_offline_step(servo, &way[i], &one_by_one[i])));
    ASSERT_TRUE(did(knurl_offline_reset(servo)));
    EXPECT_EQ(step(way[0]).force.z, 0) << "no representation is left";
    ASSERT_TRUE(did(knurl_offline_reset(servo)));
    add_scene(servo);
    ASSERT_TRUE(did(knurl_offline_run(servo, way.data(), way.size(), at_once.data())));
    EXPECT_TRUE(same(one_by_one, at_once));
    std::set<double> forces;
    for (const knurl_cycle& cycle : one_by_one) forces.insert(cycle.force.z);
    EXPECT_GT(forces.size(), 100u) << "something happens";
    // With a stride of a later version.
    ASSERT_TRUE(did(knurl_offline_reset(servo)));
    add_scene(servo);
    std::vector<Later<knurl_cycle>> later(way.size());
    for (Later<knurl_cycle>& each : later) each.tail[1] = 7;
    ASSERT_TRUE(did(knurl_offline_run(servo, way.data(), way.size(), &later[0].known)));
    for (std::size_t i = 0; i < later.size(); ++i) {
        ASSERT_EQ(later[i].known.size, sizeof later[i]);
        ASSERT_EQ(later[i].tail[1], 7u);
        after_reset[i] = later[i].known;
        after_reset[i].size = sizeof(knurl_cycle);
    }
    EXPECT_TRUE(same(one_by_one, after_reset));
    EXPECT_TRUE(did(knurl_offline_run(servo, nullptr, 0, nullptr)));
}

TEST_F(COffline, a_name_from_before_a_reset_is_stale) {
    const knurl_id before = add(KNURL_PLANE, plane(0, 100));
    ASSERT_TRUE(did(knurl_offline_reset(servo)));
    EXPECT_TRUE(fails_offline(KNURL_STALE, knurl_offline_remove(servo, before)));
    const knurl_id after = add(KNURL_PLANE, plane(0, 100));
    EXPECT_NE(before, after);
    EXPECT_TRUE(fails_offline(KNURL_STALE, knurl_offline_remove(servo, before)));
    EXPECT_NEAR(step(at(0, 0, -0.01)).force.z, 1, 1e-12);
}

TEST(COfflineDevices, a_simulated_hand_moves_as_in_the_servos_own_cycle_bit_for_bit) {
    using namespace knurl;
    knurl_offline* servo = nullptr;
    ASSERT_TRUE(did(knurl_offline_open("sim:premium15", nullptr, &servo)));
    const auto device = drivers::open_device("sim:premium15");
    servo::Offline beside(*device, servo::offline_options(1000));
    servo::OfflineClaim& claim = beside.claim(
        protocol::ClaimCapacity{.representations = 128, .batch_bytes = protocol::batch_bytes_for(128)});

    knurl_cycle cycle = sized<knurl_cycle>();
    ASSERT_TRUE(did(knurl_offline_step(servo, nullptr, &cycle)));
    ASSERT_EQ(cycle.position.z, beside.step().position.z);
    knurl_plane floor = plane(cycle.position.z + 0.001, 700);
    floor.friction_static = floor.friction_dynamic = 0.5;
    knurl_id id = 0;
    ASSERT_TRUE(did(knurl_offline_add(servo, KNURL_PLANE, &floor, nullptr, &id)));
    Plane wall{.offset = floor.offset, .stiffness = 700};
    wall.friction.static_ = wall.friction.dynamic = 0.5;
    const RepresentationId wall_id = claim.add(wall);
    knurl_constant_force pull = at_once(0.3, 0.1, -0.2);
    ASSERT_TRUE(did(knurl_offline_add(servo, KNURL_CONSTANT_FORCE, &pull, nullptr, &id)));
    claim.add(ConstantForce{.force = {0.3, 0.1, -0.2}, .recovery = 0});
    double greatest = 0;
    for (int i = 0; i < 2000; ++i) {
        if (i % 50 == 0) {
            floor.offset += 1e-4 * std::sin(i);
            wall.offset = floor.offset;
            ASSERT_TRUE(
                did(knurl_offline_set(servo, std::uint64_t{1} << 32 | wall_id.slot, KNURL_PLANE, &floor)));
            claim.update(wall_id, wall);
            claim.commit();
        }
        ASSERT_TRUE(did(knurl_offline_step(servo, nullptr, &cycle)));
        const Report& report = beside.step();
        ASSERT_EQ(std::memcmp(&cycle.position, &report.position, sizeof report.position), 0) << "cycle " << i;
        ASSERT_EQ(std::memcmp(&cycle.force, &report.scene_force, sizeof report.scene_force), 0)
            << "cycle " << i;
        greatest = std::max(greatest, std::abs(cycle.force.x));
    }
    EXPECT_GT(greatest, 0.01);
    knurl_pose pose = KNURL_POSE_INIT;
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_step(servo, &pose, &cycle), "a hand of its own"));
    ASSERT_TRUE(did(knurl_offline_reset(servo)));
    ASSERT_TRUE(did(knurl_offline_step(servo, nullptr, &cycle)));
    EXPECT_EQ(cycle.time, 0);
    EXPECT_TRUE(did(knurl_offline_close(servo)));
}

TEST_F(COffline, a_probe_that_is_put_feels_the_servos_own_cycle_bit_for_bit) {
    using namespace knurl;
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<knurl_pose> way = wander(seed, 2000);
    add_scene(servo);
    capi::ProbeDevice device(1e-3);
    servo::ServoOptions options = servo::offline_options(1000);
    options.supervisor.off = true;
    servo::Offline beside(device, options);
    servo::OfflineClaim& claim = beside.claim();
    Plane floor{.stiffness = 900, .damping = 1};
    floor.friction.static_ = 0.6;
    floor.friction.dynamic = 0.4;
    claim.add(floor);
    claim.add(Sphere{.stiffness = 500});
    for (const knurl_pose& pose : way) {
        ASSERT_TRUE(device.put(pose));
        const Report& report = beside.step();
        const knurl_cycle cycle = step(pose);
        ASSERT_EQ(std::memcmp(&cycle.force, &report.scene_force, sizeof report.scene_force), 0);
        ASSERT_EQ(std::memcmp(&cycle.torque, &report.scene_torque, sizeof report.scene_torque), 0);
        ASSERT_EQ(cycle.flags, report.flags);
    }
}

TEST_F(COffline, meshes_and_heights_are_felt) {
    const knurl::test::MadeMesh flat = knurl::test::grid(20, 20, 5e-3, 5e-3);
    knurl_mesh mesh = sized<knurl_mesh>();
    mesh.vertices = flat.vertices[0].data();
    mesh.vertex_count = flat.vertices.size();
    mesh.triangles = flat.triangles[0].data();
    mesh.triangle_count = flat.triangles.size();
    knurl_sent sent = sized<knurl_sent>(), field_sent = sent;
    ASSERT_TRUE(did(knurl_offline_send_mesh(servo, &mesh, &sent)));
    EXPECT_EQ(sent.faces, flat.triangles.size());
    EXPECT_GT(sent.edges_open, 0u);

    std::vector<float> z(30 * 20, 0.0f);
    knurl_heights heights = sized<knurl_heights>();
    heights.heights_float = z.data();
    heights.columns = 30;
    heights.rows = 20;
    heights.dx = heights.dy = 2e-3;
    heights.corner = {-0.03, -0.02, 0};
    heights.material = {.stiffness = 0.5, .damping = 1, .friction = 1};
    ASSERT_TRUE(did(knurl_offline_send_heights(servo, &heights, &field_sent)));
    EXPECT_NE(sent.asset, field_sent.asset);

    for (const auto& [asset, stiffness, x] : {std::tuple{sent.asset, 200.0, 0.5 * (sent.low.x + sent.high.x)},
                                              std::tuple{field_sent.asset, 100.0, 0.001}}) {
        ASSERT_TRUE(did(knurl_offline_reset(servo))) << "assets stay";
        knurl_shape shape;
        knurl_default_shape(&shape);
        shape.asset = asset;
        shape.stiffness = 200;
        add(KNURL_SHAPE, shape);
        const double y = asset == sent.asset ? 0.5 * (sent.low.y + sent.high.y) : 0.001;
        step(at(x, y, 0.01));
        for (int i = 0; i < 20; ++i) {
            const double depth = 1e-4 * i;
            EXPECT_NEAR(step(at(x, y, -depth)).force.z, stiffness * depth, 1e-6) << "asset " << asset;
        }
    }
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_mesh(servo, nullptr, &sent)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_mesh(servo, &mesh, nullptr)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_heights(servo, nullptr, &sent)));
    const float some = 0;
    knurl_mesh bad = mesh;
    bad.vertices_float = &some;
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_mesh(servo, &bad, &sent), "vertices"));
    bad = mesh;
    bad.vertex_count = ~std::uint64_t{0};
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_send_mesh(servo, &bad, &sent), "vertex_count"));
    bad = mesh;
    bad.triangles = nullptr;
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_mesh(servo, &bad, &sent)));
    bad = mesh;
    bad.material_count = 257;
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_mesh(servo, &bad, &sent), "257"));
    std::vector<std::uint32_t> beyond(3, 1'000'000);
    bad = mesh;
    bad.triangles = beyond.data();
    bad.triangle_count = 1;
    EXPECT_LT(knurl_offline_send_mesh(servo, &bad, &sent), 0);
    EXPECT_TRUE(one_line(knurl_offline_error()));
    knurl_heights none = heights;
    none.rows = 0;
    EXPECT_LT(knurl_offline_send_heights(servo, &none, &sent), 0);
    none = heights;
    none.columns = none.rows = 1u << 31;
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_send_heights(servo, &none, &sent)));
    for (const std::uint64_t size : wrong_sizes<knurl_mesh>()) {
        bad = mesh;
        bad.size = size;
        EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_send_mesh(servo, &bad, &sent))) << size;
    }
}

TEST_F(COffline, bad_input_is_refused_and_no_cycle_is_made) {
    knurl_id id = 0;
    knurl_plane floor = plane(0, 100), bad = plane(0, -1);
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_add(servo, KNURL_PLANE, &bad, nullptr, &id),
                              "plane.stiffness"));
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_add(servo, 99, &floor, nullptr, &id), "99"));
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_add(servo, KNURL_PLANE, nullptr, nullptr, &id)));
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_add(servo, KNURL_PLANE, &floor, nullptr, nullptr)));
    knurl_add_options options;
    knurl_default_add_options(&options);
    options.probe = 16;
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS,
                              knurl_offline_add(servo, KNURL_PLANE, &floor, &options, &id), "16"));
    options.probe = 0;
    options.on_silence = 9;
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_add(servo, KNURL_PLANE, &floor, &options, &id)));
    knurl_pose pose = at(0, 0, std::nan(""));
    knurl_cycle cycle = sized<knurl_cycle>();
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_step(servo, &pose, &cycle)));
    pose = at(0, 0, 0);
    pose.orientation = {};
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_step(servo, &pose, &cycle)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_step(servo, nullptr, &cycle)));
    pose = at(0, 0, 0);
    for (const std::uint64_t size : wrong_sizes<knurl_cycle>()) {
        cycle.size = size;
        EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_step(servo, &pose, &cycle))) << size;
        EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_run(servo, &pose, 1, &cycle))) << size;
    }
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_run(servo, &pose, 1, nullptr)));
    EXPECT_EQ(step(pose).time, 0) << "none of these made a cycle";
    // It ends with the first pose that cannot be.
    std::vector<knurl_pose> way(5, at(0, 0, 0));
    way[3].position.x = HUGE_VAL;
    std::vector<knurl_cycle> cycles(5, sized<knurl_cycle>());
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_run(servo, way.data(), 5, cycles.data())));
    EXPECT_DOUBLE_EQ(step(pose).time, 0.004);

    knurl_offline* other = nullptr;
    EXPECT_TRUE(fails_offline(KNURL_BAD_ARGUMENT, knurl_offline_open(nullptr, nullptr, nullptr)));
    EXPECT_TRUE(fails_offline(KNURL_NO_SUCH_DEVICE, knurl_offline_open("usb:1", nullptr, &other), "sim:"));
    EXPECT_TRUE(fails_offline(KNURL_NO_SUCH_DEVICE, knurl_offline_open("sim:no\nsuch", nullptr, &other)));
    knurl_offline_options how;
    knurl_offline_default_options(nullptr);
    knurl_offline_default_options(&how);
    EXPECT_EQ(how.rate, 1000);
    for (const double rate : {0.0, -1.0, 1e9, std::nan("")}) {
        how.rate = rate;
        EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_open(nullptr, &how, &other), "rate"));
    }
    knurl_offline_default_options(&how);
    how.representations = 0;
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_open(nullptr, &how, &other)));
    how.representations = 2;
    how.rate = 4000;
    ASSERT_TRUE(did(knurl_offline_open(nullptr, &how, &other)));
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(did(knurl_offline_add(other, KNURL_PLANE, &floor, nullptr, &id)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS,
                              knurl_offline_add(other, KNURL_PLANE, &floor, nullptr, &id), "2"));
    for (int i = 0; i < 2; ++i)
        EXPECT_TRUE(did(knurl_offline_step(other, &pose, &(cycle = sized<knurl_cycle>()))));
    EXPECT_DOUBLE_EQ(cycle.time, 0.00025);
    EXPECT_TRUE(did(knurl_offline_close(other)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_HANDLE, knurl_offline_step(other, &pose, &cycle)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_HANDLE, knurl_offline_reset(other)));
}

TEST_F(COffline, a_shape_of_an_asset_that_was_not_sent_is_refused) {
    knurl_shape shape;
    knurl_default_shape(&shape);
    const knurl_id none = add(KNURL_SHAPE, shape);  // of no asset yet
    shape.asset = 33;
    knurl_id id = 0;
    EXPECT_TRUE(fails_offline(KNURL_BAD_PARAMETERS,
                              knurl_offline_add(servo, KNURL_SHAPE, &shape, nullptr, &id), "asset 33"));
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_set(servo, none, KNURL_SHAPE, &shape), "asset 33"));
    EXPECT_EQ(step(at(0, 0, 0)).force.z, 0);
}

TEST_F(COffline, two_threads_take_turns) {
    const knurl_id floor = add(KNURL_PLANE, plane(0, 100));
    std::thread other([&] {
        for (int i = 0; i < 500; ++i) {
            const knurl_plane moved = plane(1e-6 * i, 100);
            EXPECT_TRUE(did(knurl_offline_set(servo, floor, KNURL_PLANE, &moved)));
        }
    });
    const knurl_pose pose = at(0, 0, -0.01);
    for (int i = 0; i < 500; ++i) EXPECT_TRUE(did(knurl_offline_step(servo, &pose, nullptr)));
    other.join();
    EXPECT_NEAR(step(pose).time, 0.5, 1e-12);
}

}  // namespace
}  // namespace capi_test
