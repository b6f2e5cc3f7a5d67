// A client of the VRPN server: what it is told, and what its commands become.

#include <cmath>

#include <gtest/gtest.h>

#include <knurl/reps/constraint.hpp>
#include <knurl/reps/shape.hpp>
#include <knurl/reps/taylor.hpp>
#include <knurl/reps/vibration.hpp>

#include "fakes.hpp"

namespace {

using namespace vrpn_test;

double number_at(const Got& got, std::size_t offset) {
    Payload in(std::span(got.payload).subspan(offset));
    return in.take<double>();
}
std::int32_t word_at(const Got& got, std::size_t offset) {
    Payload in(std::span(got.payload).subspan(offset));
    return in.take<std::int32_t>();
}

void expect_near(const Vec3& v, const Vec3& wanted, double tolerance = 1e-6) {
    EXPECT_NEAR(v.x, wanted.x, tolerance);
    EXPECT_NEAR(v.y, wanted.y, tolerance);
    EXPECT_NEAR(v.z, wanted.z, tolerance);
}

TEST(VrpnSession, it_begins_with_its_port_its_senders_its_types_and_the_buttons) {
    FakeAround around;
    SessionOptions options;
    Session session(options, around);
    session.begin("127.0.0.1", 4000, {});
    ASSERT_EQ(around.got.size(), 3 + type_count + 1);
    EXPECT_EQ(around.got[0].header.type, system_type::udp);
    EXPECT_EQ(around.got[0].header.sender, 4000);
    EXPECT_STREQ(reinterpret_cast<const char*>(around.got[0].payload.data()), "127.0.0.1");
    EXPECT_EQ(around.got[2].header.type, system_type::sender);
    EXPECT_EQ(around.got[2].header.sender, 1);
    EXPECT_EQ(described_name(around.got[2].payload), "Phantom0");
    EXPECT_EQ(around.got.back().header.type, static_cast<std::int32_t>(Type::button_states));
}

TEST(VrpnSession, a_client_without_datagrams_is_not_told_of_any) {
    FakeAround around;
    SessionOptions options;
    Session session(options, around);
    session.begin("127.0.0.1", 0, {});
    EXPECT_EQ(around.got[0].header.type, system_type::sender);
}

TEST(VrpnSession, a_report_is_pose_velocity_force_and_contact_point_in_the_clients_axes) {
    FakeClient client;
    HandReport report;
    report.read_ns = std::chrono::nanoseconds(client.now.time_since_epoch()).count() - 5000;
    report.position = {0.3, 0.1, 0.2};  // towards the user, right, up
    report.velocity = {3, 1, 2};
    report.sent_force = {6, 4, 5};
    report.contact_point = {9, 7, 8};
    report.orientation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // about what points up
    client.session.report(0, std::span(&report, 1), client.now);
    const std::vector<Got> got = std::exchange(client.around.got, {});
    ASSERT_EQ(got.size(), 4u);
    std::size_t bytes = 0;
    for (const Got& each : got) {
        EXPECT_EQ(each.service, Service::quick);
        EXPECT_EQ(each.header.sender, 1);
        EXPECT_EQ(each.header.microseconds, 123451)
            << "when it was read, 5 us before the wall clock's 123456 us";
        bytes += header_bytes + each.payload.size();
    }
    EXPECT_EQ(bytes, 88u + 96 + 48 + 80);
    EXPECT_EQ(got[0].payload.size(), 64u);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_DOUBLE_EQ(number_at(got[0], 8 + 8 * i), 0.1 * static_cast<double>(i + 1));
    EXPECT_NEAR(number_at(got[0], 8 + 8 * 4), std::sqrt(0.5), 1e-15) << "about y, which points up: x y z w";
    EXPECT_NEAR(number_at(got[0], 8 + 8 * 6), std::sqrt(0.5), 1e-15);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(number_at(got[1], 8 + 8 * i), static_cast<double>(i + 1));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(number_at(got[2], 8 * i), static_cast<double>(i + 4));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(number_at(got[3], 8 * i), static_cast<double>(i + 7));
}

TEST(VrpnSession, reports_that_came_together_fit_into_a_datagram) {
    FakeClient client;
    std::vector<HandReport> reports(60);
    for (std::size_t i = 0; i < reports.size(); ++i)
        reports[i].read_ns = static_cast<std::int64_t>(i + 1) * 1'000'000;
    client.session.report(0, reports, client.now);
    EXPECT_EQ(client.around.too_long, 0);
    EXPECT_EQ(client.around.take(Type::pos_quat).size(), 4u) << "the newest";
}

TEST(VrpnSession, a_client_may_ask_for_fewer_reports) {
    FakeClient client;
    PayloadWriter out;
    out.put(100.0);
    client.say(Type::set_update_rate, out);
    for (std::int64_t i = 0; i < 1000; ++i) {
        HandReport report;
        report.read_ns = 1'000'000'000 + i * 1'000'000;
        client.session.report(0, std::span(&report, 1), client.now);
    }
    EXPECT_EQ(client.around.take(Type::pos_quat).size(), 100u);
    out.clear();
    out.put(std::nan(""));
    client.say(Type::set_update_rate, out);
    EXPECT_NE(client.text().find("set_update_rate: the rate must be"), std::string::npos);
}

TEST(VrpnSession, each_change_of_a_button_is_told_by_tcp) {
    FakeClient client;
    std::vector<HandReport> reports(3);
    reports[0].buttons = 0b10;
    reports[2].buttons = 0b100;
    client.session.report(0, reports, client.now);
    const std::vector<Got> changes = client.around.take(Type::button_change);
    ASSERT_EQ(changes.size(), 3u) << "1 down, 1 up, 2 down";
    EXPECT_EQ(changes[0].service, Service::reliable);
    EXPECT_EQ(word_at(changes[0], 0), 1);
    EXPECT_EQ(word_at(changes[0], 4), 1);
    EXPECT_EQ(word_at(changes[1], 4), 0);
    EXPECT_EQ(word_at(changes[2], 0), 2);
}

TEST(VrpnSession, a_ping_is_answered_with_a_pong_and_the_buttons) {
    FakeClient client;
    client.say(Type::ping);
    ASSERT_EQ(client.around.got.size(), 2u);
    EXPECT_EQ(client.around.got[0].header.type, static_cast<std::int32_t>(Type::pong));
    EXPECT_EQ(word_at(client.around.got[1], 0), 8) << "buttons";
}

TEST(VrpnSession, requests_are_answered) {
    FakeClient client;
    client.around.list[0].device->workspace_centre = {0.03, 0.01, 0.02};
    client.say(Type::request_workspace);
    const std::vector<Got> workspace = client.around.take(Type::workspace);
    ASSERT_EQ(workspace.size(), 1u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(number_at(workspace[0], 8 * i), 0.01 * static_cast<double>(i + 1) - 0.1, 1e-12);
        EXPECT_NEAR(number_at(workspace[0], 24 + 8 * i), 0.01 * static_cast<double>(i + 1) + 0.1, 1e-12);
    }
    client.say(Type::request_to_room);
    EXPECT_EQ(client.around.take(Type::to_room).at(0).payload.size(), 56u);
    client.say(Type::request_unit_to_sensor);
    EXPECT_EQ(client.around.take(Type::unit_to_sensor).at(0).payload.size(), 64u);
    client.say(Type::reset_origin);
    EXPECT_NE(client.text().find("Reset_Origin: the origin is the middle"), std::string::npos);
}

TEST(VrpnSession, a_plane_is_a_plane_in_the_devices_frame) {
    FakeClient client;
    client.plane({0, 1, 0, -0.01f, 0.25f, 0.002f, 0.2f, 0.4f}, 3, 30);
    const Plane plane = client.around.told.get<Plane>("plane 3");
    EXPECT_EQ(plane.normal, (Vec3{0, 0, 1})) << "up";
    EXPECT_NEAR(plane.offset, 0.01, 1e-9) << "y - 0.01 < 0 is inside";
    EXPECT_NEAR(plane.stiffness, 500, 1e-3) << "of 2000 N/m";
    EXPECT_NEAR(plane.damping, 2, 1e-6);
    EXPECT_NEAR(plane.friction.dynamic, 0.2, 1e-6);
    EXPECT_NEAR(plane.friction.static_, 0.4, 1e-6);
    EXPECT_NEAR(plane.recovery, 0.03, 1e-12) << "30 cycles of 1 ms";
    EXPECT_EQ(plane.update, PlaneUpdate::last_depth);
    EXPECT_EQ(client.around.told.sent, 1);
    client.plane({1, 0, 0, 0, 0.25f, 0, 0, 0}, 3);
    EXPECT_EQ(client.around.told.get<Plane>("plane 3").normal, (Vec3{0, 1, 0})) << "right";
    client.plane({0, 0, 0, 0, 0.25f, 0, 0, 0}, 3);
    EXPECT_TRUE(client.around.told.items.empty()) << "all zero stops it";
    EXPECT_EQ(client.around.told.calls,
              (std::vector<std::string>{"add plane 3", "set plane 3", "remove plane 3"}));
}

TEST(VrpnSession, a_plane_without_a_recovery_time_is_faded) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0}, 0, 0);
    EXPECT_EQ(client.around.told.get<Plane>("plane 0").update, PlaneUpdate::fade);
    EXPECT_EQ(client.around.told.get<Plane>("plane 0").recovery, 0);
}

