// knurl-web beside a servo and an application, and peers of Foxglove's protocol that are not ours: what they decode is what
// the servo reported.

#include <csignal>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>
#include <knurl/reps/capsule.hpp>
#include <knurl/reps/spring.hpp>

#include "../apps/program.hpp"

namespace knurl::test {
namespace {

/// A servo, an application that holds its device, knurl-web, and a recording of all.
struct FoxgloveLive : testing::Test {
    FoxgloveLive()
        : servo({"--device", "right=sim:premium15,tremor=0.3"}),
          recorder({knurl_program(), "record", home.path("live.mcap")}),
          web({KNURL_WEB, "--listen", "127.0.0.1:0", "--no-inverse"}) {
        EXPECT_TRUE(recorder.says("recording device"));
        EXPECT_TRUE(web.says("/foxglove"));
        client.emplace(Client::connect("knurl:default"));
        claim.emplace(client->claim("right"));
        claim->add(Plane{.offset = 2e-3, .stiffness = 500});
        claim->add(Spring{.anchor = {0.02, 0, 0}, .stiffness = 30});
        claim->add(Capsule{.center = {0, 0.04, 0}, .half_length = 0.02, .radius = 0.01, .stiffness = 500});
        claim->arm();
    }
    std::string port() const {
        const std::string& said = web.said();
        const std::size_t at = said.find("ws://127.0.0.1:") + 15;
        return said.substr(at, said.find('/', at) - at);
    }
    /// Runs a peer; the output of client.py or client.js.
    Outcome peer(const std::vector<std::string>& program, const std::string& subprotocol) {
        std::vector<std::string> words{"/usr/bin/env"};
        words.insert(words.end(), program.begin(), program.end());
        words.insert(words.end(), {"127.0.0.1", port(), subprotocol, "20", "/foxglove"});
        return run(words);
    }
    /// The servo's own reports, by cycle: the row of `knurl replay --csv`.
    std::map<std::uint64_t, std::map<std::string, double>> reports() {
        EXPECT_EQ(recorder.end(SIGINT), 0) << recorder.said();
        const Outcome replayed = knurl({"replay", home.path("live.mcap"), "--csv", home.path("live.csv")});
        EXPECT_EQ(replayed.code, 0) << replayed.err;
        std::istringstream csv(text_of_file(home.path("live.csv")));
        std::vector<std::string> names;
        std::map<std::uint64_t, std::map<std::string, double>> rows;
        for (std::string line; std::getline(csv, line);) {
            std::istringstream cells(line);
            std::vector<std::string> row;
            for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
            if (names.empty()) {
                names = row;
                continue;
            }
            auto& values = rows[std::stoull(row.at(0))];
            for (std::size_t i = 0; i < names.size(); ++i) values[names[i]] = std::atof(row.at(i).c_str());
        }
        return rows;
    }
    void check(const Json& seen, const std::string& subprotocol);

