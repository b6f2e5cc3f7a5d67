// Claims: their gains, the messages to the device, several on one device, arrival and departure.

#include <atomic>
#include <cmath>
#include <thread>

#include <knurl/reps/constant_force.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/spring.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using drivers::Notice;
using protocol::Count;

double scene_z(Offline& servo) {
    return servo.servo().last().scene_force.z;
}
double sent_z(Offline& servo) {
    return servo.servo().last().sent_force.z;
}

/// One more claim, armed, that pushes with this force (N).
OfflineClaim& pushing(Offline& servo, const Vec3& force) {
    OfflineClaim& claim = servo.claim();
    claim.add(ConstantForce{.force = force, .recovery = 0});
    claim.arm();
    return claim;
}

// ------------------------------------------------------------------------------------------------- gains

TEST(Gains, ArmedAClaimsForceComesInLinearlyOverFiftyMilliseconds) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& claim = servo.claim();
    claim.add(ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    run(servo, 100);
    EXPECT_EQ(scene_z(servo), 0) << "not armed: nothing";
    claim.arm();
    for (int i = 1; i <= 60; ++i) {
        servo.step();
        ASSERT_NEAR(scene_z(servo), 2 * std::min(1.0, i / 50.0), 1e-9) << i;
    }
    claim.disarm();
    for (int i = 1; i <= 60; ++i) {
        servo.step();
        ASSERT_NEAR(scene_z(servo), 2 * std::max(0.0, 1 - i / 50.0), 1e-9) << i;
    }
    EXPECT_EQ(scene_z(servo), 0);
}

TEST(Gains, OneClaimFadesAloneWhileTheOtherFeelsNothing) {
    PuppetDevice device;
    Offline servo(device, live_options());
    pushing(servo, {1, 0, 0});
    OfflineClaim& second = pushing(servo, {0, 0, 2});
    run(servo, 600);
    ASSERT_EQ(servo.servo().last().state, DeviceState::active);
    servo.servo().drop(&second.servo_side());
    for (int i = 1; i <= 50; ++i) {
        const Report& report = servo.step();
        EXPECT_EQ(report.sent_force.x, 1) << "to the bit";
        EXPECT_NEAR(report.sent_force.z, 2 * (1 - i / 50.0), 1e-9);
        EXPECT_EQ(report.state, DeviceState::active);
        EXPECT_EQ(servo.servo().released(), i < 50 ? nullptr : &second.servo_side());
    }
    EXPECT_EQ(sent_z(servo), 0) << "50 cycles after the drop";
}

TEST(Gains, TheLastClaimsDropRampsTheDeviceDown) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& claim = pushing(servo, {0, 0, 2});
    run(servo, 600);
    servo.servo().drop(&claim.servo_side());
    double last = 2;
    for (int i = 0; i < 50; ++i) {
        EXPECT_LE(servo.step().sent_force.z, last);
        last = sent_z(servo);
    }
    EXPECT_EQ(last, 0);
    EXPECT_EQ(servo.servo().last().state, DeviceState::idle);
    EXPECT_EQ(servo.servo().released(), &claim.servo_side());
    EXPECT_EQ(servo.count(Count::clients), 0u);
}

TEST(Gains, DropAllRampsDownEverythingAndRefusesWhatComesAfter) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& first = pushing(servo, {0, 0, 1});
    OfflineClaim& second = pushing(servo, {0, 0, 1});
    run(servo, 600);
    servo.servo().drop_all();
    run(servo, 50);
    EXPECT_TRUE(device.force().isZero(0));
    EXPECT_EQ(servo.servo().last().state, DeviceState::idle);
    EXPECT_EQ(servo.servo().released(), &first.servo_side());
    EXPECT_EQ(servo.servo().released(), &second.servo_side());
    EXPECT_EQ(servo.servo().released(), nullptr);

    OfflineClaim& late = servo.claim();
    servo.step();
    EXPECT_EQ(servo.servo().released(), &late.servo_side());
}