TEST(VrpnSession, a_stiffness_above_one_is_the_largest) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 500, 0, 0, 0});
    EXPECT_EQ(client.around.told.get<Plane>("plane 0").stiffness, 2000);
}

TEST(VrpnSession, a_texture_and_a_buzz_belong_to_the_plane_before) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 0.5f, 0, 0, 0}, 1);
    const auto effects = [&](const std::array<float, 6>& values) {
        client.floats(Type::plane_effects, {values.begin(), values.end()});
    };
    effects({0, 0, 1e-4f, 2e-3f, 0.5f, 150});
    const Plane plane = client.around.told.get<Plane>("plane 1");
    EXPECT_NEAR(plane.texture.amplitude, 1e-4, 1e-9);
    EXPECT_NEAR(plane.texture.wavelength, 2e-3, 1e-9);
    EXPECT_EQ(client.around.told.get<Vibration>("buzz").amplitude, 0) << "nothing is touched";
    HandReport report;
    report.flags = report_flags::touching;
    client.session.report(0, std::span(&report, 1), client.now);
    EXPECT_EQ(client.around.told.get<Vibration>("buzz").amplitude, 0.5);
    EXPECT_EQ(client.around.told.get<Vibration>("buzz").frequency, 150);
    report.flags = 0;
    client.session.report(0, std::span(&report, 1), client.now);
    EXPECT_EQ(client.around.told.get<Vibration>("buzz").amplitude, 0);
    effects({0, 0, 0, 0, 0, 0});
    EXPECT_FALSE(client.around.told.items.contains("buzz"));
    EXPECT_EQ(client.around.told.get<Plane>("plane 1").texture.amplitude, 0);
    effects({0.1f, 0, 0, 0, 0, 0});
    EXPECT_NE(client.text().find("adhesion is not felt"), std::string::npos);
}

