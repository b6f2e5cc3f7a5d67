// Foxglove's protocol over devices that are made up, with a socket of two lists.

#include <cstring>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/gateway/foxglove.hpp>
#include <knurl/messages/drawing.hpp>
#include <knurl/messages/messages.hpp>
#include <knurl/messages/schemas.hpp>
#include <knurl/reps/all.hpp>

#include "decoded.hpp"

namespace knurl::test {
namespace {

using namespace gateway;
using namespace std::chrono_literals;
using testing::HasSubstr;

struct FakeSocket : Socket {
    void send_text(std::string text) override { texts.push_back(Json::parse(text)); }
    void send_binary(std::vector<std::byte> bytes) override { frames.push_back(std::move(bytes)); }
    bool idle() const override { return is_idle; }
    void close(std::uint16_t, std::string) override { closed = true; }
    Role role() const override { return Role::observe; }
    const std::string& peer() const override { return name; }

    std::vector<Json> texts;
    std::vector<std::vector<std::byte>> frames;
    bool is_idle = true, closed = false;
    std::string name = "127.0.0.1:1";
};

struct Frame {
    std::uint8_t op = 0;
    std::uint32_t subscription = 0;
    std::uint64_t ns = 0;
    std::vector<std::byte> body;
};
Frame frame_of(const std::vector<std::byte>& bytes) {
    Frame frame;
    EXPECT_GE(bytes.size(), 13u);
    std::memcpy(&frame.op, bytes.data(), 1);
    std::memcpy(&frame.subscription, bytes.data() + 1, 4);
    std::memcpy(&frame.ns, bytes.data() + 5, 8);
    frame.body.assign(bytes.begin() + 13, bytes.end());
    return frame;
}

/// One socket, and the servo that it looks at.
struct Foxglove : testing::Test {
    Foxglove() : source([this] { return look(); }, [] { return offset; }) {
        devices.push_back(device("right"));
    }

    static SeenDevice device(const char* name) {
        SeenDevice one;
        std::strncpy(one.info.name, name, sizeof one.info.name - 1);
        std::strncpy(one.info.servo, "default", sizeof one.info.servo - 1);
        one.info.joints = 3;
        one.info.workspace_radius = 0.1;
        one.info.rate = 1000;
        one.info.max_stiffness = std::numeric_limits<double>::infinity();
        return one;
    }
    FoxgloveLook look() {
        ++looks;
        return {.connected = connected,
                .epoch = epoch,
                .name = "default",
                .trouble = trouble,
                .devices = devices};
    }
    /// The next tick, with so many reports since.
    void tick(std::size_t reports = 0) {
        now += 16ms;
        for (SeenDevice& one : devices) {
            one.fresh.clear();
            for (std::size_t i = 0; i < reports; ++i) {
                Report report;
                report.cycle = ++cycle;
                report.read_ns = static_cast<std::int64_t>(cycle) * 1'000'000;
                report.position = {0.001 * static_cast<double>(cycle % 50), 0, 0};
                report.sent_force = {0, 0, 2};
                report.state = DeviceState::active;
                one.fresh.push_back(report);
                one.newest = report;
            }
        }
        for (const auto& handler : handlers) handler->tick(now);
    }
    SocketHandler& open(FakeSocket& socket) {
        handlers.push_back(source.handler(socket));
        return *handlers.back();
    }
    static std::vector<Json> with_op(const FakeSocket& socket, const std::string& op) {
        std::vector<Json> found;
        for (const Json& text : socket.texts)
            if (text.at("op") == op) found.push_back(text);
        return found;
    }
    /// Channels as advertised and not taken back, by topic.
    static std::map<std::string, Json> channels(const FakeSocket& socket) {
        std::map<std::string, Json> by_topic;
        for (const Json& text : socket.texts) {
            if (text.at("op") == "advertise")
                for (const Json& one : text.at("channels"))
                    by_topic[one.at("topic").get<std::string>()] = one;
            if (text.at("op") == "unadvertise")
                for (const Json& id : text.at("channelIds"))
                    std::erase_if(by_topic, [&](const auto& one) { return one.second.at("id") == id; });
        }
        return by_topic;
    }
    void subscribe(SocketHandler& handler, const FakeSocket& socket, unsigned id, const std::string& topic) {
        Json one = {{"id", id}, {"channelId", channels(socket).at(topic).at("id")}};
        Json list = Json::array();
        list.push_back(std::move(one));
        handler.text(Json{{"op", "subscribe"}, {"subscriptions", std::move(list)}}.dump());
    }
    static std::vector<Frame> frames(FakeSocket& socket, unsigned id) {
        std::vector<Frame> found;
        for (const auto& bytes : socket.frames)
            if (Frame frame = frame_of(bytes); frame.subscription == id) found.push_back(std::move(frame));
        return found;
    }
    Json decoded_scene(const Frame& frame) {
        return decoded({{messages::markers_schema(), frame.body}})[0].at("markers");
    }
    template <class R>
    void put(SeenDevice& one, std::uint64_t claim, std::uint32_t slot, const R& params) {
        SeenClaim& scene = one.claims[claim];
        scene.number = claim;
        SeenItem& item = scene.items[slot];
        item.id = {.slot = slot, .generation = 1};
        item.kind = kind_of<R>;
        item.params.resize(sizeof params);
        std::memcpy(item.params.data(), &params, sizeof params);
        item.version = ++one.scene_version;
    }

