// An atom of one program and a wall of another on one device, as two people would start them. Either program
// is killed while the other exerts force.

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>

#include "fake_imd.hpp"
#include "program.hpp"

namespace dock_shared_tests {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using knurl::to_eigen;
using knurl::test::Background;
using knurl::test::FakeImd;
using knurl::test::Home;
using knurl::test::Servo;

constexpr double most_step = 0.1;  // N in a cycle

bool is_let_go(const FakeImd::Forces& forces) {
    return forces.size() == 1 && forces.begin()->second == std::array<float, 3>{};
}

/// The part of a claim's reports that comes from others.
struct Part {
    std::uint64_t cycle = 0;
    std::int64_t read_ns = 0;
    Vector3d force = Vector3d::Zero();
};

/// The largest change between consecutive cycles. A late cycle does not count, since the hand moved on while
/// the machine stood still.
class Steps {
  public:
    void see(const Part& part) {
        const bool next = part.cycle == last_.cycle + 1 && part.read_ns - last_.read_ns < 2'000'000;
        if (next) {
            most_ = std::max(most_, (part.force - last_.force).norm());
            ++count_;
        }
        last_ = part;
    }
    double most() const { return most_; }
    int count() const { return count_; }

  private:
    Part last_;
    double most_ = 0;
    int count_ = 0;
};

class DockShared : public testing::Test {
  protected:
    DockShared() {
        // Moves back and forth over 30 mm in 2 s, and presses into the wall all the time.
        std::ofstream path(home_.path("hand.csv"));
        path << "t,x,y,z\n";
        for (int i = 0; i < 60'000; ++i)
            path << 0.01 * i << ',' << 0.015 * (1 - std::cos(M_PI * 0.01 * i)) << ",0,-0.015\n";
        path.close();
        servo_.emplace(
            std::vector<std::string>{"--device", "sim:premium15", "--hand", home_.path("hand.csv")});
    }
    /// Holds an atom that hardly gives way, so that the spring pulls as far as the hand moves.
    Background dock() {
        return Background({KNURL_DOCK_PROGRAM, simulation_.address(), "--share", "--at-once", "--atom", "4",
                           "--csv", home_.path("dock.csv"), "--json", home_.path("dock.json"), "--wait",
                           "30"});
    }
    knurl::Client connect() { return knurl::Client::connect("knurl:default", {.name = "test", .wait = 20s}); }

    /// A wall of this process, which shares the device with the others.
    struct Wall {
        explicit Wall(knurl::Client& client)
            : hand(client.claim("", {.shared = true})),
              plane(hand.add(knurl::Plane{.normal = {0, 0, 1},
                                          .offset = hand.device().workspace_centre.z - 0.01,
                                          .stiffness = 800})) {
            hand.arm();
        }
        /// Reads the next report. Returns the others' part of it; empty if there is no feedback of the same
        /// cycle.
        std::optional<Part> others() {
            report = hand.next_report(10s);
            hand.commit();
            const auto felt = plane.feedback();
            if (!report || !felt || felt->cycle != report->cycle) return std::nullopt;
            own = felt->share * to_eigen(felt->force);
            return Part{report->cycle, report->read_ns, to_eigen(report->scene_force) - own};
        }
        knurl::Claim hand;
        knurl::Handle<knurl::Plane> plane;
        std::optional<knurl::HandReport> report;
        Vector3d own = Vector3d::Zero();
    };
    /// Reads reports until `so` is true, for at most a minute.
    static bool reads_until(Wall& wall, const std::function<bool(const Part&)>& so) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (std::chrono::steady_clock::now() < end) {
            const auto part = wall.others();
            if (part && so(*part)) return true;
        }
        return false;
    }

