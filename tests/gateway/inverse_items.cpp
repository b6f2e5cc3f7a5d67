// Representations behind the key `knurl`: read by the tables of fields, turned into the device's axes by what they mean.

#include "inverse_items.hpp"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include <knurl/gateway/frames.hpp>
#include <knurl/reps/all.hpp>

#include "inverse_fakes.hpp"
#include "params_text.hpp"

namespace {

using namespace inverse_test;

class InverseItems : public ::testing::Test {
  protected:
    void SetUp() override {
        fake.start();
        fake.socket.sent.clear();
    }
    /// What is complained about; empty: nothing.
    std::string say(const std::string& knurl) {
        fake.now += std::chrono::minutes(1);
        fake.session->text(R"({"inverse3":[{"device_id":"049D","commands":{"knurl":)" + knurl + "}}]}");
        const Json answer = fake.socket.answer();
        return answer.contains("knurl") ? answer["knurl"]["said"][0].get<std::string>() : "";
    }
    void basis(const std::string& permutation) {
        fake.session->text(R"({"session":{"configure":{"basis":{"permutation":")" + permutation + "\"}}}}");
        fake.socket.sent.clear();
    }
    template <class R>
    R told(const std::string& name) {
        const auto& [kind, params] = fake.told.items.at(name);
        EXPECT_EQ(kind, kind_of<R>);
        R made;
        std::memcpy(&made, params.data(), sizeof made);
        return made;
    }
    FakeService fake;
};

TEST_F(InverseItems, a_plane_takes_three_words_more) {
    EXPECT_EQ(say(R"({"add":{"id":"floor","kind":"plane","normal":[0,0,1],"offset":0.0,"stiffness":800}})"),
              "");
    const Plane floor = told<Plane>("floor");
    EXPECT_EQ(floor.normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(floor.stiffness, 800);
    EXPECT_EQ(say(R"({"add":[{"id":"back","kind":"plane","normal":[0,-1,0],"offset":-0.1,"stiffness":"inf",
                     "friction":{"dynamic":0.03}, "material":"ice", "on_silence":"hold"}]})"),
              "");
    const Plane back = told<Plane>("back");
    EXPECT_EQ(back.normal, (Vec3{1, 0, 0})) << "towards the user: Haply's -y, our x";
    EXPECT_EQ(back.offset, -0.1);
    EXPECT_EQ(back.stiffness, std::numeric_limits<double>::infinity());
}

TEST_F(InverseItems, a_change_inherits_what_it_does_not_state_and_a_removal_ends_it) {
    say(R"({"add":{"id":"floor","kind":"plane","normal":[0,1,0],"offset":0.01,"stiffness":800}})");
    EXPECT_EQ(say(R"({"set":{"id":"floor","offset":0.02}})"), "");
    EXPECT_EQ(told<Plane>("floor").offset, 0.02);
    EXPECT_EQ(told<Plane>("floor").stiffness, 800);
    EXPECT_EQ(told<Plane>("floor").normal, (Vec3{-1, 0, 0}));
    EXPECT_EQ(say(R"({"set":{"id":"floor","stiffness":-1}})").find("plane 'floor'") == std::string::npos,
              false);
    EXPECT_EQ(told<Plane>("floor").stiffness, 800) << "applied whole or not at all";
    EXPECT_EQ(say(R"({"remove":"floor"})"), "");
    EXPECT_TRUE(fake.told.items.empty());
    EXPECT_EQ(say(R"({"remove":["floor"]})"), "there is no representation 'floor' to remove");
    EXPECT_EQ(say(R"({"set":{"id":"floor","offset":1}})"),
              "there is no representation 'floor' to set; add it first");
}

TEST_F(InverseItems, mistakes_are_one_line_that_says_what_to_do) {
    EXPECT_EQ(say(R"({"add":{"id":"f","kind":"plan"}})"),
              "there is no representation 'plan'; did you mean 'plane'?");
    EXPECT_EQ(say(R"({"add":{"id":"f","kind":"plane","stifness":1}})"),
              "unknown key 'stifness' in plane 'f'; did you mean 'stiffness'?");
    EXPECT_EQ(say(R"({"add":{"kind":"plane"}})"),
              "a representation needs an id, by which it is changed later; write \"id\": \"floor\"");
    EXPECT_EQ(say(R"({"add":{"id":"f"}})"), "knurl.add needs a kind; write \"kind\": \"plane\"");
    EXPECT_NE(say(R"({"add":{"id":"f","kind":"plane","normal":[0,0,0]}})").find("normal"), std::string::npos);
    EXPECT_NE(say(R"({"add":{"id":"f","kind":"plane","normal":null}})").find("null"), std::string::npos);
    EXPECT_NE(
        say(R"({"add":{"id":"f","kind":"plane","normal":[0,0,1],"offset":"x"}})").find("must be a number"),
        std::string::npos);
    EXPECT_NE(say(R"({"add":{"id":"f","kind":"shape","asset":1}})").find("needs a mesh"), std::string::npos);
    EXPECT_NE(say(R"({"add":7})").find("is an object"), std::string::npos);
    EXPECT_NE(say("7").find("knurl must be an object"), std::string::npos);
    EXPECT_TRUE(fake.told.items.empty());
}