    static constexpr std::int64_t offset = 1'700'000'000'000'000'000;
    std::vector<SeenDevice> devices;
    bool connected = true;
    std::uint64_t epoch = 1, cycle = 0;
    std::string trouble;
    int looks = 0;
    std::chrono::steady_clock::time_point now{};
    FoxgloveSource source;
    std::vector<std::unique_ptr<SocketHandler>> handlers;
};

TEST_F(Foxglove, SaysWhoItIsAndWhatItHas) {
    FakeSocket socket;
    open(socket);
    ASSERT_EQ(socket.texts.size(), 1u);
    EXPECT_EQ(socket.texts[0].at("op"), "serverInfo");
    EXPECT_TRUE(socket.texts[0].at("capabilities").empty());
    EXPECT_FALSE(socket.texts[0].at("sessionId").get<std::string>().empty());
    tick();
    const auto found = channels(socket);
    ASSERT_EQ(found.size(), 10u);
    const Json& pose = found.at("/right/measured_cp");
    EXPECT_EQ(pose.at("encoding"), "cdr");
    EXPECT_EQ(pose.at("schemaName"), "geometry_msgs/msg/PoseStamped");
    EXPECT_EQ(pose.at("schemaEncoding"), "ros2msg");
    EXPECT_EQ(pose.at("schema"), messages::pose_schema().text);
    EXPECT_EQ(found.at("/right/parameters").at("schemaEncoding"), "jsonschema");
    tick(5);
    EXPECT_EQ(with_op(socket, "advertise").size(), 1u) << "said once";
    EXPECT_TRUE(socket.frames.empty()) << "nobody has subscribed";
}

TEST_F(Foxglove, SendsTheNewestPoseAndEveryReport) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    tick();
    subscribe(handler, socket, 7, "/right/measured_cp");
    subscribe(handler, socket, 8, "/right/report");
    subscribe(handler, socket, 9, "/tf");
    tick(17);
    tick();  // nothing new
    tick(16);
    const auto poses = frames(socket, 7), reports = frames(socket, 8), transforms = frames(socket, 9);
    ASSERT_EQ(poses.size(), 2u);
    ASSERT_EQ(reports.size(), 33u);
    ASSERT_EQ(transforms.size(), 2u);
    for (const Frame& frame : poses) EXPECT_EQ(frame.op, 1);
    EXPECT_EQ(poses[0].ns, static_cast<std::uint64_t>(offset + 17 * 1'000'000));
    const Json pose = decoded({{messages::pose_schema(), poses[1].body}})[0];
    EXPECT_EQ(pose.at("pose").at("position").at("x"), 0.001 * 33);
    EXPECT_EQ(pose.at("header").at("frame_id"), "right_base");
    for (std::size_t i = 0; i < reports.size(); ++i) {
        std::uint64_t number = 0;
        std::memcpy(&number, reports[i].body.data() + 4, sizeof number);
        ASSERT_EQ(number, i + 1);
    }
}

TEST_F(Foxglove, ASlowPeerGetsTheNewestNotAQueue) {
    FakeSocket slow, other;
    SocketHandler& handler = open(slow);
    SocketHandler& quick = open(other);
    tick(1);
    for (const char* topic : {"/right/measured_cp", "/right/scene"}) {
        subscribe(handler, slow, topic[7] == 's' ? 2 : 1, topic);
        subscribe(quick, other, topic[7] == 's' ? 2 : 1, topic);
    }
    put(devices[0], 3, 0, Sphere{});
    tick(1);
    slow.is_idle = false;
    for (unsigned i = 1; i <= 5; ++i) {
        put(devices[0], 3, i, Sphere{});
        tick(1);
    }
    EXPECT_EQ(frames(slow, 1).size(), 1u);
    EXPECT_EQ(frames(other, 1).size(), 6u);
    slow.is_idle = true;
    tick(1);
    ASSERT_EQ(frames(slow, 1).size(), 2u);
    EXPECT_EQ(frames(slow, 1).back().ns, static_cast<std::uint64_t>(offset + 8 * 1'000'000));
    // Of the scene it gets in one message what has changed since.
    ASSERT_EQ(frames(slow, 2).size(), 2u);
    EXPECT_EQ(decoded_scene(frames(slow, 2).back()).size(), 5u);
    EXPECT_EQ(frames(other, 2).size(), 6u);
    EXPECT_EQ(decoded_scene(frames(other, 2).back()).size(), 1u) << "the last sphere alone";
}

TEST_F(Foxglove, APeerThatStoodStillGetsTheReportsOfAWhile) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    tick(5);
    subscribe(handler, socket, 1, "/right/report");
    tick(10);
    EXPECT_EQ(frames(socket, 1).size(), 10u) << "none of before";
    socket.is_idle = false;
    for (int i = 0; i < 6; ++i) tick(16);
    socket.is_idle = true;
    tick(16);
    ASSERT_EQ(frames(socket, 1).size(), 10u + 7 * 16);
    std::uint64_t last = 5;
    for (const Frame& frame : frames(socket, 1)) {
        std::uint64_t number = 0;
        std::memcpy(&number, frame.body.data() + 4, sizeof number);
        ASSERT_EQ(number, ++last);
    }
    socket.is_idle = false;
    for (int i = 0; i < 100; ++i) tick(16);
    socket.is_idle = true;
    tick(16);
    EXPECT_EQ(frames(socket, 1).size(), 10u + 7 * 16 + 1024) << "the newest; it is bounded";
}