TEST(VrpnSession, a_field_is_a_taylor_field_with_its_jacobian_turned) {
    FakeClient client;
    client.floats(Type::force_field,
                  {0.1f, 0.2f, 0.3f, 1, 2, 3, /* dF/dx row-major */ 1, 2, 3, 4, 5, 6, 7, 8, 9, 0.05f});
    const Taylor field = client.around.told.get<Taylor>("field");
    expect_near(field.origin, {0.3, 0.1, 0.2});
    expect_near(field.force, {3, 1, 2});
    // Knurl's x is the client's z, y is x, z is y.
    const double wanted[9] = {9, 7, 8, 3, 1, 2, 6, 4, 5};
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(field.jacobian.at[i], wanted[i]) << i;
    EXPECT_NEAR(field.radius, 0.05, 1e-8);
    client.floats(Type::force_field, std::vector<float>(16));
    EXPECT_TRUE(client.around.told.items.empty());
}

TEST(VrpnSession, a_constraint_is_felt_once_it_is_complete) {
    FakeClient client;
    client.numbers(Type::constraint_mode, {2});
    client.floats(Type::constraint_line_point, {0, 0.01f, 0});
    client.floats(Type::constraint_line_direction, {1, 0, 0});
    client.numbers(Type::constraint_enable, {1});
    EXPECT_TRUE(client.around.told.items.empty()) << "it has no stiffness";
    client.floats(Type::constraint_stiffness, {300});
    const Constraint held = client.around.told.get<Constraint>("constraint");
    EXPECT_EQ(held.shape, ConstraintShape::line);
    expect_near(held.origin, {0, 0, 0.01});
    EXPECT_EQ(held.direction, (Vec3{0, 1, 0}));
    EXPECT_EQ(held.stiffness, 300);
    client.numbers(Type::constraint_mode, {1});
    EXPECT_EQ(client.around.told.get<Constraint>("constraint").shape, ConstraintShape::point);
    client.numbers(Type::constraint_enable, {0});
    EXPECT_TRUE(client.around.told.items.empty());
    client.numbers(Type::constraint_mode, {4});
    EXPECT_NE(client.text().find("constraint mode 4 is none"), std::string::npos);
}

