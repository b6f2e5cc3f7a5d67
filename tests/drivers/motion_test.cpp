// Motion files: which are read, which are refused and how, and a motion's place between its rows.

#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/motion_device.hpp>

#include "../refusal.hpp"
#include "../temp_folder.hpp"

namespace knurl::drivers {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::string refusal(const std::string& text) {
    return test::refusal_of([&] { parse_motion(text, "m.csv"); });
}

TEST(MotionFile, HasAnOptionalHeaderCommentsAndBlankLines) {
    const Motion with = parse_motion("t,x,y,z\r\n# a stroke\n0,1,2,3\n\n 0.5 , 1.5,2 ,+3e0 \n", "m.csv");
    const Motion without = parse_motion("0,1,2,3\n0.5,1.5,2,3", "m.csv");
    for (const Motion& motion : {with, without}) {
        ASSERT_EQ(motion.rows().size(), 2U);
        EXPECT_FALSE(motion.has_orientation());
        EXPECT_EQ(motion.end(), 0.5);
        EXPECT_EQ(motion.rows()[1].position, Vector3d(1.5, 2, 3));
    }
    const Motion turned = parse_motion("t,x,y,z,qw,qx,qy,qz\n0,0,0,0,2,0,0,0\n", "m.csv");
    EXPECT_TRUE(turned.has_orientation());
    EXPECT_EQ(turned.rows()[0].orientation.w(), 1) << "quaternions are normalised";
}

TEST(MotionFile, SaysLineColumnAndWhatToDo) {
    EXPECT_EQ(refusal(""), "m.csv:1: no rows; give lines of t,x,y,z (s, m), at least one");
    EXPECT_EQ(refusal("t,x,y,z\n"), "m.csv:1: no rows; give lines of t,x,y,z (s, m), at least one");
    EXPECT_EQ(refusal("0,0,0\n"), "m.csv:1: 3 columns; give t,x,y,z or t,x,y,z,qw,qx,qy,qz");
    EXPECT_EQ(refusal("hello\n"), "m.csv:1: 1 column; give t,x,y,z or t,x,y,z,qw,qx,qy,qz");
    EXPECT_EQ(refusal("0,0,0,0\n1,0,0,0,1,0,0,0\n"), "m.csv:2: 8 columns; give 4 columns, as above");
    EXPECT_EQ(refusal("t,x,y,z,qw,qx,qy,qz\n1,0,0,0\n"), "m.csv:2: 4 columns; give 8 columns, as above");
    EXPECT_EQ(refusal("0,0,0,0\n1,0,zero,0\n"),
              "m.csv:2: column 3 (y): \"zero\" is not a number; write seconds and metres, such as 0.25");
    EXPECT_EQ(refusal("0,0,0,1 mm\n"),
              "m.csv:1: column 4 (z): \"1 mm\" is not a number; write seconds and metres, such as 0.25");
    EXPECT_EQ(refusal("0,,0,0\n"),
              "m.csv:1: column 2 (x): \"\" is not a number; write seconds and metres, such as 0.25");
    EXPECT_EQ(refusal("t,x,y,z\n0,nan,0,0\n"),
              "m.csv:2: column 2 (x): \"nan\" is not finite; leave the row out or interpolate it");
    EXPECT_EQ(refusal("inf,0,0,0\n"),
              "m.csv:1: column 1 (t): \"inf\" is not finite; leave the row out or interpolate it");
    EXPECT_EQ(refusal("0,0,0,0\n0.2,0,0,0\n0.2,0,0,0\n"),
              "m.csv:3: column 1 (t): \"0.2\" is not after the row before; sort the rows by time, each once");
    EXPECT_EQ(refusal("0,0,0,0,0,0,0,0\n"),
              "m.csv:1: column 5 (qw): the quaternion has no length; no turn is 1,0,0,0");
    EXPECT_EQ(refusal("0,0,0,0,1e200,1e200,0,0\n"),
              "m.csv:1: column 5 (qw): the quaternion is longer than 1e6; divide it by its length");
    EXPECT_EQ(
        refusal("0,0,0,0\n5e-324,1,0,0\n"),
        "m.csv:2: column 1 (t): \"5e-324\" is less than 1 ns after the row before; leave one of them out");
    EXPECT_EQ(refusal("0,1e308,0,0\n1,-1e308,0,0\n"),
              "m.csv:1: column 2 (x): \"1e308\" is beyond 1e6 m; write metres");
    EXPECT_EQ(refusal("-2e9,0,0,0\n"),
              "m.csv:1: column 1 (t): \"-2e9\" is beyond 1e9 s; let the times begin at 0");
    EXPECT_EQ(refusal("0,\x1b[31m,0,0\n"),
              "m.csv:1: column 2 (x): \"?[31m\" is not a number; write seconds and metres, such as 0.25");
    EXPECT_EQ(refusal("t,z,y,x\n0,0,0,0\n"),
              "m.csv:1: column 1 (t): \"t\" is not a number; write seconds and metres, such as 0.25")
        << "a header in another order would swap axes silently";
}

TEST(MotionFile, IsReadFromDiskAndNamedWhenItCannotBe) {
    const test::TempFolder folder;
    const std::string path = folder.file("motion.csv", "0,1,2,3\n");
    EXPECT_EQ(load_motion(path).rows()[0].position, Vector3d(1, 2, 3));
    std::ofstream(path, std::ios::trunc).flush();
    const auto message = [](const std::string& name) -> std::string {
        return test::refusal_of([&] { load_motion(name); });
    };
    EXPECT_EQ(message(path), path + ":1: no rows; give lines of t,x,y,z (s, m), at least one");
    std::filesystem::remove(path);
    EXPECT_EQ(message(path), path +
                                 ": cannot read the motion: No such file or directory; name a CSV file of "
                                 "t,x,y,z[,qw,qx,qy,qz]");
    EXPECT_NE(message(folder.path().string()).find("cannot read the motion"), std::string::npos);
}

TEST(Motion, IsLinearBetweenRowsAndHasTheVelocityOfTheSegmentThatBegins) {
    const Motion motion = parse_motion("0,0,0,0\n1,1,0,0\n3,1,4,0\n", "m.csv");
    EXPECT_EQ(motion.sample(0.25).position, Vector3d(0.25, 0, 0));
    EXPECT_EQ(motion.sample(0.25).velocity, Vector3d(1, 0, 0));
    EXPECT_EQ(motion.sample(0).velocity, Vector3d(1, 0, 0));
    EXPECT_EQ(motion.sample(1).position, Vector3d(1, 0, 0));
    EXPECT_EQ(motion.sample(1).velocity, Vector3d(0, 2, 0)) << "at a row: of the segment that begins there";
    EXPECT_EQ(motion.sample(2).position, Vector3d(1, 2, 0));
    EXPECT_EQ(motion.sample(3).position, Vector3d(1, 4, 0));
    EXPECT_EQ(motion.sample(3).velocity, Vector3d(0, 2, 0))
        << "at the last row: of the segment that ends there";
}

TEST(Motion, RestsBeforeItsFirstRowAndAfterItsLast) {
    const Motion motion = parse_motion("1,1,0,0\n2,2,0,0\n", "m.csv");
    for (const double t : {-1.0, 0.999999, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(motion.sample(t).position, Vector3d(1, 0, 0));
        EXPECT_EQ(motion.sample(t).velocity, Vector3d(0, 0, 0));
    }
    EXPECT_EQ(motion.sample(2.000001).position, Vector3d(2, 0, 0));
    EXPECT_EQ(motion.sample(2.000001).velocity, Vector3d(0, 0, 0));
    const Motion point = parse_motion("1,1,2,3\n", "m.csv");
    EXPECT_EQ(point.sample(1).position, Vector3d(1, 2, 3));
    EXPECT_EQ(point.sample(1).velocity, Vector3d(0, 0, 0));
}

TEST(Motion, TurnsBySlerpAtAConstantRateTheShorterWay) {
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> one(-1, 1);
    const auto random_turn = [&] {
        return Quaterniond(one(engine), one(engine), one(engine), one(engine)).normalized();
    };
    for (int trial = 0; trial < 500; ++trial) {
        const Quaterniond a = random_turn(), b = random_turn();
        const Motion motion({{.t = 0, .orientation = a}, {.t = 2, .orientation = b}}, true);
        for (const double u : {0.0, 0.1, 0.5, 0.9}) {
            const MotionSample here = motion.sample(2 * u);
            const Quaterniond expected = a.slerp(u, b);  // of Eigen: by acos and sines, another formula
            EXPECT_NEAR(std::abs(here.orientation.dot(expected)), 1, 1e-14);
            // The rate, by central differences of the orientation: q' = w q / 2, in the motion's frame.
            constexpr double h = 1e-4;
            const Quaterniond next = motion.sample(2 * u + (u == 0 ? 2 * h : h)).orientation;
            const Quaterniond before = motion.sample(u == 0 ? 0 : 2 * u - h).orientation;
            const Quaterniond step = next * before.conjugate();
            const Vector3d rate = 2 * step.vec() * (step.w() < 0 ? -1 : 1) / (2 * h);
            EXPECT_LT((here.angular_velocity - rate).norm(), 1e-6);
        }
        EXPECT_LE(motion.sample(0).angular_velocity.norm(), 3.1416 / 2) << "never the longer way";
        EXPECT_EQ(motion.sample(2).orientation.coeffs(), motion.rows()[1].orientation.coeffs());
        EXPECT_EQ(motion.sample(0).orientation.coeffs(), motion.rows()[0].orientation.coeffs());
    }
    // A tiny turn keeps its digits.
    const Motion tiny = parse_motion("0,0,0,0,1,0,0,0\n1,0,0,0,1,1e-9,0,0\n", "m.csv");
    EXPECT_NEAR(tiny.sample(0).angular_velocity.x(), 2e-9, 1e-24);
}

TEST(Motion, HintChangesNothingButTheSearch) {
    std::vector<MotionRow> rows;
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> one(0.001, 1);
    for (double t = 0; rows.size() < 200; t += one(engine)) {
        rows.push_back({.t = t, .position = {one(engine), one(engine), one(engine)}});
    }
    const Motion motion(rows);
    std::size_t hint = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        const double t = trial % 7 == 0 ? rows[static_cast<std::size_t>(trial) % rows.size()].t
                                        : motion.end() * one(engine);
        EXPECT_EQ(motion.sample(t, hint).position, motion.sample(t).position);
        EXPECT_EQ(motion.sample(t, hint).velocity, motion.sample(t).velocity);
    }
}

TEST(MotionDevice, IsExactlyOnTheMotion) {
    // Rows at i/3000 s, which is no whole nanosecond.
    std::vector<MotionRow> rows;
    for (int i = 0; i <= 300; ++i) {
        rows.push_back({.t = i / 3000.0, .position = {std::sin(i * 0.1), i * 1e-3, 0}});
    }
    MotionDevice by_clock{Motion(rows)}, by_time{Motion(rows)};
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        JointSample clock, time;
        EXPECT_EQ(by_clock.read(std::llround(rows[i].t * 1e9), clock), ReadStatus::ok);
        by_time.at(rows[i].t);
        EXPECT_EQ(by_time.read(0, time), ReadStatus::ok);
        const Vector3d velocity = (rows[i + 1].position - rows[i].position) / (rows[i + 1].t - rows[i].t);
        for (const JointSample& sample : {clock, time}) {
            EXPECT_TRUE(sample.has_velocity);
            EXPECT_EQ(sample.position[0], rows[i].position.x());
            EXPECT_EQ(sample.position[1], rows[i].position.y());
            EXPECT_EQ(sample.velocity[0], velocity.x()) << "of the segment that begins at row " << i;
        }
    }
}

TEST(MotionDevice, GivesAngularVelocityAsItsLastThreeVelocities) {
    MotionDevice device(
        parse_motion("0,0,0,0,1,0,0,0\n1,0,0,0,0.7071067811865476,0,0,0.7071067811865476\n", "m"));
    JointSample sample;
    device.read(500'000'000, sample);
    EXPECT_NEAR(sample.velocity[5], 1.5707963267948966, 1e-15);
    EXPECT_NEAR(sample.position[3], std::cos(1.5707963267948966 / 4), 1e-15);
    TipPose pose;
    Jacobian jacobian;
    ASSERT_TRUE(device.mechanism().forward(sample.position, pose, jacobian));
    EXPECT_NEAR((jacobian * Eigen::Map<const Eigen::Matrix<double, 8, 1>>(sample.velocity.data()))[5],
                1.5707963267948966, 1e-15);
}

}  // namespace
}  // namespace knurl::drivers
