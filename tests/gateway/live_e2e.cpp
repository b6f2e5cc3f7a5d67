// What the page of knurl-web sees and does, against a real knurld: the view, the scenes of others, its own claim.

#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <knurl/gateway/live_page.hpp>
#include <knurl/reps/all.hpp>

#include "../client/servo_process.hpp"
#include "test_socket.hpp"

namespace knurl::gateway::live_e2e_tests {
namespace {

using namespace std::chrono_literals;
using namespace client_test;
using ::testing::HasSubstr;
using testing::TestSocket;
using Clock = std::chrono::steady_clock;

struct Live : ::testing::Test {
    ServoProcess servo{{"--device", "right=sim:premium15"}};
    LiveView view{"default"};
    LivePage page{view, {}};
    std::vector<std::pair<TestSocket*, SocketHandler*>> open;

    void tick() {
        const auto now = Clock::now();
        view.tick(now);
        page.tick(now);
        for (const auto& [socket, handler] : open) handler->tick(now);
    }
    /// Ticks until it is so.
    template <class So>
    [[nodiscard]] bool soon(So so) {
        return eventually([&] {
            tick();
            return so();
        });
    }
    const SeenDevice& device() const { return view.devices().front(); }
    const SeenItem* item(Kind kind) const {
        for (const auto& [number, claim] : device().claims)
            for (const auto& [slot, item] : claim.items)
                if (item.kind == kind) return &item;
        return nullptr;
    }
};

struct Page {
    TestSocket socket;
    std::unique_ptr<SocketHandler> handler;
    Live& live;
    int id = 0;

