// What peers may command, and when: the test plays clocks, servo and peers.

#include <gtest/gtest.h>

#include <knurl/dds/command_desk.hpp>
#include <knurl/reps/plane.hpp>

namespace {

using namespace knurl;
using namespace knurl::dds;
using namespace std::chrono_literals;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

/// Writes down what its peer commands.
class Claimed final : public gateway::PeerCommands {
  public:
    Claimed(std::vector<std::string>& calls, std::string peer) : calls_(calls), peer_(std::move(peer)) {}
    ~Claimed() override { did("released"); }
    std::string push(const Vec3& f, const Vec3& t, std::string_view) override {
        did("push " + number(f.x) + " " + number(f.y) + " " + number(f.z) +
            (t == Vec3{} ? "" : " torque " + number(t.x)));
        return {};
    }
    std::string pull(const Vec3& to, std::string_view) override {
        did("pull " + number(to.x));
        return {};
    }
    std::string add(const std::string& name, Kind, const std::vector<std::byte>&,
                    const AddOptions& options) override {
        did("add " + name + (options.probe == 0 ? "" : " on " + number(options.probe)));
        return {};
    }
    std::string set(const std::string& name, const std::vector<std::byte>&) override {
        did("set " + name);
        return {};
    }
    std::string remove(const std::string& name) override {
        did("remove " + name);
        return {};
    }
    void clear() override { did("clear"); }
    void sent() override {}
    gateway::PeerStatus status() const override { return {}; }
    std::vector<gateway::Said> said() override { return {}; }

  private:
    void did(const std::string& what) { calls_.push_back(peer_ + ": " + what); }
    std::vector<std::string>& calls_;
    const std::string peer_;
};

struct Desk {
    std::function<void(CommandOptions&)> change;
    std::vector<std::string> calls, lines;
    std::chrono::steady_clock::time_point now{1000s};
    std::int64_t wall = 1'000'000'000'000'000;
    gateway::PeerOptions last;
    CommandDesk desk;