/// A tetrahedron of 10 cm.
void tetrahedron(FakeClient& client, std::int32_t object = 0) {
    const float corners[4][3] = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}};
    const std::int32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (std::int32_t i = 0; i < 4; ++i) {
        PayloadWriter out;
        out.put(object).put(i).put(corners[i][0]).put(corners[i][1]).put(corners[i][2]);
        client.say(Type::set_vertex, out);
        client.numbers(Type::set_triangle,
                       {object, i, triangles[i][0], triangles[i][1], triangles[i][2], -1, -1, -1});
    }
    client.floats(Type::update_trimesh, {0.5f, 0.001f, 0.4f, 0.2f}, object);
}

TEST(VrpnSession, a_trimesh_is_sent_as_a_mesh_in_the_devices_axes) {
    FakeClient client;
    tetrahedron(client);
    const Told::Item item = client.around.told.items.at("mesh 0");
    ASSERT_TRUE(item.mesh);
    ASSERT_EQ(item.mesh->vertices.size(), 4u);
    EXPECT_EQ(item.mesh->triangles.size(), 4u);
    EXPECT_NEAR(item.mesh->vertices[1][1], 0.1, 1e-7) << "the client's x is right, the device's y";
    const Shape shape = client.around.told.get<Shape>("mesh 0");
    EXPECT_EQ(shape.stiffness, 1000);
    EXPECT_NEAR(shape.friction.static_, 0.4, 1e-6) << "static before dynamic, other than in a plane";
    EXPECT_NEAR(shape.friction.dynamic, 0.2, 1e-6);
    EXPECT_EQ(shape.shading, Shading::flat);
}

TEST(VrpnSession, a_trimesh_moves_without_being_sent_again) {
    FakeClient client;
    tetrahedron(client);
    client.around.told.calls.clear();
    // A quarter turn about y and a shift, row by row.
    client.floats(Type::transform_trimesh, {0, 0, 1, 0.01f, 0, 1, 0, 0.02f, -1, 0, 0, 0.03f, 0, 0, 0, 1}, 0);
    EXPECT_EQ(client.around.told.calls, std::vector<std::string>{"set mesh 0"});
    const Shape shape = client.around.told.get<Shape>("mesh 0");
    expect_near(shape.position, {0.03, 0.01, 0.02});
    EXPECT_NEAR(std::abs(shape.orientation.z), std::sqrt(0.5), 1e-6) << "about what points up";
    EXPECT_NEAR(std::abs(shape.orientation.w), std::sqrt(0.5), 1e-6);
    // The same matrix for row vectors.
    client.floats(Type::transform_trimesh, {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0.01f, 0.02f, 0.03f, 1}, 0);
    expect_near(client.around.told.get<Shape>("mesh 0").position, {0.03, 0.01, 0.02});
}

TEST(VrpnSession, a_trimesh_that_is_stretched_is_another_mesh) {
    FakeClient client;
    tetrahedron(client);
    client.around.told.calls.clear();
    client.floats(Type::object_scale, {2, 1, 1}, 0);
    EXPECT_EQ(client.around.told.calls.front(), "mesh mesh 0");
    EXPECT_NEAR(client.around.told.items.at("mesh 0").mesh->vertices[1][1], 0.2, 1e-7);
    client.floats(Type::object_scale, {-1, 1, 1}, 0);
    const auto& mirrored = *client.around.told.items.at("mesh 0").mesh;
    EXPECT_EQ(mirrored.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2})) << "its outside stays outside";
    client.floats(Type::object_scale, {0, 1, 1}, 0);
    EXPECT_NE(client.text().find("the scale of object 0 is 0"), std::string::npos);
}