    explicit Page(Live& of, Role role = Role::control) : socket(role), live(of) {
        handler = live.page.open(socket);
        live.open.emplace_back(&socket, handler.get());
    }
    ~Page() {
        std::erase_if(live.open, [this](const auto& pair) { return pair.first == &socket; });
        handler.reset();
    }
    Json ask(const std::string& op, Json request = Json::object()) {
        request["op"] = op;
        request["id"] = ++id;
        handler->text(request.dump());
        const Json answer = Json::parse(socket.texts.back());
        EXPECT_EQ(answer.at("op"), "answer");
        EXPECT_EQ(answer.at("id"), id);
        return answer;
    }
    std::string refusal(const std::string& op, const Json& request = Json::object()) {
        const Json answer = ask(op, request);
        EXPECT_FALSE(answer.at("ok").get<bool>()) << op;
        return answer.value("error", Json("")).get<std::string>();
    }
};

TEST_F(Live, ViewHasReportsRatesAndTheArm) {
    ASSERT_TRUE(soon([&] { return view.connected() && device().newest && device().rates.rate > 0; }));
    EXPECT_EQ(view.pid(), servo.pid());
    EXPECT_STREQ(device().info.name, "right");
    ASSERT_GE(device().arm.size(), 3u);
    const Vec3 tip = device().arm.back(), hand = device().newest->position;
    EXPECT_NEAR(std::hypot(tip.x - hand.x, tip.y - hand.y, tip.z - hand.z), 0, 1e-9);
    std::uint64_t last = 0, reports = 0;
    ASSERT_TRUE(soon([&] {
        for (const Report& report : device().fresh) {
            EXPECT_TRUE(last == 0 || report.cycle == last + 1 || device().missed > 0);
            last = report.cycle;
            ++reports;
        }
        return reports > 500;
    }));
}

TEST_F(Live, ShowsWhatAnotherProgramAddsChangesAndRemoves) {
    Client client = connect();
    Claim hand = client.claim();
    // There before anybody looks.
    auto floor = hand.add(Plane{.normal = {0, 0, 1}, .offset = -0.05, .stiffness = 321});
    hand.wait_applied(hand.commit(), 10s);
    Page page(*this);
    ASSERT_TRUE(soon([&] { return view.connected() && item(kind_of<Plane>) != nullptr; }));
    Plane seen;
    std::memcpy(&seen, item(kind_of<Plane>)->params.data(), sizeof seen);
    EXPECT_EQ(seen.stiffness, 321);

    ASSERT_TRUE(soon([&] { return page.socket.last("scene").has_value(); }));
    Json scene = *page.socket.last("scene");
    EXPECT_EQ(scene.at("items").at(0).at("kind"), "plane");
    EXPECT_EQ(scene.at("items").at(0).at("params").at("stiffness"), 321);
    EXPECT_EQ(scene.at("claims").at(0).at("pid"), ::getpid());
    EXPECT_FALSE(scene.at("claims").at(0).at("mine").get<bool>());

    page.socket.texts.clear();
    floor.set({.normal = {0, 0, 1}, .offset = -0.04, .stiffness = 321});
    hand.commit();
    ASSERT_TRUE(soon([&] { return page.socket.last("scene").has_value(); }));
    scene = *page.socket.last("scene");
    EXPECT_FALSE(scene.at("full").get<bool>());
    EXPECT_EQ(scene.at("items").at(0).at("params").at("offset"), -0.04);

    page.socket.texts.clear();
    const std::uint32_t slot = floor.id().slot;
    floor.remove();
    ASSERT_TRUE(soon([&] { return item(kind_of<Plane>) == nullptr; }));
    ASSERT_TRUE(soon([&] { return page.socket.last("scene").has_value(); }));
    EXPECT_EQ(page.socket.last("scene")->at("gone").at(0).at(1), slot);
    page.socket.texts.clear();
    hand.release();
    ASSERT_TRUE(soon([&] { return device().claims.empty(); }));
    ASSERT_TRUE(soon([&] { return page.socket.last("scene").has_value(); }));
    EXPECT_EQ(page.socket.last("scene")->at("gone").at(0).size(), 1u) << "the whole claim";
}

TEST_F(Live, ShowsTheMeshOfAnotherProgram) {
    Client client = connect();
    Claim hand = client.claim("", {.update_interval = 1min});
    const std::vector<Point3> corners = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}};
    const std::vector<Triangle> faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const SentShape sent = hand.send(Triangles{.vertices = corners, .triangles = faces, .materials = {}});
    hand.add(Shape{.asset = sent.asset, .position = {0, 0, -0.1}, .stiffness = 100});
    const auto asset = [&]() -> const SeenAsset* {
        if (!view.connected() || device().claims.empty()) return nullptr;
        const auto& assets = device().claims.begin()->second.assets;
        const auto found = assets.find(sent.asset);
        return found == assets.end() ? nullptr : found->second.get();
    };
    ASSERT_TRUE(soon([&] { return asset() != nullptr; }));
    EXPECT_EQ(asset()->triangles.size(), 12u);
    float low = 1, high = -1;
    for (const float x : asset()->vertices) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
    EXPECT_FLOAT_EQ(low, 0);
    EXPECT_FLOAT_EQ(high, 0.01F);
    const std::uint64_t number = device().claims.begin()->first;
    const auto bytes = page.asset(0, number, sent.asset);
    ASSERT_TRUE(bytes);
    EXPECT_EQ(bytes->size(), 8 + 4 * (asset()->vertices.size() + asset()->triangles.size()));
    EXPECT_FALSE(page.asset(0, number, 7));
    EXPECT_FALSE(page.asset(3, number, sent.asset));
}

TEST_F(Live, APageAddsTunesArmsAndItsForceEndsWithIt) {
    ASSERT_TRUE(soon([&] { return view.connected(); }));
    Vec3 force;
    {
        Page page(*this);
        EXPECT_EQ(page.socket.last("hello")->at("role"), "control");
        const Json added = page.ask(
            "add", {{"device", 0}, {"kind", "plane"}, {"params", {{"offset", 0.01}, {"stiffness", 200}}}});
        ASSERT_TRUE(added.at("ok").get<bool>()) << added.dump();
        ASSERT_TRUE(page.ask("arm").at("ok").get<bool>());
        ASSERT_TRUE(soon([&] {
            force = device().newest->sent_force;
            return force.z > 0.5;
        }));
        ASSERT_TRUE(soon([&] {
            const auto scene = page.socket.last("scene");
            return scene && scene->at("claims").size() == 1 &&
                   scene->at("claims").at(0).at("mine").get<bool>();
        }));
        EXPECT_TRUE(page.ask("set", {{"slot", added.at("slot")}, {"params", {{"offset", -0.05}}}})
                        .at("ok")
                        .get<bool>());
        ASSERT_TRUE(soon([&] { return std::abs(device().newest->sent_force.z) < 0.01; }));
        Plane seen;
        std::memcpy(&seen, item(kind_of<Plane>)->params.data(), sizeof seen);
        EXPECT_EQ(seen.stiffness, 200) << "what `set` does not name stays";
        EXPECT_TRUE(page.ask("set", {{"slot", added.at("slot")}, {"params", {{"offset", 0.01}}}})
                        .at("ok")
                        .get<bool>());
        ASSERT_TRUE(soon([&] { return device().newest->sent_force.z > 0.5; }));
        ASSERT_TRUE(page.socket.last("felt"));
    }
    ASSERT_TRUE(soon([&] { return device().claims.empty() && device().newest->sent_force.z == 0; }));
}

