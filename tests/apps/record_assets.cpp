// Meshes in recordings: what an application sent is in the file, once, and replays to the last bit.

#include <csignal>
#include <cstring>
#include <fstream>

#include <generators.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>
#include <knurl/reps/shape.hpp>

#include "program.hpp"

namespace knurl::test::record_assets_tests {
namespace {

using namespace std::chrono_literals;
using json = knurl::Json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* device = "sim:premium15,tremor=0.3";

/// An application that moves a ball under the hand.
class Ball {
  public:
    explicit Ball(int level = 4, double radius = 0.1)
        : client_(Client::connect("knurl:default")), claim_(client_.claim("premium15")), radius_(radius) {
        send(level);
        EXPECT_TRUE(eventually([this] { return arm(); }));
    }
    /// Replaces the ball by another one with the same number.
    void send_again(int level) {
        shape_->remove();
        claim_.forget(params_.asset);
        ASSERT_TRUE(eventually([&] {
            claim_.commit();
            try {
                send(level);
                return true;
            } catch (const Error&) {  // the servo still has the old one
                return false;
            }
        }));
    }
    void feel(int reports) {
        int seen = 0;
        for (int felt = 0; felt < reports; ++seen) {
            const auto report = claim_.next_report(5s);
            ASSERT_TRUE(report && seen < 60'000) << "nothing is felt";
            if (report->state == DeviceState::active && report->scene_force.z > 0) ++felt;
            if (report->cycle % 50 != 0) continue;
            // If a busy machine stood still, the device is off.
            if (report->state == DeviceState::idle || report->state == DeviceState::fault) arm();
            params_.position.z = -radius_ + (report->cycle % 100 == 0 ? 2e-3 : 3e-3);
            shape_->set(params_);
            claim_.commit();
        }
    }

  private:
    bool arm() {
        try {
            const auto report = claim_.latest();
            if (report && report->state == DeviceState::fault) claim_.reset_fault();
            claim_.arm();
            return true;
        } catch (const Error&) {  // the machine stands still
            return false;
        }
    }
    void send(int level) {
        const MadeMesh mesh = icosphere(level, radius_);
        params_ = {
            .asset =
                claim_.send({.vertices = mesh.vertices, .triangles = mesh.triangles, .materials = {}}).asset,
            .position = {0, 0, -radius_ - 0.004},
            .stiffness = 500};
        shape_.emplace(claim_.add(params_));
        // It begins below the hand, since a shape that begins around the hand gives no force.
        if (!claim_.wait_applied(claim_.commit(), 5s)) ADD_FAILURE() << "the ball is not there";
    }

    Client client_;
    Claim claim_;
    double radius_;
    Shape params_;
    std::optional<Handle<Shape>> shape_;
};

/// A recording of two applications, one after the other. The second has the first one's ball and two more,
/// one of which replaces another.
const std::string& recording() {
    struct Made {
        Home home;
        std::string path = home.path("balls.mcap");
        Made() {
            Servo servo({"--device", device});
            Background recorder({knurl_program(), "record", path});
            EXPECT_TRUE(recorder.says("recording device"));
            Ball().feel(500);
            EXPECT_TRUE(eventually([] {
                try {
                    Ball ball;
                    ball.feel(300);
                    ball.send_again(3);
                    ball.feel(300);
                    return true;
                } catch (const Error&) {  // the device is still held
                    return false;
                }
            }));
            EXPECT_EQ(recorder.end(SIGINT), 0);
            EXPECT_THAT(recorder.said(), HasSubstr("replay exactly"));
            EXPECT_THAT(recorder.said(), Not(HasSubstr("gap")));
            EXPECT_THAT(recorder.said(), Not(HasSubstr("missing")));
        }
    };
    static const Made made;
    return made.path;
}

TEST(RecordAssets, WhatWasFeltOfAMeshReplaysToTheLastBit) {
    const Outcome outcome = knurl({"replay", recording()});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("equal to the last bit"));
    EXPECT_GT(number_before(outcome.out, " cycles replayed"), 2000);
    EXPECT_EQ(outcome.err, "");
    const Home home;
    const std::string csv = home.path("balls.csv");
    EXPECT_EQ(knurl({"replay", recording(), "--csv", csv}).code, 0);
    EXPECT_EQ(
        knurl({"replay", recording(), "--scene", home.file("s.toml", "[[plane]]\nstiffness = 300\n")}).code,
        0);
}

TEST(RecordAssets, EachIsInTheFileOnceForReadersThatAreNotOurs) {
    const Outcome outcome = run({"/usr/bin/env", "python3", KNURL_READ_MCAP ".py", recording()});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json found = json::parse(outcome.out).at("attachments");
    EXPECT_EQ(found.size(), 2u) << found;
    for (const auto& [name, what] : found.items()) {
        EXPECT_EQ(name, "asset-" + what.at("sha256").get<std::string>());
        EXPECT_EQ(what.at("media_type"), "application/x-knurl-asset");
    }
    const char* modules = std::getenv("KNURL_MCAP_MODULES");
    if (modules == nullptr) GTEST_SKIP() << "MCAP's own reader is not there (KNURL_MCAP_MODULES)";
    ::setenv("NODE_PATH", modules, 1);
    const Outcome theirs = run({"/usr/bin/env", "node", KNURL_READ_MCAP ".js", recording()});
    ASSERT_EQ(theirs.code, 0) << theirs.err;
    const json attachments = json::parse(theirs.out).at("attachments");
    EXPECT_EQ(attachments.size(), 2u);
    for (const auto& [name, bytes] : attachments.items()) EXPECT_EQ(bytes, found.at(name).at("bytes"));
}

TEST(RecordAssets, ARecordingThatBeginsInMidContactReplaysFromTheNextApplicationOn) {
    const Home home;
    Servo servo({"--device", device});
    std::optional<Ball> first(std::in_place);
    first->feel(100);
    Background recorder({knurl_program(), "record", home.path("late.mcap")});
    ASSERT_TRUE(recorder.says("an application holds the device"));
    first->feel(200);
    first->send_again(3);
    first->feel(100);
    first.reset();
    {  // waits until the last force has faded, so that nobody holds the device
        Client client = Client::connect("knurl:default");
        Observer observer = client.observe("premium15");
        for (int i = 0; i < 300; ++i) ASSERT_TRUE(observer.next_report(5s));
    }
    std::optional<Ball> second;
    ASSERT_TRUE(eventually([&] {
        try {
            second.emplace();
        } catch (const Error&) {
        }
        return second.has_value();
    }));
    second->feel(400);
    EXPECT_EQ(recorder.end(SIGINT), 0);
    const Outcome replayed = knurl({"replay", home.path("late.mcap")});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_GT(number_before(replayed.out, " cycles replayed"), 400);
    EXPECT_EQ(replayed.err, "");
}

TEST(RecordAssets, OneThatDoesNotFitOnTheDiskIsCountedAndNamed) {
    const Home home;
    Servo servo({"--device", device});
    const std::string path = home.path("full.mcap");
    // A limit on the file's size represents a full disk: 1 MiB in blocks of 1 KiB; the mesh takes 2.3.
    Background recorder(
        {"/bin/bash", "-c", "ulimit -f 1024; exec \"$0\" record \"$1\"", knurl_program(), path});
    ASSERT_TRUE(recorder.says("recording device"));
    Ball(1).feel(1200);  // more than a second, so that the file has a chunk at which a replay can begin
    Ball(6).feel(100);
    EXPECT_EQ(recorder.end(SIGINT), 1);
    EXPECT_THAT(recorder.said(), HasSubstr("dropping what does not fit"));
    EXPECT_THAT(recorder.said(), HasSubstr("1 shape that was felt is missing"));
    EXPECT_THAT(recorder.said(), HasSubstr("gap"));
    const Outcome replayed = knurl({"replay", path});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_THAT(replayed.out, HasSubstr("gap"));
    const Outcome read = run({"/usr/bin/env", "python3", KNURL_READ_MCAP ".py", path});
    ASSERT_EQ(read.code, 0) << read.err;
    const json missing = json::parse(read.out).at("metadata").at("knurl missing");
    ASSERT_EQ(missing.size(), 1u);
    EXPECT_THAT(missing.items().front().key, testing::StartsWith("asset-"));
}

TEST(RecordAssets, OneThatWasTakenOutOrChangedIsSaid) {
    const Home home;
    const std::string all = text_of_file(recording());
    const std::size_t name = all.find("asset-");
    ASSERT_NE(name, std::string::npos);
    std::string changed = all;
    changed[name + 2000] ^= 1;
    const Outcome bytes = knurl({"replay", home.file("changed.mcap", changed)});
    EXPECT_EQ(bytes.code, 1);
    EXPECT_THAT(bytes.err, HasSubstr("changed"));
    // Its record begins with operation, length and two times: the changed operation is unknown.
    changed = all;
    changed[name - 4 - 16 - 8 - 1] = '\x7f';
    const Outcome gone = knurl({"replay", home.file("gone.mcap", changed)});
    EXPECT_EQ(gone.code, 1);
    EXPECT_THAT(gone.err, HasSubstr("which is not in the recording"));
    EXPECT_EQ(std::count(gone.err.begin(), gone.err.end(), '\n'), 1) << gone.err;
}

}  // namespace
}  // namespace knurl::test::record_assets_tests