TEST(VrpnSession, a_trimesh_is_taken_away_touched_or_not_and_comes_back) {
    FakeClient client;
    tetrahedron(client, 4);
    PayloadWriter out;
    out.put(std::int32_t{4}).put(std::int16_t{0});
    client.say(Type::object_touchable, out);
    EXPECT_TRUE(client.around.told.items.empty());
    out.clear();
    out.put(std::int32_t{4}).put(std::int16_t{1});
    client.say(Type::object_touchable, out);
    EXPECT_TRUE(client.around.told.items.contains("mesh 4"));
    client.numbers(Type::clear_trimesh, {4});
    EXPECT_TRUE(client.around.told.items.empty());
    client.floats(Type::update_trimesh, {0.5f, 0, 0, 0}, 4);
    EXPECT_NE(client.text().find("object 4 has no triangles"), std::string::npos);
}

TEST(VrpnSession, a_triangle_without_its_vertex_leaves_the_mesh_as_it_was) {
    FakeClient client;
    tetrahedron(client);
    client.around.got.clear();
    client.around.told.calls.clear();
    client.numbers(Type::set_triangle, {0, 9, 0, 1, 77, -1, -1, -1});
    client.floats(Type::update_trimesh, {0.5f, 0, 0, 0}, 0);
    EXPECT_NE(client.text().find("triangle 9 of object 0 names vertex 77, which was not set"),
              std::string::npos);
    EXPECT_TRUE(client.around.told.calls.empty());
}

struct Refused {
    std::array<float, 8> values;
    std::int32_t index, recovery;
    const char* why;
};

class VrpnRefusals : public ::testing::TestWithParam<Refused> {};

TEST_P(VrpnRefusals, are_one_line_an_error_and_no_force) {
    FakeClient client;
    client.plane(GetParam().values, GetParam().index, GetParam().recovery);
    EXPECT_TRUE(client.around.told.items.empty());
    const auto got = std::exchange(client.around.got, {});
    ASSERT_EQ(got.size(), 2u);
    EXPECT_EQ(word_at(got[0], 0), 2) << "severity";
    const std::string text = reinterpret_cast<const char*>(got[0].payload.data() + 8);
    EXPECT_NE(text.find(GetParam().why), std::string::npos) << text;
    EXPECT_EQ(got[0].payload.size(), 1032u);
    EXPECT_EQ(word_at(got[1], 0), 0) << "Force_Error: range";
}

INSTANTIATE_TEST_SUITE_P(
    Planes, VrpnRefusals,
    ::testing::Values(Refused{{0, NAN, 0, 0, 1, 0, 0, 0}, 0, 10, "the plane has the value nan"},
                      Refused{{0, INFINITY, 0, 0, 1, 0, 0, 0}, 0, 10, "the value inf"},
                      Refused{{0, 0, 0, 1, 1, 0, 0, 0}, 0, 10, "has no direction"},
                      Refused{{0, 1, 0, 0, -1, 0, 0, 0}, 0, 10, "kspring is -1"},
                      Refused{{0, 1, 0, 0, NAN, 0, 0, 0}, 0, 10, "kspring is nan"},
                      Refused{{0, 1, 0, 0, 1, -1, 0, 0}, 0, 10, "kdamp is -1"},
                      Refused{{0, 1, 0, 0, 1, 0, -1, 0}, 0, 10, "dynamic friction is -1"},
                      Refused{{0, 1, 0, 0, 1, 0, 0, 101}, 0, 10, "static friction is 101"},
                      Refused{{0, 1, 0, 0, 1, 0, 0, 0}, 16, 10, "plane 16 is none"},
                      Refused{{0, 1, 0, 0, 1, 0, 0, 0}, -1, 10, "plane -1 is none"},
                      Refused{{0, 1, 0, 0, 1, 0, 0, 0}, 0, -1, "recovery is -1"}));

TEST(VrpnSession, a_payload_of_a_wrong_length_is_refused) {
    FakeClient client;
    client.floats(Type::plane, {0, 1, 0, 0, 1});
    EXPECT_EQ(client.text(), "vrpn_ForceDevice Plane: its payload has a wrong length");
    EXPECT_TRUE(client.around.told.items.empty());
}

/// Number 0 of the servers of Phantoms: amplitude, frequency, duration, direction.
struct Buzz {
    FakeClient client;
    void send(const std::vector<float>& values, std::uint32_t number = 0) {
        PayloadWriter out;
        out.put(number).put(static_cast<std::uint32_t>(values.size()));
        for (const float value : values) out.put(value);
        client.say(Type::custom_effect, out);
    }
    void report(std::int64_t at) {
        HandReport report;
        report.read_ns = at;
        client.session.report(0, std::span(&report, 1), client.now);
    }
    bool there() const { return client.around.told.items.contains("effect"); }
};

