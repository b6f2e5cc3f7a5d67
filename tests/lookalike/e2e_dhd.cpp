// libdhd.so.3 and libdrd.so.3 against a servo.

#include <atomic>
#include <limits>
#include <thread>

#include "dhd.h"
#include "drd.h"
#include "served.hpp"

namespace lookalike_test {
namespace {

constexpr double exact = 1e-12;  // m

class Dhd : public Served {
  protected:
    using Served::Served;
    ~Dhd() override {
        dhdDisableExpertMode();
        while (dhdClose(-1) == 0) {
        }
    }
};

/// Sensed orientation and torque.
class DhdWrist : public Dhd {
  protected:
    DhdWrist() : Dhd("sim:generic6") {}
};

TEST_F(Dhd, the_devices_are_those_of_the_servo_in_its_order) {
    ASSERT_EQ(dhdGetDeviceCount(), 2);
    ASSERT_EQ(dhdOpen(), 0);
    EXPECT_STREQ(dhdGetSystemName(-1), "Knurl cartesian3");
    EXPECT_EQ(dhdOpen(), 1) << "the first is open already";
    EXPECT_STREQ(dhdGetSystemName(-1), "Knurl premium15");
    EXPECT_EQ(dhdGetDeviceID(), 1);
    EXPECT_EQ(dhdOpen(), -1);
    EXPECT_EQ(dhdErrorGetLast(), 5);
    EXPECT_EQ(dhdOpenID(0), 0) << "it is open, and the default now";
    EXPECT_EQ(dhdGetDeviceID(), 0);
    EXPECT_EQ(dhdGetSystemType(1), 33) << "three axes";
    EXPECT_EQ(dhdClose(0), 0);
    EXPECT_EQ(dhdClose(0), -1) << "twice";
    EXPECT_EQ(dhdErrorGetLast(), 12);
    EXPECT_EQ(dhdGetDeviceID(), 1);
    EXPECT_EQ(dhdSetDevice(0), -1);
}

TEST_F(Dhd, the_environment_names_devices_in_an_order_of_its_own) {
    ::setenv("KNURL_AS_DEVICES", "left,knurl:default/right", 1);
    ASSERT_EQ(dhdGetDeviceCount(), 2);
    ASSERT_EQ(dhdOpenID(1), 1);
    EXPECT_STREQ(dhdGetSystemName(1), "Knurl cartesian3");
    ASSERT_EQ(dhdOpenSerial(1), 0) << "a device without a serial number has its place's, from 1";
    EXPECT_STREQ(dhdGetSystemName(-1), "Knurl premium15");
    ::setenv("KNURL_AS_DEVICES", "middle", 1);
    EXPECT_EQ(dhdOpenID(2), -1);
    EXPECT_EQ(dhdErrorGetLast(), 5);
}

TEST_F(Dhd, the_position_of_a_moving_hand_is_one_that_the_servo_reported) {
    const Vec3 centre = right_->device().workspace_centre;
    ASSERT_EQ(dhdOpenID(0), 0);
    ASSERT_EQ(dhdEnableForce(1, 0), 0);
    ASSERT_TRUE(until(*right_, is_active, [] { dhdSetForce(0, 0, 0, 0); }));
    int moved = 0;
    Vec3 first{};
    for (int i = 0; i < 200; ++i) {
        while (right_->next_report(0ns)) {
        }
        std::vector<HandReport> seen{*right_->latest()};
        double x, y, z;
        ASSERT_EQ(dhdGetPosition(&x, &y, &z, 0), 0);
        if (const auto next = right_->next_report(1s)) seen.push_back(*next);
        while (const auto next = right_->next_report(0ns)) seen.push_back(*next);
        double nearest = 1;
        for (const HandReport& report : seen)
            nearest = std::min(nearest,
                               std::hypot(x + centre.x - report.position.x, y + centre.y - report.position.y,
                                          z + centre.z - report.position.z));
        EXPECT_LE(nearest, exact);
        if (i == 0) first = {x, y, z};
        moved += std::hypot(x - first.x, y - first.y, z - first.z) > 1e-4 ? 1 : 0;
        dhdSetForce(0, 0, 0, 0);
    }
    EXPECT_GT(moved, 50) << "a hand at rest proves little";
}

TEST_F(Dhd, velocity_and_position_are_in_metres_from_the_centre) {
    ASSERT_EQ(dhdOpenID(1), 1);
    double x, y, z, matrix[9], vx, vy, vz;
    ASSERT_EQ(dhdGetPositionAndOrientationFrame(&x, &y, &z, matrix, 1), 0);
    EXPECT_NEAR(x, 0.010, 1e-3);
    EXPECT_NEAR(y, -0.020, 1e-3);
    EXPECT_NEAR(z, 0.005, 1e-3);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(matrix[i], i % 4 == 0 ? 1 : 0) << "no wrist";
    ASSERT_TRUE(until(
        *left_, [](const HandReport& r) { return std::abs(r.velocity.x) > 0.01; },
        [] { dhdSetForce(0, 0, 0, 1); }));
    ASSERT_EQ(dhdGetLinearVelocity(&vx, &vy, &vz, 1), 0);
    EXPECT_GT(std::hypot(vx, vy, vz), 0.001);
    EXPECT_LT(std::hypot(vx, vy, vz), 0.2);
}

TEST_F(Dhd, a_force_is_felt_while_it_is_set_and_lapses_when_it_is_not) {
    ASSERT_EQ(dhdOpen(), 0);
    ASSERT_TRUE(until(
        *right_, [](const HandReport& r) { return is_active(r) && std::abs(r.sent_force.x - 0.5) < 1e-9; },
        [] { EXPECT_EQ(dhdSetForce(0.5, 0, 0, -1), 0); }));
    double x, y, z;
    ASSERT_EQ(dhdGetForce(&x, &y, &z, -1), 0);
    EXPECT_NEAR(x, 0.5, exact);
    while (right_->next_report(0ns)) {
    }
    const auto set = std::chrono::steady_clock::now();
    ASSERT_EQ(dhdSetForce(0.5, 0, 0, -1), 0);
    std::optional<std::int64_t> fell;
    double last = 0.5;
    int between = 0;
    for (;;) {
        const auto report = right_->next_report(10s);
        ASSERT_TRUE(report);
        EXPECT_LE(report->sent_force.x, last + exact) << "no jump up";
        EXPECT_GT(report->sent_force.x, last - 0.5 * 0.06) << "of a fade over 50 cycles";
        last = report->sent_force.x;
        if (!fell && last < 0.5 - 1e-6) fell = report->read_ns;
        between += last > 0 && last < 0.5 - 1e-6 ? 1 : 0;
        if (last == 0) break;
    }
    EXPECT_GT(between, 40);
    EXPECT_LT(between, 70) << "not the fade of a claim that has been silent for a quarter of a second";
    EXPECT_GE(*fell - set.time_since_epoch().count(), 100'000'000) << "it lasts 100 ms";
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return r.sent_force.x > 0.4; },
        [] { dhdSetForce(0.5, 0, 0, -1); }))
        << "and comes back at once";
}