    Home home;
    Servo servo;
    Background recorder, web;
    std::optional<Client> client;
    std::optional<Claim> claim;
};

/// A time: client.js gives texts, since a number of JavaScript has not so many digits.
std::string time_of(const Json& message) {
    return message[0].is_string() ? message[0].get<std::string>()
                                  : std::to_string(message[0].get<std::int64_t>());
}

void expect_vector(const Json& found, const std::map<std::string, double>& row, const std::string& prefix) {
    for (const std::string axis : {"x", "y", "z"})
        ASSERT_EQ(found.at(axis).get<double>(), row.at(prefix + axis)) << prefix << axis;
}

void FoxgloveLive::check(const Json& seen, const std::string& subprotocol) {
    EXPECT_EQ(seen.at("subprotocol"), subprotocol);
    EXPECT_TRUE(seen.at("statuses").empty()) << seen.at("statuses");
    EXPECT_EQ(seen.at("schemas").at("/right/measured_cp"), "geometry_msgs/msg/PoseStamped");
    const auto rows = reports();
    const Json& messages = seen.at("messages");
    std::map<std::string, std::uint64_t> cycles;  // by time
    std::uint64_t last = 0;
    for (const Json& message : messages.at("/right/report")) {
        const Json& report = message[1];
        const auto cycle = report.at("cycle").get<std::uint64_t>();
        ASSERT_TRUE(last == 0 || cycle == last + 1) << "every report";
        last = cycle;
        cycles[time_of(message)] = cycle;
        const auto row = rows.find(cycle);
        ASSERT_NE(row, rows.end()) << cycle;
        expect_vector(report.at("position"), row->second, "");
        expect_vector(report.at("velocity"), row->second, "v");
        expect_vector(report.at("sent_force"), row->second, "sent_f");
        ASSERT_EQ(report.at("joints")[1].get<double>(), row->second.at("q1"));
        ASSERT_EQ(report.at("state").get<double>(), row->second.at("state"));
    }
    const auto each = [&](const std::string& topic, auto compare) {
        std::size_t compared = 0;
        for (const Json& message : messages.at(topic)) {
            const auto cycle = cycles.find(time_of(message));
            if (cycle == cycles.end()) continue;  // before the first report
            compare(message[1], rows.at(cycle->second));
            ++compared;
        }
        EXPECT_GE(compared, 10u) << topic;
    };
    using Row = std::map<std::string, double>;
    each("/right/measured_cp", [](const Json& pose, const Row& row) {
        expect_vector(pose.at("pose").at("position"), row, "");
        ASSERT_EQ(pose.at("pose").at("orientation").at("w").get<double>(), row.at("qw"));
        ASSERT_EQ(pose.at("header").at("frame_id"), "right_base");
    });
    each("/right/measured_cf", [](const Json& wrench, const Row& row) {
        expect_vector(wrench.at("wrench").at("force"), row, "sent_f");
    });
    each("/right/measured_cv",
         [](const Json& twist, const Row& row) { expect_vector(twist.at("twist").at("linear"), row, "v"); });
    each("/right/measured_js", [](const Json& joints, const Row& row) {
        ASSERT_EQ(joints.at("position").size(), 3u);
        ASSERT_EQ(joints.at("position")[2].get<double>(), row.at("q2"));
    });
    each("/tf", [](const Json& tree, const Row& row) {
        expect_vector(tree.at("transforms")[0].at("transform").at("translation"), row, "");
        ASSERT_EQ(tree.at("transforms")[0].at("child_frame_id"), "right_hand");
    });
    // Patch of the plane, line and end of the spring, three parts of the capsule.
    std::set<int> types;
    for (const Json& message : messages.at("/right/scene"))
        for (const Json& marker : message[1].at("markers"))
            if (marker.at("action") == 0) types.insert(marker.at("type").get<int>());
    EXPECT_EQ(types, (std::set<int>{1, 2, 3, 5}));
    EXPECT_EQ(messages.at("/right/parameters")[0][1].at("device").at("name"), "right");
    EXPECT_EQ(messages.at("/diagnostics")[0][1].at("status")[0].at("name"), "knurl: right");
}

TEST_F(FoxgloveLive, APeerInPythonDecodesWhatTheServoReported) {
    const Outcome outcome = peer({"python3", KNURL_FOXGLOVE_CLIENT ".py"}, "foxglove.sdk.v1");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    check(Json::parse(outcome.out), "foxglove.sdk.v1");
}

TEST_F(FoxgloveLive, FoxglovesOwnClientDecodesWhatTheServoReported) {
    const char* modules = std::getenv("KNURL_MCAP_MODULES");
    if (modules == nullptr) GTEST_SKIP() << "Foxglove's client is not there (KNURL_MCAP_MODULES)";
    ::setenv("NODE_PATH", modules, 1);
    const Outcome outcome = peer({"node", KNURL_FOXGLOVE_CLIENT ".js"}, "foxglove.websocket.v1");
    if (outcome.code == 77) GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    check(Json::parse(outcome.out), "foxglove.websocket.v1");
}

TEST_F(FoxgloveLive, AnotherSubprotocolIsRefused) {
    const Outcome outcome = peer({"python3", KNURL_FOXGLOVE_CLIENT ".py"}, "foxglove.other");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out).at("status"), 400);
}

}  // namespace
}  // namespace knurl::test