TEST_F(Foxglove, ASceneIsSentWhenItChanges) {
    FakeSocket first, second;
    SocketHandler& handler = open(first);
    put(devices[0], 3, 0, Sphere{.center = {0.01, 0, 0}});
    put(devices[0], 3, 4, Capsule{});
    tick(1);
    subscribe(handler, first, 1, "/right/scene");
    tick(1);
    ASSERT_EQ(frames(first, 1).size(), 1u);
    const Json whole = decoded_scene(frames(first, 1)[0]);
    ASSERT_EQ(whole.size(), 1u + 1 + 3);
    EXPECT_EQ(whole[1].at("ns"), "claim 3");
    EXPECT_EQ(whole[1].at("id"), 0);
    EXPECT_EQ(whole[2].at("id"), 4 * 8);
    tick(1);
    EXPECT_EQ(frames(first, 1).size(), 1u) << "nothing has changed";

    put(devices[0], 3, 0, Sphere{.center = {0.02, 0, 0}});
    tick(1);
    const Json moved = decoded_scene(frames(first, 1).back());
    ASSERT_EQ(moved.size(), 1u);
    EXPECT_EQ(moved[0].at("id"), 0);
    EXPECT_EQ(moved[0].at("pose").at("position").at("x"), 0.02);

    devices[0].claims[3].items[0].feedback.flags = Feedback::fading;
    tick(1);
    EXPECT_LT(decoded_scene(frames(first, 1).back())[0].at("color").at("a"), 0.5);

    devices[0].claims[3].items.erase(4);
    ++devices[0].scene_version;
    tick(1);
    const Json gone = decoded_scene(frames(first, 1).back());
    ASSERT_EQ(gone.size(), 3u);
    std::set<int> ids;
    for (const Json& one : gone) {
        EXPECT_EQ(one.at("action"), 2);
        ids.insert(one.at("id").get<int>());
    }
    EXPECT_EQ(ids, (std::set<int>{32, 33, 34}));

    SocketHandler& later = open(second);
    tick(1);
    subscribe(later, second, 1, "/right/scene");
    const std::size_t before = frames(first, 1).size();
    tick(1);
    EXPECT_EQ(frames(first, 1).size(), before);
    EXPECT_EQ(decoded_scene(frames(second, 1).back()).size(), 2u) << "what is there now";
}

TEST_F(Foxglove, APlanesPatchFollowsTheHandInSteps) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    put(devices[0], 3, 0, Plane{});
    tick(1);
    subscribe(handler, socket, 1, "/right/scene");
    for (int i = 0; i < 47; ++i) tick(1);  // 46 mm in steps of 1 mm; a patch is redrawn after 25 mm
    EXPECT_EQ(frames(socket, 1).size(), 2u);
}