    explicit Desk(std::function<void(CommandOptions&)> changed = {})
        : change(std::move(changed)), desk(options()) {
        Report report;
        report.state = DeviceState::idle;
        report.position = {0.1, 0, 0};
        desk.look(report);
    }
    CommandOptions options() {
        CommandOptions made;
        made.device = "right";
        made.base_frame = "right_base";
        made.tip_frame = "right_hand";
        made.make_hand = [this](gateway::PeerOptions peer) {
            last = peer;
            return std::make_unique<Claimed>(calls, peer.peer);
        };
        made.log = [this](const std::string& line) { lines.push_back(line); };
        made.clock = [this] { return now; };
        made.wall_clock = [this] { return wall; };
        if (change) change(made);
        return made;
    }
    void pass(std::chrono::nanoseconds time) {
        now += time;
        wall += time.count();
    }
    /// Its message took `took` by clocks that are `offset` apart.
    Origin from(const std::string& id, std::chrono::nanoseconds took = 1ms,
                std::chrono::nanoseconds offset = 0ns) const {
        return {.id = id, .text = id, .host = "lab", .written_ns = wall - took.count() + offset.count()};
    }
    Head at(const Origin& origin, const std::string& frame = "right_base") const {
        return {.frame = frame, .stamp_ns = origin.written_ns};
    }
    void push(const Origin& origin, double x) { desk.force(origin, at(origin), {x, 0, 0}, {}, false); }
};

bool says(const Desk& desk, const std::string& part) {
    for (const std::string& line : desk.lines)
        if (line.find(part) != std::string::npos) return true;
    return false;
}

using Calls = std::vector<std::string>;

TEST(DdsCommands, a_force_goes_to_a_claim_of_its_peer_that_lapses_after_the_deadline) {
    Desk desk;
    desk.push(desk.from("a"), 2);
    EXPECT_EQ(desk.calls, (Calls{"dds a: push 2 0 0"}));
    EXPECT_EQ(desk.last.lapse, 20ms);
    EXPECT_EQ(desk.last.device, "right");
    EXPECT_EQ(desk.desk.state(), "ENABLED");
    EXPECT_TRUE(desk.lines.empty());
}

TEST(DdsCommands, a_force_in_the_frame_of_the_tip_is_turned_into_the_devices) {
    Desk desk;
    Report report;
    report.state = DeviceState::active;
    report.orientation = {
        .w = std::sqrt(0.5), .x = 0, .y = 0, .z = std::sqrt(0.5)};  // a quarter turn about z
    desk.desk.look(report);
    const Origin origin = desk.from("a");
    desk.desk.force(origin, desk.at(origin, "right_hand"), {1, 0, 0}, {}, true);
    ASSERT_EQ(desk.calls.size(), 1u);
    EXPECT_NE(desk.calls[0].find(" 1 0"), std::string::npos) << desk.calls[0];
}

TEST(DdsCommands, what_is_no_number_or_of_another_frame_is_refused_in_one_line) {
    Desk desk;
    const Origin origin = desk.from("a");
    desk.desk.force(origin, desk.at(origin), {std::nan(""), 0, 0}, {}, false);
    EXPECT_TRUE(says(desk, "a: servo_cf is not a finite number")) << desk.lines.size();
    desk.desk.force(origin, desk.at(origin, "map"), {1, 0, 0}, {}, false);
    EXPECT_TRUE(says(desk, "frame_id is 'map'; give 'right_base'"));
    desk.desk.force(origin, desk.at(origin, "right_hand"), {1, 0, 0}, {}, false);
    EXPECT_TRUE(desk.calls.empty());
    EXPECT_EQ(desk.lines.size(), 3u);
    desk.desk.force(origin, desk.at(origin, "map"), {1, 0, 0}, {}, false);
    EXPECT_EQ(desk.lines.size(), 3u) << "and not again for each message";
    desk.desk.force(origin, desk.at(origin, ""), {1, 0, 0}, {}, false);
    EXPECT_EQ(desk.calls.size(), 1u) << "who states no frame means the base";
}

TEST(DdsCommands, a_message_that_took_longer_than_the_lifespan_is_not_felt_whatever_the_clocks_say) {
    for (const auto offset : {0ns, std::chrono::nanoseconds(3600s), std::chrono::nanoseconds(-3600s)}) {
        Desk desk;
        desk.push(desk.from("a", 1ms, offset), 1);
        desk.pass(5ms);
        desk.push(desk.from("a", 49ms, offset), 2);
        EXPECT_EQ(desk.calls.size(), 2u);
        desk.pass(5ms);
        desk.push(desk.from("a", 60ms, offset), 3);
        EXPECT_EQ(desk.calls.size(), 2u) << offset.count();
        EXPECT_TRUE(says(desk, "came 59 ms late"));
    }
}

TEST(DdsCommands, a_clock_that_steps_silences_its_peer_for_a_second_at_most) {
    Desk desk;
    desk.push(desk.from("a"), 1);
    int felt = 0;
    for (int i = 0; i < 400; ++i) {  // the peer's clock is set back by 10 s
        desk.pass(5ms);
        desk.push(desk.from("a", 1ms, -10s), 2);
        felt = static_cast<int>(desk.calls.size());
    }
    EXPECT_GT(felt, 150);
    EXPECT_TRUE(says(desk, "has been set back"));
    const std::size_t before = desk.calls.size();
    for (int i = 0; i < 10; ++i) {  // and forward: it counts at once
        desk.pass(5ms);
        desk.push(desk.from("a", 1ms, 10s), 2);
    }
    EXPECT_EQ(desk.calls.size(), before + 10);
}

TEST(DdsCommands, a_stale_stamp_is_refused_by_the_senders_own_clock) {
    Desk desk;
    const Origin origin = desk.from("a", 1ms, 3600s);
    desk.desk.force(origin, {.frame = "", .stamp_ns = origin.written_ns - 2'000'000'000}, {1, 0, 0}, {},
                    false);
    EXPECT_TRUE(desk.calls.empty());
    EXPECT_TRUE(says(desk, "header.stamp is 2 s older than its sending"));
    desk.desk.force(origin, {.frame = "", .stamp_ns = 0}, {1, 0, 0}, {}, false);
    EXPECT_EQ(desk.calls.size(), 1u);
}

TEST(DdsCommands, one_peer_commands_a_force_at_a_time_and_the_other_is_told) {
    Desk desk;
    desk.push(desk.from("a"), 1);
    desk.push(desk.from("b"), 2);
    EXPECT_EQ(desk.calls, (Calls{"dds a: push 1 0 0"}));
    EXPECT_TRUE(says(desk, "'right' is commanded by a; one at a time"));
    desk.pass(501ms);
    desk.push(desk.from("b"), 2);
    EXPECT_EQ(desk.calls.size(), 2u) << "a has fallen silent";
    desk.desk.gone("b");
    desk.push(desk.from("a"), 1);
    EXPECT_EQ(desk.calls.back(), "dds a: push 1 0 0") << "at once, since b is gone";
}

TEST(DdsCommands, what_a_peer_held_is_released_when_it_is_gone) {
    Desk desk;
    desk.push(desk.from("a"), 1);
    ASSERT_EQ(desk.desk.peers(), (std::vector<std::string>{"a"}));
    desk.desk.gone("a");
    EXPECT_EQ(desk.calls.back(), "dds a: released");
    EXPECT_TRUE(desk.desk.peers().empty());
    EXPECT_TRUE(says(desk, "a has gone"));
}

TEST(DdsCommands, only_hosts_that_the_configuration_names_may_command) {
    Desk desk([](CommandOptions& options) { options.from = {"desk", "planner"}; });
    desk.push(desk.from("a"), 1);
    EXPECT_TRUE(desk.calls.empty());
    EXPECT_TRUE(says(desk, "is not from a host that may command 'right' (desk, planner)"));
    desk.desk.word(desk.from("a"), "disable");
    EXPECT_EQ(desk.desk.state(), "ENABLED");
    Origin named = desk.from("b");
    named.host = "planner";
    desk.push(named, 1);
    EXPECT_EQ(desk.calls.size(), 1u);
}

TEST(DdsCommands, state_commands_have_crtks_meaning) {
    Desk desk([](CommandOptions& options) { options.enabled = false; });
    EXPECT_EQ(desk.desk.state(), "DISABLED");
    desk.push(desk.from("a"), 1);
    EXPECT_TRUE(desk.calls.empty());
    EXPECT_TRUE(says(desk, "send state_command 'enable' first"));
    desk.desk.word(desk.from("a"), "enable");
    EXPECT_EQ(desk.desk.state(), "ENABLED");
    desk.push(desk.from("a"), 1);
    desk.desk.word(desk.from("a"), "pause");
    EXPECT_EQ(desk.desk.state(), "PAUSED");
    EXPECT_EQ(desk.calls.back(), "dds a: released");
    desk.push(desk.from("a"), 1);
    EXPECT_EQ(desk.calls.back(), "dds a: released");
    desk.desk.word(desk.from("a"), "resume");
    EXPECT_EQ(desk.desk.state(), "ENABLED");
    desk.desk.word(desk.from("a"), "enabel");
    EXPECT_TRUE(says(desk, "did you mean 'enable'?"));
    Report fault;
    fault.state = DeviceState::fault;
    desk.desk.look(fault);
    EXPECT_EQ(desk.desk.state(), "FAULT");
    desk.desk.word(desk.from("a"), "enable");
    EXPECT_TRUE(says(desk, "is in fault; reset it on its host"));
    desk.desk.look_away();
    EXPECT_EQ(desk.desk.state(), "ENABLED") << "an old fault is no state";
}

TEST(DdsCommands, hold_lasts_until_something_else_is_commanded) {
    Desk desk;
    desk.desk.hold(desk.from("a"));
    desk.desk.tick();
    desk.desk.tick();
    EXPECT_EQ(desk.calls, (Calls{"dds a: pull 0.1", "dds a: pull 0.1", "dds a: pull 0.1"}));
    desk.push(desk.from("a"), 1);
    desk.desk.tick();
    EXPECT_EQ(desk.calls.back(), "dds a: push 1 0 0");
    desk.desk.hold(desk.from("a"));
    desk.desk.free(desk.from("a"));
    desk.desk.tick();
    EXPECT_EQ(desk.calls.back(), "dds a: push 0 0 0");
}

std::vector<std::byte> bytes_of(const Plane& plane) {
    std::vector<std::byte> bytes(sizeof plane);
    std::memcpy(bytes.data(), &plane, sizeof plane);
    return bytes;
}

TEST(DdsCommands, one_message_makes_a_wall_and_the_next_moves_it) {
    Desk desk;
    const auto put = [&](const std::string& id, const Plane& plane) {
        const Origin origin = desk.from("a");
        desk.desk.put(origin, desk.at(origin), id, 0, kind_number<Plane>(), bytes_of(plane));
    };
    put("floor", {.normal = {0, 0, 1}, .stiffness = 800});
    put("floor", {.normal = {0, 0, 1}, .offset = 0.01, .stiffness = 800});
    EXPECT_EQ(desk.calls, (Calls{"dds a: add plane:floor", "dds a: set plane:floor"}));
    put("floor", {.normal = {0, 0, 0}, .stiffness = 800});
    EXPECT_TRUE(says(desk, "plane.normal = ")) << (desk.lines.empty() ? "" : desk.lines.back());
    desk.desk.remove(desk.from("a"), "ceiling");
    EXPECT_TRUE(says(desk, "it has added nothing with the id 'ceiling'"));
    desk.desk.remove(desk.from("a"), "floor");
    EXPECT_EQ(desk.calls.back(), "dds a: remove plane:floor");
    put(std::string(65, 'x'), {.normal = {0, 0, 1}});
    EXPECT_TRUE(says(desk, "its id has 65 bytes"));
}

TEST(DdsCommands, no_number_of_peers_makes_more_claims_than_there_is_room_for) {
    Desk desk;
    for (int i = 0; i < 100; ++i) {
        desk.pass(1s);
        desk.push(desk.from("peer " + std::to_string(i)), 1);
    }
    EXPECT_EQ(desk.desk.peers().size(), CommandDesk::most_peers);
    EXPECT_TRUE(says(desk, "peers command 'right' already"));
}

}  // namespace
