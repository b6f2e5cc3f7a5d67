// The Inverse Service against a real servo: what a client commands reaches the motors, and does not outlive it.

#include <gtest/gtest.h>

#include "../client/servo_process.hpp"
#include "inverse_fakes.hpp"

namespace {

using namespace inverse_test;
using namespace client_test;

class InverseServo : public ::testing::Test {
  protected:
    InverseServo() { open(); }
    void open() {
        session.reset();
        socket.sent.clear();
        session = service.simulation(socket, "");
        id = socket.answer().at("inverse3").at(0).at("device_id").get<std::string>();
    }
    Json command(const std::string& commands) {
        session->text(R"({"inverse3":[{"device_id":")" + id + R"(","commands":{)" + commands + "}}]}");
        return socket.answer();
    }
    template <class Wanted>
    bool until(const std::string& commands, Wanted wanted) {
        return eventually([&] { return wanted(command(commands)["inverse3"][0]); });
    }

    static Inverse make() {
        // The servo may still be starting; the service tries once a second, a test at once.
        connect();
        return make_inverse({});
    }

    ServoProcess servo{{"--device", "right=sim:cartesian3"}};
    Inverse service = make();
    FakeSocket socket;
    std::unique_ptr<SocketHandler> session;
    std::string id;
};

TEST_F(InverseServo, a_force_loop_is_felt_and_does_not_outlive_its_connection) {
    const auto force = [](double x) {
        return R"("set_cursor_force":{"vector":{"x":)" + std::to_string(x) + R"(,"y":0,"z":0}})";
    };
    EXPECT_TRUE(until(force(0.25), [](const Json& device) {
        return std::abs(device["state"]["current_cursor_force"]["x"].get<double>() - 0.25) < 1e-9 &&
               device["status"]["knurl"]["state"] == "active";
    }));
    EXPECT_EQ(command("")["inverse3"][0]["status"]["knurl"]["armed"], true);
    EXPECT_NEAR(connect().observe().newest(10s)->sent_force.y, 0.25, 1e-9) << "their right is our y";
    session.reset();
    Client client = connect();
    claim_when_free(client);
}

TEST_F(InverseServo, a_client_that_hangs_has_its_force_taken_away) {
    Client client = connect();
    Observer observer = client.observe();
    EXPECT_TRUE(until(R"("set_cursor_force":{"values":{"x":0.25,"y":0,"z":0}})",
                      [](const Json& device) { return device["status"]["knurl"]["state"] == "active"; }));
    EXPECT_TRUE(eventually([&] { return observer.latest()->sent_force == Vec3{}; }));
    EXPECT_EQ(command("")["inverse3"][0]["state"]["control_mode"], "idle");
}

TEST_F(InverseServo, a_plane_takes_three_words_more_and_is_rendered_by_the_servo) {
    const double z = connect().observe().newest(10s)->position.z;
    const std::string height = std::to_string(z + 0.004);
    const Json added = command(R"("knurl":{"add":{"id":"floor","kind":"plane","normal":[0,0,1],"offset":)" +
                               height + R"(,"stiffness":200,"recovery":0}})");
    EXPECT_FALSE(added.contains("knurl")) << added;
    EXPECT_TRUE(until(R"("probe_position":{})", [](const Json& device) {
        return device["state"]["knurl"]["touching"] == true &&
               device["state"]["knurl"].contains("representations") &&
               device["state"]["knurl"]["representations"]["floor"]["force"]["z"].get<double>() > 0.05;
    }));
    command(R"("knurl":{"remove":"floor"})");
    EXPECT_TRUE(until(R"("probe_position":{})",
                      [](const Json& device) { return device["state"]["knurl"]["touching"] == false; }));
}

TEST_F(InverseServo, a_servo_that_restarts_is_found_again_under_the_same_id) {
    FakeSocket listening;
    const auto events = service.events(listening, "");
    const std::string before = id;
    servo.end(SIGKILL);
    EXPECT_TRUE(until("", [](const Json& device) { return device["status"]["started"] == false; }));
    servo.start();
    EXPECT_TRUE(until("", [](const Json& device) { return device["status"]["started"] == true; }));
    open();
    EXPECT_EQ(id, before);
    ASSERT_GE(listening.sent.size(), 2u);
    EXPECT_EQ(Json::parse(listening.sent[0])["name"], "device-disconnected");
    EXPECT_EQ(Json::parse(listening.sent[1])["name"], "device-connected");
}

TEST_F(InverseServo, twenty_clients_share_the_hand) {
    std::vector<std::unique_ptr<FakeSocket>> sockets;
    std::vector<std::unique_ptr<SocketHandler>> sessions;
    for (int i = 0; i < 20; ++i) {
        sockets.push_back(std::make_unique<FakeSocket>());
        sessions.push_back(service.simulation(*sockets.back(), ""));
    }
    const std::string message = R"({"inverse3":[{"device_id":")" + id +
                                R"(","commands":{"set_cursor_force":{"vector":{"x":0.01,"y":0,"z":0}}}}]})";
    EXPECT_TRUE(eventually([&] {
        for (auto& each : sessions) each->text(message);
        const Json answer = Json::parse(sockets.front()->sent.back());
        return std::abs(answer["inverse3"][0]["state"]["current_cursor_force"]["x"].get<double>() - 0.2) <
               1e-9;
    })) << Json::parse(sockets.front()->sent.back()).dump();
    sessions.clear();
    Client client = connect();
    claim_when_free(client);
}

}  // namespace