TEST_F(Foxglove, ALargeMeshIsNotSentWithEachMove) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    auto mesh = std::make_shared<SeenAsset>();
    mesh->vertices.resize(9);
    mesh->triangles.resize(std::size_t{3} * 2000);
    put(devices[0], 3, 0, Shape{.asset = 1});
    devices[0].claims[3].assets[1] = mesh;
    tick(1);
    subscribe(handler, socket, 1, "/right/scene");
    for (int i = 0; i < 62; ++i) {  // a second
        put(devices[0], 3, 0, Shape{.asset = 1, .position = {0.001 * i, 0, 0}});
        tick(1);
    }
    EXPECT_EQ(frames(socket, 1).size(), 2u);
}

TEST_F(Foxglove, NoMessageIsMoreThanAPeerMayLeaveUnread) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    auto mesh = std::make_shared<SeenAsset>();
    mesh->vertices.resize(9);
    mesh->triangles.resize(3 * messages::most_triangles);
    for (unsigned i = 0; i < 2; ++i) put(devices[0], 3, i, Shape{.asset = 1});
    devices[0].claims[3].assets[1] = mesh;
    put(devices[0], 3, 2, Sphere{});
    tick(1);
    subscribe(handler, socket, 1, "/right/scene");
    for (int i = 0; i < 20; ++i) {
        // What changes all the time does not keep the rest from being drawn.
        put(devices[0], 3, 0, Shape{.asset = 1, .position = {0.001 * i, 0, 0}});
        tick(1);
    }
    std::size_t points = 0;
    for (const Frame& frame : frames(socket, 1)) {
        EXPECT_LE(frame.body.size(), std::size_t{2} << 20);
        points += frame.body.size() / sizeof(Vec3);
    }
    EXPECT_GE(frames(socket, 1).size(), 16u) << "a part at a time";
    EXPECT_GE(points, 2 * 3 * messages::most_triangles) << "both, whole";
    EXPECT_LE(points, 4 * 3 * messages::most_triangles);
}

TEST_F(Foxglove, ParametersAreJsonAndSaidWhenTheyChange) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    put(devices[0], 3, 2, Plane{.normal = {0, 0, 2}, .stiffness = std::numeric_limits<double>::infinity()});
    tick(1);
    subscribe(handler, socket, 1, "/right/parameters");
    for (int i = 0; i < 100; ++i) tick(1);
    ASSERT_EQ(frames(socket, 1).size(), 1u);
    const auto parsed = [&] {
        const std::vector<std::byte> body = frames(socket, 1).back().body;
        return Json::parse({reinterpret_cast<const char*>(body.data()), body.size()});
    };
    EXPECT_EQ(parsed().at("device").at("rate"), 1000);
    EXPECT_EQ(parsed().at("device").at("max_stiffness"), "inf");
    const Json item = parsed().at("items")[0];
    EXPECT_EQ(item.at("kind"), "plane");
    EXPECT_EQ(item.at("params").at("stiffness"), "inf");
    EXPECT_EQ(item.at("params").at("recovery"), "automatic");
    EXPECT_EQ(item.at("params").at("normal")[2], 2);
    EXPECT_EQ(item.at("params").at("update"), "fade");
    for (unsigned i = 0; i < 300; ++i) put(devices[0], 4, i, Sphere{});
    tick(1);
    EXPECT_EQ(parsed().at("items").size(), 256u);
    EXPECT_EQ(parsed().at("left_out"), 45);
}

TEST_F(Foxglove, DiagnosticsComeOnceASecond) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    devices[0].rates.rate = 999.5;
    devices[0].rates.late = 2;
    devices[0].rates.device.counters["cycles"] = 12345;
    tick(1);
    subscribe(handler, socket, 1, "/diagnostics");
    for (int i = 0; i < 64; ++i) tick(1);  // 1.02 s
    ASSERT_EQ(frames(socket, 1).size(), 2u);
    const Json status =
        decoded({{messages::diagnostics_schema(), frames(socket, 1)[0].body}})[0].at("status")[0];
    EXPECT_EQ(status.at("level"), 1);
    EXPECT_EQ(status.at("message"), "active; 2 cycles late");
    std::map<std::string, std::string> values;
    for (const Json& one : status.at("values")) values[one.at("key")] = one.at("value").get<std::string>();
    EXPECT_EQ(values.at("rate (Hz)"), "999.5");
    EXPECT_EQ(values.at("cycles"), "12345");
}