    const Home home_;
    // Pauses at the first frame, so that the hand has moved on when it arrives.
    FakeImd simulation_{{.mobility = 1e-6, .pause_at = 0}};
    std::optional<Servo> servo_;
};

bool pulls(const Part& part) {
    return part.force.norm() > 0.8 && part.force.norm() < 1.6;
}

TEST_F(DockShared, TheHandFeelsTheSumOfBoth) {
    auto client = connect();
    Wall wall(client);
    Background program = dock();
    std::map<std::uint64_t, Vector3d> others;
    int both = 0;
    ASSERT_TRUE(reads_until(wall, [&](const Part& part) {
        others[part.cycle] = part.force;
        both += part.force.norm() > 0.5 && wall.own.norm() > 0.3;
        return both >= 2000;
    })) << program.said();
    EXPECT_EQ(program.end(SIGINT), 0) << program.said();
    const auto figures = knurl::Json::parse(knurl::test::text_of_file(home_.path("dock.json")));
    EXPECT_LE(figures["end_step"], most_step) << "N in a cycle, from the first on";
    // knurl-dock's own record of its spring, cycle by cycle.
    std::ifstream csv(home_.path("dock.csv"));
    std::string line;
    std::getline(csv, line);
    ASSERT_EQ(line,
              "t,hand_x,hand_y,hand_z,fx,fy,fz,atom_x,atom_y,atom_z,push_x,push_y,push_z,frame,cycle,told");
    int compared = 0;
    while (std::getline(csv, line)) {
        std::istringstream words(line);
        std::vector<double> row;
        for (std::string word; std::getline(words, word, ',');) row.push_back(std::stod(word));
        const auto found = others.find(static_cast<std::uint64_t>(row[14]));
        if (row[15] == 0 || found == others.end()) continue;
        ASSERT_NEAR((Vector3d(row[4], row[5], row[6]) - found->second).norm(), 0, 1e-6)
            << "cycle " << row[14];
        compared += found->second.norm() > 0.5;
    }
    EXPECT_GT(compared, 50);
}

TEST_F(DockShared, TheWallStaysWhenTheMoleculesProgramEndsHowever) {
    auto client = connect();
    Wall wall(client);
    for (const int signal : {SIGKILL, SIGTERM, SIGINT}) {
        SCOPED_TRACE(signal);
        FakeImd simulation({.mobility = 1e-6});
        Background program({KNURL_DOCK_PROGRAM, simulation.address(), "--share", "--at-once", "--atom", "4",
                            "--wait", "30"});
        ASSERT_TRUE(reads_until(wall, pulls)) << program.said();
        ::kill(program.pid(), signal);
        Steps steps;
        ASSERT_TRUE(reads_until(wall, [&](const Part& part) {
            steps.see(part);
            return part.force.norm() < 1e-12;
        })) << "its spring goes";
        EXPECT_GT(steps.count(), 10);
        EXPECT_LE(steps.most(), most_step) << "N in a cycle";
        EXPECT_EQ(program.end(0), signal == SIGKILL ? 128 + SIGKILL : 0);
        EXPECT_TRUE(simulation.eventually_gone());
        EXPECT_TRUE(simulation.eventually_pulled(is_let_go)) << "the engine was told to let go of the atom";
        int touched = 0;
        ASSERT_TRUE(reads_until(wall, [&](const Part& part) {
            EXPECT_LT(part.force.norm(), 1e-12);
            touched += wall.own.z() > 0.3;
            return touched >= 300;
        }));
        EXPECT_EQ(wall.report->state, knurl::DeviceState::active);
        EXPECT_EQ(wall.report->faults, 0u);
    }
}

TEST_F(DockShared, TheMoleculeStaysWhenTheWallsProgramIsKilled) {
    for (const int signal : {SIGKILL, SIGTERM}) {
        SCOPED_TRACE(signal);
        Background wall({KNURL_BESIDE_PROGRAM, "--seconds", "600"});
        ASSERT_TRUE(wall.says("the floor is there")) << wall.said();
        FakeImd simulation({.mobility = 1e-6});
        Background program({KNURL_DOCK_PROGRAM, simulation.address(), "--share", "--at-once", "--atom", "4",
                            "--json", home_.path("dock.json"), "--wait", "30"});
        auto client = connect();
        auto watch = client.observe();
        const auto reads_until = [&](const auto& so) {
            const auto end = std::chrono::steady_clock::now() + 60s;
            while (std::chrono::steady_clock::now() < end) {
                const auto report = watch.next_report(10s);
                if (report &&
                    so(*report, Part{report->cycle, report->read_ns, to_eigen(report->scene_force)}))
                    return true;
            }
            return false;
        };
        const auto along = [](const Part& part) { return std::abs(part.force.x()); };
        ASSERT_TRUE(reads_until([&](const auto& report, const Part& part) {
            return report.state == knurl::DeviceState::active && along(part) > 0.8 && along(part) < 1.6 &&
                   part.force.z() > 0.3;
        })) << program.said();
        ::kill(wall.pid(), signal);
        Steps steps;
        int alone = 0;
        const double below = watch.device().workspace_centre.z - 0.0115;
        // Waits until the hand is deeper than the floor alone would permit, because the atom pulls it.
        EXPECT_TRUE(reads_until([&](const auto& report, const Part& part) {
            steps.see(part);
            EXPECT_EQ(report.state, knurl::DeviceState::active);
            alone += report.position.z < below && along(part) > 0.8;
            return alone >= 300 || report.faults != 0;
        }));
        EXPECT_GT(steps.count(), 100);
        EXPECT_LE(steps.most(), most_step) << "N in a cycle";
        EXPECT_TRUE(simulation.eventually_pulled(
            [](const FakeImd::Forces& forces) { return !forces.empty() && !is_let_go(forces); }));
        wall.end(0);
        EXPECT_EQ(program.end(SIGINT), 0) << program.said();
        const auto figures = knurl::Json::parse(knurl::test::text_of_file(home_.path("dock.json")));
        EXPECT_EQ(figures["faults"], 0);
        EXPECT_TRUE(figures["ended"].is_null()) << figures["ended"].dump();
    }
}

TEST_F(DockShared, SharingIsForThoseWhoBothSaySo) {
    auto client = connect();
    const auto hand = client.claim();
    Background program = dock();
    EXPECT_TRUE(program.says("held")) << program.said();
    EXPECT_EQ(program.end(0), 1);
}

}  // namespace

}  // namespace dock_shared_tests