TEST_F(Dhd, a_shorter_watchdog_is_kept_to) {
    ASSERT_EQ(dhdOpen(), 0);
    EXPECT_EQ(dhdSetWatchdog(80, -1), -1);
    EXPECT_EQ(dhdErrorGetLast(), 9) << "for experts";
    dhdEnableExpertMode();
    ASSERT_EQ(dhdSetWatchdog(80, -1), 0);  // 10 ms
    unsigned char set = 0;
    ASSERT_EQ(dhdGetWatchdog(&set, -1), 0);
    EXPECT_EQ(set, 80);
    // On a machine with other work now and then one lasts longer; that of 100 ms never ends sooner.
    const auto lapse = [&] {
        EXPECT_TRUE(until(
            *right_, [](const HandReport& r) { return r.sent_force.x > 0.4; },
            [] { dhdSetForce(0.5, 0, 0, -1); }));
        while (right_->next_report(0ns)) {
        }
        dhdSetForce(0.5, 0, 0, -1);
        const auto begun = std::chrono::steady_clock::now().time_since_epoch().count();
        for (;;) {
            const auto report = right_->next_report(10s);
            if (!report) return std::chrono::nanoseconds(10s);
            if (report->sent_force.x < 0.39) return std::chrono::nanoseconds(report->read_ns - begun);
        }
    };
    EXPECT_TRUE(eventually([&] { return lapse() < 90ms; }));
}

