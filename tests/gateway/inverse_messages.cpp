// The simulation channel: what a client is answered, and what the hand is told.

#include <cstring>

#include <gtest/gtest.h>

#include <knurl/gateway/frames.hpp>

#include "inverse_fakes.hpp"

namespace {

using namespace inverse_test;
using namespace std::chrono_literals;

class InverseMessages : public ::testing::Test {
  protected:
    void SetUp() override {
        fake.start();
        inventory = fake.socket.answer();
        fake.listener.sent.clear();
        fake.log.clear();
    }
    Json say(const std::string& message) {
        fake.session->text(message);
        return fake.socket.answer();
    }
    Json command(const std::string& commands) {
        return say(R"({"inverse3":[{"device_id":"049D","commands":{)" + commands + "}}]}");
    }
    /// What was complained about, in the answer.
    static std::string complaint(const Json& answer) {
        if (!answer.contains("knurl") || !answer.at("knurl").contains("said")) return "";
        std::string all;
        for (const Json& line : answer["knurl"]["said"])
            all += (all.empty() ? "" : " | ") + line.get<std::string>();
        return all;
    }

    FakeService fake;
    Json inventory;
};

Vec3 vector(const Json& json) {
    return {json["x"], json["y"], json["z"]};
}

TEST_F(InverseMessages, a_client_gets_the_inventory_at_once_and_each_device_twice) {
    ASSERT_EQ(inventory["inverse3"].size(), 1u);
    const Json& device = inventory["inverse3"][0];
    EXPECT_EQ(device["device_id"], "049D");
    EXPECT_EQ(device["config"]["type"], "inverse3");
    EXPECT_EQ(device["config"]["handedness"], "right");
    EXPECT_EQ(device["config"]["basis"]["permutation"], "XYZ");
    EXPECT_EQ(device["config"]["gravity_compensation"]["enabled"], false);
    EXPECT_EQ(device["config"]["knurl"]["name"], "right");
    EXPECT_EQ(device["config"]["knurl"]["max_stiffness"], 2000);
    EXPECT_EQ(device["config"]["knurl"]["rate"], 1000);
    EXPECT_EQ(device["config"]["knurl"]["lapse"], 0.1);
    EXPECT_EQ(device["status"]["ready"], true);
    EXPECT_EQ(device["status"]["in_use"], true);
    EXPECT_EQ(device["status"]["knurl"]["state"], "active");
    EXPECT_EQ(inventory["verse_grip"].size(), 0u);
    ASSERT_EQ(inventory["wireless_verse_grip"].size(), 1u);
    EXPECT_EQ(inventory["wireless_verse_grip"][0]["device_id"], "F49D");
    EXPECT_EQ(inventory["wireless_verse_grip"][0]["status"]["connected"], true);
    EXPECT_EQ(inventory["session_id"], 1);
}

TEST_F(InverseMessages, the_state_is_in_haplys_axes_and_degrees) {
    const Json answer = command(R"("probe_position":{})");
    const Json& device = answer["inverse3"][0];
    EXPECT_FALSE(device.contains("config")) << "later messages have state and status alone";
    EXPECT_EQ(vector(device["state"]["cursor_position"]), (Vec3{0.1, -0.2, 0.05}));
    EXPECT_EQ(vector(device["state"]["cursor_velocity"]), (Vec3{2, -1, 3}));
    EXPECT_EQ(vector(device["state"]["current_cursor_force"]), (Vec3{5, -4, 6}));
    EXPECT_NEAR(device["state"]["angular_position"]["a1"].get<double>(), 114.591559, 1e-6);
    EXPECT_EQ(device["state"]["control_mode"], "idle");
    const Json& grip = answer["wireless_verse_grip"][0];
    EXPECT_EQ(grip["state"]["orientation"]["w"], 0.5);
    EXPECT_EQ(grip["state"]["orientation"]["x"], 0.5);
    EXPECT_EQ(grip["state"]["orientation"]["y"], -0.5);
    EXPECT_EQ(grip["state"]["orientation"]["z"], 0.5);
    const Json& buttons = grip["state"]["buttons"];
    EXPECT_EQ(buttons["a"], false);
    EXPECT_EQ(buttons["b"], true);
    EXPECT_EQ(buttons["c"], false);
    EXPECT_EQ(buttons["button_1"], true);
    EXPECT_EQ(buttons["button_3"], true);
}

TEST_F(InverseMessages, there_is_one_answer_to_each_message_and_none_unasked) {
    for (const char* message : {"{}", R"({"inverse3":[]})", "no json", "[]", "7", R"({"inverse3":7})",
                                R"({"inverse3":[7,8,{}]})", ""}) {
        fake.session->text(message);
        EXPECT_EQ(fake.socket.sent.size(), 1u) << message;
        fake.socket.sent.clear();
    }
    fake.session->binary({});
    EXPECT_EQ(fake.socket.sent.size(), 1u);
    fake.socket.sent.clear();
    for (int i = 0; i < 100; ++i) fake.session->tick(fake.now);
    EXPECT_TRUE(fake.socket.sent.empty());
    EXPECT_EQ(fake.socket.closed, 0) << "nothing that is wrong ends a connection";
}

TEST_F(InverseMessages, a_force_is_taken_in_both_spellings_and_turned_into_the_devices_frame) {
    EXPECT_EQ(complaint(command(R"("set_cursor_force":{"vector":{"x":1,"y":2,"z":3}})")), "");
    command(R"("set_cursor_force":{"values":{"x":-1,"y":0,"z":0.5}})");
    ASSERT_EQ(fake.told.pushes.size(), 2u);
    EXPECT_EQ(fake.told.pushes[0], (Vec3{-2, 1, 3})) << "right is our y, away from the user our -x";
    EXPECT_EQ(fake.told.pushes[1], (Vec3{0, -1, 0.5}));
    EXPECT_EQ(fake.told.sent, 2) << "each message takes effect as a whole";
    EXPECT_EQ(fake.told.options.device, "right");
    EXPECT_EQ(fake.told.options.peer, "inverse 127.0.0.1:40312");
    EXPECT_TRUE(fake.told.options.may_arm);
}

TEST_F(InverseMessages, the_control_mode_is_that_of_the_last_command_until_it_lapses) {
    EXPECT_EQ(
        command(
            R"("set_cursor_force":{"vector":{"x":1,"y":0,"z":0}})")["inverse3"][0]["state"]["control_mode"],
        "force");
    EXPECT_EQ(
        command(R"("set_cursor_position":{"position":{"x":1,"y":0,"z":0}})")["inverse3"][0]["state"]["mode"],
        "position");
    EXPECT_EQ(fake.told.targets.at(0), (Vec3{0, 1, 0}));
    fake.now += 100ms;
    EXPECT_EQ(say("{}")["inverse3"][0]["state"]["mode"], "idle");
}

TEST_F(InverseMessages, a_basis_holds_for_all_that_is_said_and_answered) {
    const Json answer = say(R"({"session":{"configure":{"basis":{"permutation":"XZY"}}}})");
    EXPECT_EQ(vector(answer["inverse3"][0]["state"]["cursor_position"]), (Vec3{0.1, 0.05, -0.2}))
        << "their y is up";
    command(R"("set_cursor_force":{"vector":{"x":0,"y":9,"z":0}})");
    EXPECT_EQ(fake.told.pushes.at(0), (Vec3{0, 0, 9}));
    const Json full = say(R"({"session":{"force_render_full_state":{}}})");
    EXPECT_EQ(full["inverse3"][0]["config"]["basis"]["permutation"], "XZY");
    const Json wrong = say(R"({"session":{"configure":{"basis":{"permutation":"XXY"}}}})");
    EXPECT_NE(complaint(wrong).find("must name each of X, Y, Z once"), std::string::npos) << complaint(wrong);
    EXPECT_EQ(vector(wrong["inverse3"][0]["state"]["cursor_position"]), (Vec3{0.1, 0.05, -0.2}))
        << "it stays";
}

TEST_F(InverseMessages, a_transform_is_kept_and_undone_for_what_comes_back) {
    // A quarter turn about z and twice as large: application = (1, 0, 0) + Rz(90 deg) (2 device).
    const Json answer = command(
        R"("set_transform":{"transform":{"position":{"x":1,"y":0,"z":0},"rotation":{"w":1,"x":0,"y":0,"z":1},"scale":{"x":2,"y":2,"z":2}}})");
    EXPECT_EQ(complaint(answer), "");
    const Vec3 seen = vector(answer["inverse3"][0]["state"]["cursor_position"]);
    EXPECT_NEAR(seen.x, 1.4, 1e-12);
    EXPECT_NEAR(seen.y, 0.2, 1e-12);
    EXPECT_NEAR(seen.z, 0.1, 1e-12);
    command(R"("set_cursor_position":{"position":{"x":1.4,"y":0.2,"z":0.1}})");
    const Vec3 target = fake.told.targets.at(0);
    EXPECT_NEAR(target.x, 0.2, 1e-12) << "where the hand is";
    EXPECT_NEAR(target.y, 0.1, 1e-12);
    EXPECT_NEAR(target.z, 0.05, 1e-12);
    command(R"("set_cursor_force":{"vector":{"x":0,"y":3,"z":0}})");
    EXPECT_NEAR(fake.told.pushes.at(0).y, 3, 1e-12)
        << "their y is Haply's x after the turn; no force is scaled";
    EXPECT_NE(complaint(command(R"("set_transform":{"scale":{"x":0,"y":1,"z":1}})"))
                  .find("set_transform.scale is 0"),
              std::string::npos);
    EXPECT_NE(
        complaint(command(R"("set_transform":{"rotation":{"w":0,"x":0,"y":0,"z":0}})")).find("has no length"),
        std::string::npos);
    EXPECT_NEAR(vector(say("{}")["inverse3"][0]["state"]["cursor_position"]).x, 1.4, 1e-12) << "it stays";
}

TEST_F(InverseMessages, what_is_not_supported_is_said) {
    EXPECT_NE(complaint(command(R"("set_angular_torques":{"torques":{"a0":1,"a1":0,"a2":0}})"))
                  .find("not supported"),
              std::string::npos);
    EXPECT_NE(complaint(command(R"("set_angular_position":{"angles":{"a0":1,"a1":0,"a2":0}})"))
                  .find("not supported"),
              std::string::npos);
    ASSERT_EQ(fake.listener.sent.size(), 2u);
    const Json event = Json::parse(fake.listener.sent[0]);
    EXPECT_EQ(event["name"], "command-refused");
    EXPECT_EQ(event["category"], "device");
    EXPECT_EQ(event["level"], "warning");
    EXPECT_EQ(event["data"]["device_id"], "049D");
    EXPECT_EQ(fake.log.size(), 2u);
}

TEST_F(InverseMessages, wrong_values_are_one_line_each) {
    const auto said = [&](const char* commands) { return complaint(command(commands)); };
    EXPECT_EQ(said(R"("set_cursor_force":{})"), "set_cursor_force needs vector");
    EXPECT_EQ(said(R"("set_cursor_force":7)"), "set_cursor_force must be an object");
    EXPECT_EQ(said(R"("set_cursor_force":{"vector":[1,2,3]})"),
              "set_cursor_force.vector must be an object; write {\"x\": 0, \"y\": 0, \"z\": 0}");
    EXPECT_EQ(said(R"("set_cursor_force":{"vector":{"x":1,"y":2}})"), "set_cursor_force.vector.z is missing");
    EXPECT_EQ(said(R"("set_cursor_force":{"values":{"x":1,"y":2,"z":"3"}})"),
              "set_cursor_force.values.z must be a number");
    fake.told.refuse = ".x is too large";
    EXPECT_EQ(said(R"("set_cursor_force":{"vector":{"x":1,"y":2,"z":3}})"),
              "set_cursor_force.vector.x is too large");
    EXPECT_TRUE(fake.told.pushes.empty());
    EXPECT_EQ(complaint(say(R"({"inverse3":[{"device_id":"FFFF"}]})")),
              "there is no inverse3 \"FFFF\"; there are 049D");
    EXPECT_NE(complaint(say(std::string(300'000, ' '))).find("send at most"), std::string::npos);
    EXPECT_NE(complaint(say(std::string(1000, '[') + std::string(1000, ']'))).find("nests deeper"),
              std::string::npos);
}

TEST_F(InverseMessages, text_that_is_no_json_is_told_where) {
    EXPECT_TRUE(complaint(say("{\"inverse3\":x}"))
                    .starts_with("a message is no JSON: parse error at line 1, column 13"));
}

TEST_F(InverseMessages, a_client_that_is_wrong_all_the_time_is_told_so_seldom) {
    for (int i = 0; i < 1000; ++i) {
        command(R"("set_cursor_force":{})");
        fake.now += 5ms;  // five seconds in all
    }
    EXPECT_EQ(fake.log.size(), 1u);
    for (int i = 0; i < 1000; ++i) say("{\"k" + std::to_string(i) + "\":1}");
    EXPECT_LE(fake.log.size(), 11u);
    fake.now += 10s;
    const std::string again = complaint(command(R"("set_cursor_force":{})"));
    EXPECT_TRUE(again.starts_with("set_cursor_force needs vector (and ")) << again;
}

TEST_F(InverseMessages, unknown_keys_are_counted_and_said_once) {
    const std::string message =
        R"({"glove":1,"inverse3":[{"device_id":"049D","commands":{"set_mood":{}},"x":1}]})";
    const std::string first = complaint(say(message));
    for (const char* key : {"glove", "inverse3.commands.set_mood", "inverse3.x"})
        EXPECT_NE(first.find(std::string(key) + " is not known here"), std::string::npos) << first;
    EXPECT_EQ(complaint(say(message)), "");
    EXPECT_EQ(fake.listener.sent.size(), 3u);
    const Json full = say(R"({"session":{"force_render_full_state":{}}})");
    EXPECT_EQ(full["knurl"]["unknown_keys"]["glove"], 2);
}

TEST_F(InverseMessages, who_may_only_look_looks) {
    fake.socket.as = Role::observe;
    EXPECT_NE(
        complaint(command(R"("set_cursor_force":{"vector":{"x":1,"y":2,"z":3}})")).find("may look only"),
        std::string::npos);
    EXPECT_FALSE(fake.told.alive);
    EXPECT_EQ(complaint(command(R"("probe_position":{})")), "");
    fake.socket.as = Role::render;
    command(R"("set_cursor_force":{"vector":{"x":1,"y":2,"z":3}})");
    EXPECT_TRUE(fake.told.alive);
    EXPECT_FALSE(fake.told.options.may_arm);
}

TEST_F(InverseMessages, the_end_of_the_connection_ends_the_hold) {
    command(R"("set_cursor_force":{"vector":{"x":1,"y":2,"z":3}})");
    EXPECT_TRUE(fake.told.alive);
    fake.session.reset();
    EXPECT_FALSE(fake.told.alive);
}

TEST_F(InverseMessages, what_the_hand_says_is_an_event) {
    command(R"("set_cursor_force":{"vector":{"x":1,"y":2,"z":3}})");
    fake.told.to_say = {{Said::Level::warning, "claim", "device 'right' is held by process 7"}};
    fake.session->tick(fake.now);
    ASSERT_EQ(fake.listener.sent.size(), 1u);
    EXPECT_EQ(Json::parse(fake.listener.sent[0])["name"], "device-busy");
    EXPECT_EQ(complaint(say("{}")), "device 'right' is held by process 7") << "and in the next answer";
}

TEST_F(InverseMessages, a_fault_and_a_lost_servo_are_events) {
    fake.source->list[0].report->state = DeviceState::fault;
    fake.source->list[0].report->faults = fault::speed;
    const Json answer = say("{}");
    EXPECT_EQ(answer["inverse3"][0]["status"]["ready"], false);
    EXPECT_EQ(answer["inverse3"][0]["status"]["knurl"]["faults"], Json::array({"speed"}));
    fake.source->list[0].connected = false;
    const Json gone = say("{}");
    EXPECT_EQ(gone["inverse3"][0]["status"]["started"], false);
    EXPECT_EQ(gone["wireless_verse_grip"][0]["status"]["connected"], false);
    ASSERT_EQ(fake.listener.sent.size(), 2u);
    const Json event = Json::parse(fake.listener.sent[0]);
    EXPECT_EQ(event["name"], "device-safety-triggered");
    EXPECT_EQ(event["level"], "error");
    EXPECT_EQ(event["data"]["faults"], "speed");
    EXPECT_EQ(Json::parse(fake.listener.sent[1])["name"], "device-disconnected");
}

TEST(InverseClaimable, a_device_that_is_not_named_can_be_read_alone) {
    FakeService fake;
    fake.adjust.claimable = std::vector<std::string>{"left"};
    fake.start();
    EXPECT_EQ(fake.socket.answer()["inverse3"][0]["config"]["knurl"]["claimable"], false);
    fake.session->text(
        R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"vector":{"x":1,"y":0,"z":0}}}}]})");
    EXPECT_NE(fake.socket.answer()["knurl"]["said"][0].get<std::string>().find(
                  "'right' can be read here, not moved"),
              std::string::npos);
    EXPECT_FALSE(fake.told.alive);
}

TEST(InverseClaimable, motors_that_nobody_has_named_stay_still) {
    FakeService fake;
    fake.source->list[0].info.address = "falcon:";
    fake.start();
    EXPECT_EQ(fake.socket.answer()["inverse3"][0]["config"]["knurl"]["claimable"], false);
    FakeService named;
    named.source->list[0].info.address = "falcon:";
    named.adjust.claimable = std::vector<std::string>{"right"};
    named.start();
    EXPECT_EQ(named.socket.answer()["inverse3"][0]["config"]["knurl"]["claimable"], true);
}

TEST(InverseWithoutServo, a_client_gets_empty_lists) {
    FakeService fake;
    fake.source->list.clear();
    fake.source->why = "no servo 'default'";
    fake.start();
    const Json inventory = fake.socket.answer();
    EXPECT_EQ(inventory["inverse3"].size(), 0u);
    EXPECT_EQ(inventory["wireless_verse_grip"].size(), 0u);
}

}  // namespace