TEST(Gains, ADropOfAClaimThatIsGoneAlreadyIsHarmless) {
    PuppetDevice device;
    Offline servo(device, live_options());
    ClaimTerms terms;
    auto claim = std::make_unique<OfflineClaim>(terms);
    servo.servo().adopt(&claim->servo_side());
    servo.servo().drop(&claim->servo_side());
    servo.servo().drop(&claim->servo_side());
    servo.step();
    ASSERT_EQ(servo.servo().released(), &claim->servo_side());
    servo.servo().drop(&claim->servo_side());
    claim.reset();
    servo.step();
}

TEST(Gains, ClaimsComeAndGoFromAnotherThreadWhileTheServoRuns) {
    // Like the broker: builds a claim, gives it away, and frees it only after its return.
    PuppetDevice device;
    Offline servo(device, live_options());
    std::atomic<int> freed{0};
    constexpr int rounds = 50;
    std::thread broker([&] {
        for (int i = 0; i < rounds; ++i) {
            auto claim = std::make_unique<OfflineClaim>(ClaimTerms{});
            claim->add(ConstantForce{.force = {0, 0, 1}});
            claim->arm();
            while (!servo.servo().adopt(&claim->servo_side())) std::this_thread::yield();
            while (!servo.servo().drop(&claim->servo_side())) std::this_thread::yield();
            while (servo.servo().released() != &claim->servo_side()) std::this_thread::yield();
            claim.reset();
            freed.fetch_add(1, std::memory_order_relaxed);
        }
    });
    while (freed.load(std::memory_order_relaxed) < rounds) servo.step();
    broker.join();
    servo.step();
    EXPECT_EQ(servo.count(Count::clients), 0u);
}

TEST(Gains, AfterAFaultEveryClaimArmsAnew) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& first = pushing(servo, {0, 0, 1});
    pushing(servo, {0, 0, 1});
    run(servo, 600);
    ASSERT_NEAR(sent_z(servo), 2, 1e-9);
    servo.servo().clock_jumped();
    servo.step();
    EXPECT_TRUE(device.force().isZero(0));
    run(servo, 100);
    first.reset_fault();
    run(servo, 1000);
    EXPECT_EQ(servo.servo().last().state, DeviceState::idle);
    first.arm();
    run(servo, 1000);
    EXPECT_NEAR(sent_z(servo), 1, 1e-9) << "the second has not armed";
}

TEST(Gains, WhoObservesAndResetsLeavesTheFaultAndDoesNothingElse) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& holder = pushing(servo, {0, 0, 1});
    run(servo, 600);
    ClaimTerms terms;
    terms.capacity = {1, 64};
    terms.observer = terms.resets = true;
    OfflineClaim& other = servo.claim(terms);
    const auto answer = [&] {
        servo.step();
        const protocol::Reply reply = other.replies().at(0);
        EXPECT_EQ(reply.code,
                  static_cast<std::uint32_t>(reply.reason != 0 ? Verdict::Code::refused : Verdict::Code::ok));
        return static_cast<protocol::RefusalReason>(reply.reason);
    };
    other.arm();
    EXPECT_EQ(answer(), protocol::RefusalReason::forbidden);
    other.disarm();
    EXPECT_EQ(answer(), protocol::RefusalReason::forbidden);
    other.add(ConstantForce{.force = {0, 0, 5}});
    EXPECT_EQ(answer(), protocol::RefusalReason::forbidden);
    other.reset_fault();
    EXPECT_EQ(answer(), protocol::RefusalReason::not_in_fault);
    EXPECT_NEAR(sent_z(servo), 1, 1e-9) << "nobody noticed";
    servo.servo().clock_jumped();
    servo.step();
    other.reset_fault();
    EXPECT_EQ(answer(), protocol::RefusalReason::none);
    run(servo, 1000);
    EXPECT_EQ(servo.servo().last().state, DeviceState::idle);
    EXPECT_TRUE(device.force().isZero(0));
    holder.arm();
    run(servo, 1000);
    EXPECT_NEAR(sent_z(servo), 1, 1e-9);
}