TEST_F(Live, WhatAPageMayNotDoIsRefusedInOneLine) {
    ASSERT_TRUE(soon([&] { return view.connected(); }));
    Page observer(*this, Role::observe), renderer(*this, Role::render), control(*this);
    EXPECT_THAT(observer.refusal("add", {{"kind", "plane"}}), HasSubstr("needs the role render"));
    EXPECT_THAT(renderer.refusal("arm"), HasSubstr("needs the role control"));
    EXPECT_THAT(renderer.refusal("record", {{"file", "a"}}), HasSubstr("needs the role control"));
    EXPECT_THAT(control.refusal("add", {{"kind", "plain"}}),
                HasSubstr("there is no representation 'plain'; did you mean 'plane'?"));
    EXPECT_THAT(control.refusal("add", {{"kind", "plane"}, {"params", {{"stiffness", -1}}}}),
                HasSubstr("stiffness = -1"));
    EXPECT_THAT(control.refusal("add", {{"kind", "plane"}, {"params", {{"stifness", 1}}}}),
                HasSubstr("stiffness"));
    EXPECT_THAT(control.refusal("add", {{"kind", "plane"}, {"params", {{"x\n[y]", 1}}}}),
                HasSubstr("unknown key"));
    EXPECT_THAT(control.refusal("add", {{"kind", "plane"}, {"device", 4}}), HasSubstr("device 4 of 1"));
    EXPECT_THAT(control.refusal("set", {{"slot", 5}, {"params", {{"stiffness", 1}}}}),
                HasSubstr("nothing in slot 5"));
    EXPECT_THAT(control.refusal("pull", {{"target", Json::array({0, 0, 0})}}), HasSubstr("cannot be pulled"));
    EXPECT_THAT(control.refusal("record", {{"file", "../a"}}), HasSubstr("no folder for recordings"));
    EXPECT_THAT(control.refusal("reset"), HasSubstr("fault"));
    EXPECT_THAT(control.refusal("dance"), HasSubstr("'dance' is no request"));
    for (const char* text :
         {"", "{", "[]", "null", "{\"op\":7}", "{\"op\":\"add\",\"kind\":3}",
          "{\"op\":\"add\",\"kind\":\"plane\",\"params\":[1]}", "{\"op\":\"set\",\"slot\":-1,\"params\":{}}",
          "{\"op\":\"pull\",\"target\":[1,2]}"}) {
        control.handler->text(text);
        const Json answer = Json::parse(control.socket.texts.back());
        EXPECT_FALSE(answer.at("ok").get<bool>()) << text;
        EXPECT_FALSE(answer.at("error").get<std::string>().empty()) << text;
    }
    EXPECT_TRUE(device().claims.empty() || item(kind_of<Plane>) == nullptr) << "nothing is half-applied";
}

TEST_F(Live, APageThatDoesNotReadGetsTheNewestAndNoQueue) {
    ASSERT_TRUE(soon([&] { return view.connected() && device().newest; }));
    Page page(*this);
    tick();
    page.socket.reads = false;
    page.socket.texts.clear();
    page.socket.binaries.clear();
    for (int i = 0; i < 100; ++i) tick();
    EXPECT_TRUE(page.socket.texts.empty());
    EXPECT_TRUE(page.socket.binaries.empty());
    page.socket.reads = true;
    ASSERT_TRUE(soon([&] { return page.socket.last("frame").has_value(); }));
    EXPECT_EQ(page.socket.last("frame")->at("devices").at(0).at("cycle"), device().newest->cycle);
}