TEST(VrpnSession, the_effect_of_a_phantoms_server_buzzes_for_its_time_along_its_direction) {
    Buzz buzz;
    buzz.send({0.5f, 150, 0.25f, 0, 1, 0});
    const auto felt = buzz.client.around.told.get<Vibration>("effect");
    EXPECT_EQ(felt.amplitude, 0.5);
    EXPECT_EQ(felt.frequency, 150);
    EXPECT_EQ(felt.direction, (Vec3{0, 0, 1})) << "up, in our axes";
    buzz.report(1'000'000'000);
    buzz.report(1'249'000'000);
    EXPECT_TRUE(buzz.there());
    buzz.report(1'250'000'000);
    EXPECT_FALSE(buzz.there());
    buzz.send({0.25f});  // the rest as before
    EXPECT_EQ(buzz.client.around.told.get<Vibration>("effect").frequency, 150);
    EXPECT_EQ(buzz.client.around.told.get<Vibration>("effect").amplitude, 0.25);
    buzz.report(2'000'000'000);
    EXPECT_TRUE(buzz.there());
    buzz.send({}, static_cast<std::uint32_t>(-1));
    EXPECT_FALSE(buzz.there()) << "as stopEffect() sends it";
}

TEST(VrpnSession, an_effect_that_makes_no_sense_is_refused_and_changes_nothing) {
    Buzz buzz;
    buzz.send({NAN});
    EXPECT_NE(buzz.client.text().find("the effect's amplitude is nan"), std::string::npos);
    buzz.send({1, -1});
    EXPECT_NE(buzz.client.text().find("the effect's frequency is -1"), std::string::npos);
    buzz.send({1, 100, 1e7f});
    EXPECT_NE(buzz.client.text().find("the effect's duration is"), std::string::npos);
    buzz.send({1, 100, 1, 0, 0, 0});
    EXPECT_NE(buzz.client.text().find("the effect's direction is 0, 0, 0"), std::string::npos);
    buzz.client.numbers(Type::custom_effect, {0, 1'000'000'000});
    EXPECT_NE(buzz.client.text().find("its payload has a wrong length"), std::string::npos);
    EXPECT_FALSE(buzz.there());
}

TEST(VrpnSession, a_client_that_may_not_command_is_told_why_and_makes_no_hand) {
    FakeClient client;
    client.around.refuse_hold = "no force for you";
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    EXPECT_FALSE(client.around.told.alive);
    const auto got = std::exchange(client.around.got, {});
    ASSERT_EQ(got.size(), 2u);
    EXPECT_EQ(word_at(got[0], 0), 2) << "severity";
    EXPECT_EQ(word_at(got[1], 0), 3) << "Force_Error: other";
    for (int i = 0; i < 1000; ++i) client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    EXPECT_TRUE(client.around.got.empty()) << "it is said once";
    client.around.refuse_hold.clear();
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    EXPECT_TRUE(client.around.told.items.contains("plane 0"));
}

TEST(VrpnSession, what_only_lets_go_claims_nothing) {
    FakeClient client;
    client.plane({0, 0, 0, 0, 1, 0, 0, 0});
    client.floats(Type::force_field, std::vector<float>(16));
    client.numbers(Type::constraint_enable, {0});
    EXPECT_EQ(client.around.holds, 0);
}

TEST(VrpnSession, a_datagram_that_was_overtaken_is_dropped) {
    FakeClient client;
    client.sequence = 0xfffffffe;  // it wraps round
    for (const float d : {0.01f, 0.02f, 0.03f}) client.plane({0, 1, 0, d, 1, 0, 0, 0});
    EXPECT_NEAR(client.around.told.get<Plane>("plane 0").offset, -0.03, 1e-8);
    client.sequence = 0;
    client.plane({0, 1, 0, 0.04f, 1, 0, 0, 0});
    EXPECT_NEAR(client.around.told.get<Plane>("plane 0").offset, -0.03, 1e-8) << "0 was there already";
}

TEST(VrpnSession, a_datagram_that_is_older_than_a_stop_by_tcp_is_dropped) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    client.stamp += 1000;
    client.plane({0, 0, 0, 0, 1, 0, 0, 0}, 0, 10, Service::reliable);
    ASSERT_TRUE(client.around.told.items.empty());
    client.stamp -= 500;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    EXPECT_TRUE(client.around.told.items.empty());
    client.stamp += 2000;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    EXPECT_EQ(client.around.told.items.size(), 1u);
}

TEST(VrpnSession, ids_and_names_are_bounded_and_a_liar_is_dropped) {
    FakeClient client;
    PayloadWriter name;
    put_name(name, "x");
    EXPECT_EQ(client.system(system_type::sender, 1999, name.bytes()), "");
    for (const std::int32_t id : {-1, 2000, 0x7fffffff})
        EXPECT_NE(client.system(system_type::type, id, name.bytes()), "") << id;
    PayloadWriter liar;
    liar.put(std::int32_t{0x7fffffff}).put(std::int32_t{0});
    EXPECT_EQ(client.system(system_type::sender, 5, liar.bytes()),
              "the name of its sender 5 has a wrong length");
}

TEST(VrpnSession, a_sender_that_is_not_there_is_said_with_those_that_are) {
    FakeClient client;
    PayloadWriter name;
    put_name(name, "Tracker0");
    EXPECT_EQ(client.system(system_type::sender, 5, name.bytes()), "");
    ASSERT_EQ(client.around.lines.size(), 1u);
    EXPECT_EQ(client.around.lines[0], "it asks for 'Tracker0'; this server has Phantom0");
}

TEST(VrpnSession, datagrams_go_to_a_port_above_1023) {
    FakeClient client;
    PayloadWriter address;
    address.put_text("10.9.8.7", 9);
    EXPECT_EQ(client.system(system_type::udp, 5000, address.bytes()), "");
    EXPECT_EQ(client.around.datagrams_to, 5000) << "whatever address it writes";
    EXPECT_NE(client.system(system_type::udp, 53, address.bytes()), "");
    EXPECT_EQ(client.around.datagrams_to, 5000);
}

TEST(VrpnSession, its_claim_is_renewed_while_it_is_connected) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    const int before = client.around.told.sent;
    for (int i = 0; i < 40; ++i) {
        client.now += 25ms;
        client.session.tick(client.now);
    }
    EXPECT_GE(client.around.told.sent, before + 9) << "a second, every 80 ms, looked at every 25 ms";
}

TEST(VrpnSession, a_client_that_must_speak_and_does_not_is_not_renewed) {
    SessionOptions options;
    options.silent_after = 300ms;
    FakeClient client(options);
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    for (int i = 0; i < 12; ++i) client.session.tick(client.now += 25ms);
    const int renewed = client.around.told.sent;
    for (int i = 0; i < 40; ++i) client.session.tick(client.now += 25ms);
    EXPECT_EQ(client.around.told.sent, renewed);
    client.say(Type::ping);
    for (int i = 0; i < 8; ++i) client.session.tick(client.now += 25ms);
    EXPECT_GT(client.around.told.sent, renewed);
}

TEST(VrpnSession, what_the_hand_says_is_told_and_so_is_its_end) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    client.around.got.clear();
    client.around.told.to_say = {{gateway::Said::Level::error, "fault", "device 'right' is in fault"}};
    client.session.tick(client.now += 25ms);
    auto got = std::exchange(client.around.got, {});
    ASSERT_EQ(got.size(), 2u);
    EXPECT_STREQ(reinterpret_cast<const char*>(got[0].payload.data() + 8), "device 'right' is in fault");
    EXPECT_EQ(word_at(got[1], 0), 2) << "Force_Error: device";
    client.around.told.status.armed = true;
    client.session.tick(client.now += 25ms);
    EXPECT_EQ(word_at(client.around.take(Type::force_error).at(0), 0), 4) << "all is well again";
}

TEST(VrpnSession, its_end_lets_go) {
    FakeClient client;
    client.plane({0, 1, 0, 0, 1, 0, 0, 0});
    EXPECT_TRUE(client.around.told.alive);
    client.owned.reset();
    EXPECT_FALSE(client.around.told.alive);
}

TEST(VrpnSession, planes_and_meshes_are_bounded) {
    FakeClient client;
    for (std::int32_t i = 0; i < 40; ++i) {
        PayloadWriter out;
        out.put(i).put(0).put(0.f).put(0.f).put(0.f);
        client.say(Type::set_vertex, out);
    }
    EXPECT_NE(client.text().find("one more than the 32"), std::string::npos);
}

}  // namespace