TEST_F(Dhd, two_devices_have_forces_of_their_own) {
    ASSERT_EQ(dhdOpenID(0), 0);
    ASSERT_EQ(dhdOpenID(1), 1);
    const auto both = [] {
        EXPECT_GE(dhdSetForce(0.3, 0, 0, 0), 0);
        EXPECT_GE(dhdSetForce(0, 0.4, 0, 1), 0);
    };
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.x - 0.3) < 1e-9; }, both));
    EXPECT_TRUE(until(
        *left_, [](const HandReport& r) { return std::abs(r.sent_force.y - 0.4) < 1e-9; }, both));
    EXPECT_EQ(right_->latest()->sent_force.y, 0);
    ASSERT_EQ(dhdClose(0), 0);
    EXPECT_TRUE(until(*right_, no_force, [] { dhdSetForce(0, 0.4, 0, -1); }));
    EXPECT_NEAR(left_->latest()->sent_force.y, 0.4, 0.1);
}

TEST_F(Dhd, nonsense_is_refused_and_changes_nothing) {
    ASSERT_EQ(dhdOpen(), 0);
    const auto good = [] { dhdSetForce(0.2, 0, 0, -1); };
    ASSERT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.x - 0.2) < 1e-9; }, good));
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, inf, -inf}) {
        EXPECT_EQ(dhdSetForce(bad, 0, 0, -1), -1);
        EXPECT_EQ(dhdErrorGetLast(), 21);
        EXPECT_EQ(dhdSetForceAndTorque(0, 0, 0, 0, bad, 0, -1), -1);
        EXPECT_EQ(dhdSetForceAndGripperForce(0, 0, 0, bad, -1), -1);
    }
    EXPECT_NE(right_->latest()->state, DeviceState::fault);
    double x;
    EXPECT_EQ(dhdGetPosition(&x, nullptr, &x, -1), -1);
    EXPECT_EQ(dhdErrorGetLast(), 17);
    EXPECT_EQ(dhdGetStatus(nullptr, -1), -1);
    EXPECT_EQ(dhdGetButton(32, -1), -1);
    EXPECT_EQ(dhdErrorGetLast(), 15);
    EXPECT_EQ(dhdSetMaxForce(nan, -1), -1);
    EXPECT_EQ(dhdSetForce(0, 0, 0, 5), -1) << "not open";
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.x - 0.2) < 1e-9; }, good));
}

TEST_F(Dhd, force_is_switched_off_and_on_and_limited) {
    ASSERT_EQ(dhdOpen(), 0);
    const auto push = [] { EXPECT_GE(dhdSetForce(0, 0, 0.6, -1), 0); };
    ASSERT_TRUE(until(
        *right_, [](const HandReport& r) { return r.sent_force.z > 0.59; }, push));
    int status[17];
    std::fill(std::begin(status), std::end(status), 77);
    ASSERT_EQ(dhdGetStatus(status, -1), 0);
    EXPECT_EQ(status[5], 1) << "forces are on";
    EXPECT_EQ(status[15], 77) << "arrays of older programs end there";
    ASSERT_EQ(dhdStop(-1), 0);
    EXPECT_TRUE(until(*right_, no_force, push));
    for (int i = 0; i < 100; ++i) push();
    EXPECT_TRUE(no_force(*right_->newest(1s))) << "and stays off, though the program goes on";
    EXPECT_EQ(dhdGetStatus(status, -1), 0);
    EXPECT_EQ(status[5], 0);
    ASSERT_EQ(dhdEnableForce(1, -1), 0);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return r.sent_force.z > 0.59; }, push));
    EXPECT_EQ(dhdGetMaxForce(-1), -1);
    ASSERT_EQ(dhdSetMaxForce(0.25, -1), 0);
    EXPECT_EQ(dhdGetMaxForce(-1), 0.25);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.z - 0.25) < 1e-9; }, push));
    ASSERT_EQ(dhdSetMaxForce(-1, -1), 0);
    EXPECT_EQ(dhdSetForce(0, 0, 1000, -1), 2) << "more than the motors can";
    ASSERT_EQ(dhdSetBrakes(1, -1), 0);
    EXPECT_TRUE(until(*right_, no_force, [] {}));
}