TEST_F(Live, AnotherServoTakesThePlaceOfADeadOne) {
    Page page(*this);
    ASSERT_TRUE(soon([&] { return view.connected() && device().newest; }));
    const auto epoch = view.epoch();
    servo.end(SIGKILL);
    ASSERT_TRUE(soon([&] { return !view.connected(); }));
    tick();
    EXPECT_FALSE(page.socket.last("servo")->at("connected").get<bool>());
    EXPECT_THAT(page.socket.last("servo")->at("trouble").get<std::string>(), HasSubstr("ended"));
    EXPECT_THAT(page.refusal("add", {{"kind", "plane"}}), HasSubstr("servo"));
    servo.start();
    ASSERT_TRUE(soon([&] { return view.connected() && device().newest; }));
    EXPECT_NE(view.epoch(), epoch);
    EXPECT_EQ(view.pid(), servo.pid());
    tick();
    EXPECT_TRUE(page.socket.last("servo")->at("connected").get<bool>());
}

TEST_F(Live, SamplesAreTheReports) {
    Page page(*this);
    ASSERT_TRUE(
        soon([&] { return view.connected() && !device().fresh.empty() && !page.socket.binaries.empty(); }));
    const std::vector<std::byte>& bytes = page.socket.binaries.back();
    std::uint32_t head[4];
    std::memcpy(head, bytes.data(), sizeof head);
    EXPECT_EQ(head[0], 1u);
    ASSERT_EQ(head[2], device().fresh.size());
    ASSERT_EQ(bytes.size(), 24 + head[2] * 14 * sizeof(float));
    for (std::uint32_t i = 0; i < head[2]; ++i) {
        float row[14];
        std::memcpy(row, bytes.data() + 24 + i * sizeof row, sizeof row);
        const Report& report = device().fresh[i];
        EXPECT_FLOAT_EQ(row[3], static_cast<float>(report.position.z));
        EXPECT_FLOAT_EQ(row[10],
                        static_cast<float>(1e-3 * static_cast<double>(report.read_ns - report.deadline_ns)));
        EXPECT_EQ(row[13], static_cast<float>(report.state));
    }
}

/// A servo whose hand has a pipe, as `knurl web` starts one.
TEST(LivePull, TheHandFollowsThePage) {
    const knurl::test::TempFolder folder;
    const std::string pipe = (folder / "hand").string();
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const ServoProcess servo({"--device", "right=sim:premium15,live=" + pipe});
    LiveView view("default");
    LivePage page(view, {});
    TestSocket socket;
    const auto handler = page.open(socket);
    const auto tick = [&] {
        view.tick(Clock::now());
        page.tick(Clock::now());
        handler->tick(Clock::now());
    };
    ASSERT_TRUE(eventually([&] {
        tick();
        return view.connected() && socket.last("servo") && view.devices().front().newest;
    }));
    EXPECT_TRUE(socket.last("servo")->at("devices").at(0).at("pull").get<bool>());
    handler->text(R"({"op":"pull","id":1,"device":0,"target":[0.02,-0.01,0.03]})");
    EXPECT_TRUE(socket.last("answer")->at("ok").get<bool>()) << socket.last("answer")->dump();
    ASSERT_TRUE(eventually([&] {
        tick();
        const Vec3& p = view.devices().front().newest->position;
        return std::hypot(p.x - 0.02, p.y + 0.01, p.z - 0.03) < 2e-3;
    }));
}

TEST(LiveView, SaysWhyThereIsNoServo) {
    const knurl::test::TempFolder folder;
    ::setenv("KNURL_RUNTIME_DIR", folder.path().c_str(), 1);
    LiveView view("nobody");
    view.tick(Clock::now());
    EXPECT_FALSE(view.connected());
    EXPECT_THAT(view.trouble(), HasSubstr("nobody"));
    EXPECT_TRUE(view.devices().empty());
}

}  // namespace
}  // namespace knurl::gateway::live_e2e_tests