TEST(Gains, WhoArmsDuringARampDownArmsItselfAlone) {
    PuppetDevice device;
    Offline servo(device, live_options());
    pushing(servo, {0, 0, 1});
    OfflineClaim& second = pushing(servo, {0, 0, 1});
    run(servo, 600);
    device.status = drivers::ReadStatus::bad;
    run(servo, 3);
    device.status = drivers::ReadStatus::ok;
    ASSERT_EQ(servo.servo().last().state, DeviceState::ramp_down);
    second.arm();
    run(servo, 700);
    EXPECT_EQ(servo.servo().last().state, DeviceState::active);
    EXPECT_NEAR(sent_z(servo), 1, 1e-9) << "the first has not armed again";
}

// ----------------------------------------------------------------------------------------------- notices

TEST(Notices, TheDeviceIsToldWhenEffortsMayFollowAndWhenAClaimIsInFullForce) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& claim = servo.claim();
    run(servo, 10);
    EXPECT_EQ(device.notice_count, 0u);
    claim.arm();
    run(servo, 3);
    ASSERT_EQ(device.notice_count, 1u);
    EXPECT_EQ(device.notices[0], Notice::enabled);
    run(servo, 490);
    EXPECT_EQ(device.notice_count, 1u) << "its gain is 1, but the device's is not";
    run(servo, 20);
    ASSERT_EQ(device.notice_count, 2u);
    EXPECT_EQ(device.notices[1], Notice::claim_active);
    run(servo, 500);
    EXPECT_EQ(device.notice_count, 2u) << "once";
    claim.disarm();
    run(servo, 100);
    ASSERT_EQ(device.notice_count, 3u);
    EXPECT_EQ(device.notices[2], Notice::disabled);
    claim.arm();
    run(servo, 600);
    ASSERT_EQ(device.notice_count, 5u);
    EXPECT_EQ(device.notices[4], Notice::claim_active);
}

TEST(Notices, ASecondClaimBecomesActiveByItself) {
    PuppetDevice device;
    Offline servo(device, live_options());
    servo.claim().arm();
    OfflineClaim& second = servo.claim();
    run(servo, 600);
    const std::size_t before = device.notice_count;
    second.arm();
    run(servo, 49);
    EXPECT_EQ(device.notice_count, before);
    run(servo, 1);
    ASSERT_EQ(device.notice_count, before + 1);
    EXPECT_EQ(device.notices[before], Notice::claim_active);
}

// ----------------------------------------------------------------------------------------------- sharing

TEST(Sharing, WrenchesAddUp) {
    PuppetDevice device;
    Offline servo(device);
    servo.claim().add(ConstantForce{.force = {1, 0, 0}});
    servo.claim().add(ConstantForce{.force = {0, 2, 0}});
    servo.step();
    EXPECT_TRUE(device.force().isApprox(Eigen::Vector3d(1, 2, 0), 1e-15));
}