TEST_F(Foxglove, DevicesComeAndGo) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    tick(1);
    const auto before = channels(socket);
    subscribe(handler, socket, 1, "/right/measured_cp");
    tick(1);
    ASSERT_EQ(frames(socket, 1).size(), 1u);
    connected = false;
    trouble = "no servo listens";
    tick(1);
    EXPECT_EQ(channels(socket).size(), 2u) << "/tf and /diagnostics stay";
    EXPECT_EQ(with_op(socket, "status").back().at("message"), trouble);
    EXPECT_EQ(frames(socket, 1).size(), 1u);
    connected = true;
    trouble.clear();
    ++epoch;
    devices.push_back(device("le.ft"));
    tick(1);
    const auto after = channels(socket);
    EXPECT_EQ(after.size(), 18u);
    EXPECT_TRUE(after.contains("/le_ft/report"));
    EXPECT_FALSE(after.at("/right/measured_cp").at("id") == before.at("/right/measured_cp").at("id"))
        << "a number is not used again";
    EXPECT_EQ(with_op(socket, "removeStatus").size(), 1u);
    subscribe(handler, socket, 1, "/le_ft/measured_cp");  // the number of the subscription is free again
    tick(1);
    EXPECT_EQ(with_op(socket, "status").size(), 1u);
    EXPECT_EQ(frames(socket, 1).size(), 2u);
}

TEST_F(Foxglove, WhatIsComputedIsWhatSomebodySees) {
    FakeSocket socket, other;
    SocketHandler& handler = open(socket);
    open(other);
    tick(1);
    EXPECT_EQ(looks, 1) << "one look for all sockets";
    subscribe(handler, socket, 1, "/right/measured_cp");
    tick(1);
    handler.text(R"({"op": "unsubscribe", "subscriptionIds": [1]})");
    for (int i = 0; i < 10; ++i) tick(1);
    EXPECT_EQ(frames(socket, 1).size(), 1u);
    // What was made before is old: nothing is sent of it.
    subscribe(handler, socket, 2, "/right/measured_cp");
    tick(0);
    ASSERT_EQ(frames(socket, 2).size(), 1u);
    EXPECT_EQ(frames(socket, 2)[0].ns,
              static_cast<std::uint64_t>(offset + static_cast<std::int64_t>(cycle) * 1'000'000));
}

TEST_F(Foxglove, WhatCannotBeUsedIsAnsweredByOneStatus) {
    FakeSocket socket;
    SocketHandler& handler = open(socket);
    tick(1);
    const auto status_of = [&](const std::string& text) {
        const std::size_t before = with_op(socket, "status").size();
        handler.text(text);
        const auto all = with_op(socket, "status");
        EXPECT_EQ(all.size(), before + 1) << text.substr(0, 100);
        EXPECT_EQ(all.back().at("level"), 2);
        return all.back().at("message").get<std::string>();
    };
    EXPECT_THAT(status_of("{"), HasSubstr("not understood"));
    EXPECT_THAT(status_of("[]"), HasSubstr("not understood"));
    EXPECT_THAT(status_of("{}"), HasSubstr("op"));
    EXPECT_THAT(status_of(std::string(10'000, '[')), HasSubstr("not understood"));
    EXPECT_THAT(status_of(std::string(longest_request + 1, ' ')), HasSubstr("is the most"));
    EXPECT_THAT(status_of(R"({"op": "setPara\u001bmeters"})"), HasSubstr("'setPara?meters' is not offered"));
    EXPECT_THAT(status_of(R"({"op": "subscribe"})"), HasSubstr("subscriptions"));
    EXPECT_THAT(status_of(R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 999}]})"),
                HasSubstr("there is no channel 999"));
    EXPECT_THAT(status_of(R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]})"),
                HasSubstr("no number of 32 bits"));
    EXPECT_THAT(status_of(R"({"op": "subscribe", "subscriptions": [{"id": 1e300, "channelId": 1}]})"),
                HasSubstr("no number of 32 bits"));
    EXPECT_THAT(status_of(R"({"op": "unsubscribe", "subscriptionIds": [4294967295, 5]})"),
                HasSubstr("there is no subscription 4294967295; there is no subscription 5"));
    std::string many = R"({"op": "subscribe", "subscriptions": [)";
    for (unsigned i = 0; i <= most_subscriptions; ++i)
        many += (i > 0 ? ", " : "") + std::string("{\"id\": ") + std::to_string(i) + ", \"channelId\": 1}";
    EXPECT_THAT(status_of(many + "]}"), HasSubstr("256 subscriptions are the most"));
    EXPECT_THAT(status_of(R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}]})"),
                HasSubstr("there is a subscription 1 already"));
    const std::size_t before = socket.texts.size();
    handler.binary({});
    EXPECT_EQ(socket.texts.size(), before + 1);
    tick(3);
    EXPECT_EQ(socket.frames.size(), 3 * most_subscriptions) << "each gets it, under its own number";
}

}  // namespace
}  // namespace knurl::test