TEST_F(DhdWrist, a_wrist_is_read_and_turned) {
    ASSERT_EQ(dhdOpenID(0), 0);
    EXPECT_TRUE(dhdHasWrist(-1) && dhdHasActiveWrist(-1));
    EXPECT_FALSE(dhdHasGripper(-1));
    EXPECT_EQ(dhdGetSystemType(-1), 91) << "no device of theirs has a driven wrist without a gripper";
    const auto report = right_->latest();
    double matrix[9], x, y, z, a, b, c, gap = 7;
    ASSERT_EQ(drdGetPositionAndOrientation(&x, &y, &z, &a, &b, &c, &gap, matrix, -1), 0);
    const auto r = to_eigen(report->orientation).toRotationMatrix();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            EXPECT_NEAR(matrix[3 * row + column], r(row, column), 1e-6);
    EXPECT_NEAR(a, report->joints[3], 1e-3);
    EXPECT_EQ(gap, 0);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& now) { return std::abs(now.sent_torque.y - 0.01) < 1e-6; },
        [] { dhdSetForceAndTorque(0, 0, 0, 0, 0.01, 0, -1); }));
}

TEST_F(Dhd, a_device_is_shared_with_who_shares_it_and_refused_with_who_does_not) {
    std::optional<Claim> alone = client_->claim("right");
    EXPECT_EQ(dhdOpenID(0), -1);
    EXPECT_EQ(dhdErrorGetLast(), 20);
    ASSERT_EQ(dhdOpen(), 1) << "the first that is free";
    ASSERT_EQ(dhdClose(1), 0);
    alone.reset();
    std::optional<Claim> shared;
    ASSERT_TRUE(eventually([&] {
        try {
            shared.emplace(client_->claim("right", {.shared = true}));
        } catch (const Error&) {
            return false;
        }
        return true;
    }));
    EXPECT_EQ(dhdOpenID(0), 0);
}

TEST_F(Dhd, the_servo_is_killed_and_comes_back) {
    ASSERT_EQ(dhdOpen(), 0);
    ASSERT_TRUE(until(*right_, is_active, [] { dhdSetForce(0.1, 0, 0, -1); }));
    servo_.end(SIGKILL);
    double x, y, z;
    EXPECT_TRUE(eventually([&] { return dhdGetPosition(&x, &y, &z, -1) < 0; }));
    EXPECT_EQ(dhdErrorGetLast(), 2);
    EXPECT_EQ(dhdSetForce(0.1, 0, 0, -1), -1);
    EXPECT_EQ(dhdErrorGetLast(), 2);
    servo_.start();
    EXPECT_TRUE(eventually([&] { return dhdGetPosition(&x, &y, &z, -1) == 0; })) << "it is read again";
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return is_active(r) && r.sent_force.x > 0.09; },
        [] { dhdSetForce(0.1, 0, 0, -1); }));
}

TEST_F(Dhd, calls_come_from_many_threads_and_one_closes) {
    ASSERT_EQ(dhdOpenID(0), 0);
    std::atomic<bool> done{false};
    std::atomic<int> reads{0}, sets{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 2; ++i) {
        threads.emplace_back([&] {
            double x, y, z;
            while (!done) reads += dhdGetPosition(&x, &y, &z, 0) == 0 ? 1 : 0;
        });
        threads.emplace_back([&] {
            while (!done) sets += dhdSetForce(0.01, 0, 0, 0) == 0 ? 1 : 0;
        });
    }
    EXPECT_TRUE(eventually([&] { return reads > 1000 && sets > 200; }));
    EXPECT_EQ(dhdClose(0), 0);
    EXPECT_EQ(dhdOpenID(0), 0);
    const int before = reads;
    EXPECT_TRUE(eventually([&] { return reads > before + 100; }));
    EXPECT_EQ(dhdClose(0), 0);
    done = true;
    for (std::thread& thread : threads) thread.join();
}

TEST_F(Dhd, a_loop_without_a_clock_is_paced_by_the_servo) {
    ASSERT_EQ(dhdOpenID(0), 0);
    ASSERT_TRUE(until(*right_, is_active, [] { dhdSetForce(0, 0, 0, 0); }));
    const std::uint64_t first = right_->latest()->cycle;
    constexpr int calls = 300;
    for (int i = 0; i < calls; ++i) ASSERT_GE(dhdSetForce(0, 0, 0, 0), 0);
    EXPECT_GE(right_->newest(1s)->cycle - first, calls - 2u) << "no more than one a cycle";
    EXPECT_GT(dhdGetComFreq(0), 0);
}

}  // namespace
}  // namespace lookalike_test