TEST(Sharing, StiffnessTogetherAboveTheDevicesIsScaledAndTold) {
    PuppetDevice device;  // k_max = 3.2/(0.5 ms + 0.53 ms) = 3107 N/m
    const double k_max = max_stiffness(device.link(), 1000);
    device.tip = {0, 0, -1e-4};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& first = servo.claim();
    first.add(Plane{.stiffness = 2500, .recovery = 0});
    first.arm();
    run(servo, 600);
    EXPECT_NEAR(sent_z(servo), 0.25, 1e-9) << "alone it has all of it";
    EXPECT_EQ(protocol::scales_of(first.feedback().header).contacts, 1);

    OfflineClaim& second = servo.claim();
    second.add(Plane{.stiffness = 2500, .recovery = 0});
    second.arm();
    double last = sent_z(servo);
    for (int i = 0; i < 200; ++i) {
        const double force = servo.step().sent_force.z;
        EXPECT_LE(std::abs(force - last), 0.25 / 50 * 2 + 1e-9) << "no step, cycle " << i;
        last = force;
    }
    EXPECT_NEAR(last, k_max * 1e-4, 1e-9);
    EXPECT_NEAR(protocol::scales_of(first.feedback().header).contacts, k_max / 5000, 1e-6);
    EXPECT_NEAR(protocol::scales_of(second.feedback().header).contacts, k_max / 5000, 1e-6);

    servo.servo().drop(&second.servo_side());
    run(servo, 200);
    EXPECT_NEAR(sent_z(servo), 0.25, 1e-9);
    EXPECT_EQ(protocol::scales_of(first.feedback().header).contacts, 1);
}

TEST(Sharing, AStiffPlaneOfOneClaimIsNoStepForTheOther) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-4};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& first = servo.claim();
    OfflineClaim& second = servo.claim();
    first.add(Plane{.stiffness = 2500, .recovery = 0});
    second.add(ConstantForce{});
    first.arm();
    second.arm();
    run(servo, 600);
    ASSERT_EQ(protocol::scales_of(first.feedback().header).contacts, 1);
    // Across: neither direction is stiffer at the hand than before.
    second.add(Plane{.normal = {1, 0, 0}, .offset = 1e-4, .stiffness = 2500, .recovery = 0});
    run(servo, 60);
    EXPECT_EQ(protocol::scales_of(first.feedback().header).contacts, 1);
    second.add(Plane{.stiffness = 2500, .recovery = 0});
    double last = 1;
    for (int i = 0; i < 60; ++i) {
        servo.step();
        const double scale = protocol::scales_of(first.feedback().header).contacts;
        EXPECT_LE(scale, last);
        EXPECT_LE(last - scale, last * 1e-3 / HandBudget::fall_time + 1e-6) << "cycle " << i;
        last = scale;
    }
    EXPECT_LT(last, 0.63);
}

// Five fingers on a desk, the paper's own use of several probes.
TEST(Sharing, FiveFingersOfOneClaimTogetherAreNoStifferThanTheDeviceStands) {
    PuppetDevice device;
    const double k_max = max_stiffness(device.link(), 1000);
    device.tip = {0, 0, -1e-4};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& hand = servo.claim();
    for (std::uint32_t finger = 0; finger < 5; ++finger) {
        hand.place_probe(finger, {.offset = {0.01 * finger, 0, 0}});
        hand.add(Plane{.stiffness = 1000}, {.probe = finger});
    }
    hand.arm();
    run(servo, 600);
    EXPECT_NEAR(sent_z(servo), k_max * 1e-4, 1e-9);
    EXPECT_NEAR(protocol::scales_of(hand.feedback().header).contacts, k_max / 5000, 1e-6);
    EXPECT_EQ(protocol::scales_of(hand.feedback().header).effects, 1);
}

// The finger that stays down is as soft as before while the hand rests: a rising stiffness would have to
// push. When the hand moves, the damping pays for it.
TEST(Sharing, AFingerThatStaysIsStiffAgainAsTheHandMoves) {
    PuppetDevice device;
    const double k_max = max_stiffness(device.link(), 1000), deep = -2e-3, middle = -0.6e-3;
    device.tip = {0, 0, deep};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& hand = servo.claim();
    for (std::uint32_t finger = 0; finger < 5; ++finger) {
        hand.place_probe(finger, {.offset = {0.01 * finger, 0, 0}});
        hand.add(Plane{.offset = finger == 0 ? 0 : -1e-3, .stiffness = 1000}, {.probe = finger});
    }
    const auto scale = [&] { return protocol::scales_of(hand.feedback().header).contacts; };
    hand.arm();
    run(servo, 600);
    ASSERT_NEAR(scale(), k_max / 5000, 1e-6);
    for (int i = 0; i < 100; ++i) {  // four lift
        device.tip.z() += (middle - deep) / 100;
        servo.step();
    }
    run(servo, 50);
    const double left = scale();
    EXPECT_LT(left, 0.9) << "the way was too short to pay for all";
    run(servo, 1000);
    EXPECT_LT(scale() - left, 1e-3) << "a hand at rest is not pushed";
    double last = scale();
    for (int i = 0; i < 2000; ++i) {  // 0.4 mm up and down, 3 Hz
        device.tip.z() = middle + 0.4e-3 * std::sin(2 * M_PI * 3e-3 * i);
        servo.step();
        EXPECT_GE(scale(), last) << "cycle " << i;
        last = scale();
    }
    EXPECT_EQ(last, 1);
}