TEST_F(InverseItems, a_transform_does_not_move_them_and_that_is_said) {
    fake.session->text(
        R"({"inverse3":[{"device_id":"049D","commands":{"set_transform":{"position":{"x":1,"y":0,"z":0}}}}]})");
    fake.socket.sent.clear();
    EXPECT_NE(say(R"({"add":{"id":"f","kind":"plane"}})").find("set_transform does not move them"),
              std::string::npos);
    EXPECT_EQ(fake.told.items.size(), 1u);
}

TEST_F(InverseItems, the_basis_of_the_session_holds_for_them) {
    basis("XZY");  // mirrored: x right, y up, z away from the user
    say(R"({"add":[{"id":"floor","kind":"plane","normal":[0,1,0],"offset":0.03},
                   {"id":"box","kind":"box","center":[1,2,3],"half_size":[0.1,0.2,0.3]},
                   {"id":"twist","kind":"constant_force","force":[0,0,1],"torque":[0,1,0]},
                   {"id":"piece","kind":"polygon","vertices":[[0,0,0],[1,0,0],[0,0,1]]}]})");
    EXPECT_EQ(told<Plane>("floor").normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(told<Plane>("floor").offset, 0.03);
    EXPECT_EQ(told<Box>("box").center, (Vec3{-3, 1, 2}));
    EXPECT_EQ(told<Box>("box").half_size, (Vec3{0.3, 0.1, 0.2}));
    EXPECT_EQ(told<ConstantForce>("twist").force, (Vec3{-1, 0, 0}));
    EXPECT_EQ(told<ConstantForce>("twist").torque, (Vec3{0, 0, -1})) << "a mirror turns rotations round";
    const Polygon piece = told<Polygon>("piece");
    const Vec3* const corner = piece.vertices.at;
    const Eigen::Vector3d a = to_eigen(corner[0]), b = to_eigen(corner[1]), c = to_eigen(corner[2]);
    // From the middle to the right to the far end: counter-clockwise for who looks down on it.
    EXPECT_GT((b - a).cross(c - a).z(), 0);
}

/// The independent reference: a force field of one kind, evaluated at a point in the device's axes, must be what the same
/// numbers give in the client's axes at the mapped point.
TEST_F(InverseItems, an_effect_feels_the_same_from_both_axes) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    for (const char* permutation : {"XYZ", "XZY", "-YZX", "ZXY", "X-YZ", "-Z-Y-X"}) {
        const Axes client = frames::haply.then(Axes::parse(permutation).value());
        Taylor field{.origin = {number(), number(), number()}, .force = {number(), number(), number()}};
        for (double& each : field.jacobian.at) each = 10 * number();
        std::vector<std::byte> params(sizeof field);
        std::memcpy(params.data(), &field, sizeof field);
        Taylor device;
        const auto turned = in_axes(client.back(), kind_of<Taylor>, params);
        std::memcpy(&device, turned.data(), sizeof device);
        const Vec3 point{number(), number(), number()};
        const auto force = [](const Taylor& f, const Vec3& p) {
            return Eigen::Vector3d(to_eigen(f.force) +
                                   to_eigen(f.jacobian) * (to_eigen(p) - to_eigen(f.origin)));
        };
        const Eigen::Vector3d here = force(device, point);
        const Eigen::Vector3d there = force(field, client.position(point));
        EXPECT_LT((to_eigen(client.direction(to_plain(here))) - there).norm(), 1e-12) << permutation;
    }
}

TEST_F(InverseItems, there_and_back_every_kind_is_what_it_was) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    for (Kind kind = 0; kind < kinds().size(); ++kind) {
        const KindInfo& info = kinds()[kind];
        std::vector<std::byte> params(info.size);
        for (const Field& field : info.fields) {
            for (std::size_t i = 0; i < field.reals(); ++i) {
                const double value = std::uniform_real_distribution<double>(0.1, 1)(random);
                std::memcpy(params.data() + field.offset + i * sizeof value, &value, sizeof value);
            }
            if (field.type == Field::Type::points) {
                const std::uint32_t used = 3;
                std::memcpy(params.data() + field.offset + field.reals() * sizeof(double), &used,
                            sizeof used);
            }
        }
        for (const char* permutation : {"XYZ", "XZY", "-YZX"}) {
            const Axes client = frames::haply.then(Axes::parse(permutation).value());
            const auto there = in_axes(client, kind, params);
            EXPECT_EQ(in_axes(client.back(), kind, there), params) << info.name << " " << permutation;
        }
    }
}

TEST(InverseToml, texts_of_a_client_cannot_leave_their_quotes) {
    Json table = Json::object();
    table["id"] = "a\"\n[[plane]]\\";
    table["x\ny"] = Json::array({1.5, true, "inf"});
    EXPECT_EQ(toml_of(table), "\"id\"=\"a\\\"\\u000A[[plane]]\\\\\"\n\"x\\u000Ay\"=[1.5,true,inf,]\n");
}

}  // namespace