// The hand has not paid for what the application removes: at rest it gets the remaining forces in full at
// once.
TEST(Sharing, WhatIsRemovedLeavesItsShareToTheOthersAtOnce) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-4};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& hand = servo.claim();
    std::vector<RepresentationId> fingers;
    for (std::uint32_t finger = 0; finger < 5; ++finger) {
        hand.place_probe(finger, {.offset = {0.01 * finger, 0, 0}});
        fingers.push_back(hand.add(Plane{.stiffness = 1000}, {.probe = finger}));
    }
    hand.arm();
    run(servo, 600);
    for (std::uint32_t finger = 1; finger < 5; ++finger) hand.remove(fingers[finger]);
    run(servo, 200);
    EXPECT_EQ(protocol::scales_of(hand.feedback().header).contacts, 1);
    EXPECT_NEAR(sent_z(servo), 0.1, 1e-9);
}

// ... nor on whether the claim with the surface sleeps, out of the hand's reach.
TEST(Sharing, SurfacesOfAClaimAtRestKeepTheirShare) {
    PuppetDevice device;
    const double k_max = max_stiffness(device.link(), 1000);
    device.tip = {0, 0, 0.05};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& springs = servo.claim();
    OfflineClaim& desk = servo.claim();
    desk.add(Plane{.stiffness = 1000});
    springs.add(Spring{.anchor = {1e-3, 0, 0.05}, .stiffness = k_max});
    springs.arm();
    desk.arm();
    run(servo, 600);
    EXPECT_NEAR(protocol::scales_of(springs.feedback().header).effects, 0.5, 1e-6);
    EXPECT_LT(desk.feedback().header.cycle, servo.servo().last().cycle) << "it sleeps";
}

// A spring's force does not depend on the contact with a surface: else the hand would never rest.
TEST(Sharing, ASpringKeepsItsForceWhenASurfaceIsTouched) {
    PuppetDevice device;
    const double k_max = max_stiffness(device.link(), 1000);
    device.tip = {0, 0, 1e-3};
    ServoOptions options = live_options();
    options.silence = false;
    Offline servo(device, options);
    OfflineClaim& claim = servo.claim();
    claim.add(Plane{.stiffness = std::numeric_limits<double>::infinity()});
    claim.add(Spring{.anchor = {1e-3, 0, 0}, .stiffness = k_max});
    claim.arm();
    run(servo, 600);
    EXPECT_NEAR(servo.servo().last().sent_force.x, 0.5 * k_max * 1e-3, 1e-6) << "half is the surfaces'";
    EXPECT_NEAR(protocol::scales_of(claim.feedback().header).effects, 0.5, 1e-6);
    EXPECT_EQ(protocol::scales_of(claim.feedback().header).contacts, 1);
    device.tip.z() = -1e-4;
    run(servo, 600);
    EXPECT_NEAR(protocol::scales_of(claim.feedback().header).effects, 0.5, 1e-6);
    EXPECT_NEAR(protocol::scales_of(claim.feedback().header).contacts, 0.5, 1e-6);
}

}  // namespace
}  // namespace knurl::servo
