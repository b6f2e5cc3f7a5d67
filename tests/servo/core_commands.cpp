// How the servo takes commands: groups whole or not at all, each answered, none lost.

#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/all.hpp>
#include <knurl/reps/describe.hpp>

#include "core_claim_fixture.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;
using protocol::RefusalReason;
using protocol::Reply;
using Code = Verdict::Code;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Commands, EachIsAnsweredInOrderWithWhatIsApplied) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& claim = servo.claim();
    claim.add(Plane{.stiffness = infinity});
    claim.add(Plane{.stiffness = 100});
    claim.arm();
    servo.step();
    const std::vector<Reply> replies = claim.replies();
    ASSERT_EQ(replies.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(replies[i].command, i + 1);
        EXPECT_EQ(replies[i].code, static_cast<std::uint32_t>(Code::ok));
    }
    // k_max = b/(T/2 + tau)
    EXPECT_NEAR(replies[0].applied_stiffness, 3.2 / (0.5e-3 + 0.53e-3), 1e-6);
    EXPECT_EQ(replies[1].applied_stiffness, 100);
}

TEST(Commands, ABadParameterIsNamedByFieldAndValue) {
    ClaimFixture fixture;
    fixture.claim.add(Plane{.stiffness = -5});
    fixture.servo.step();
    const Reply reply = fixture.claim.replies().at(0);
    EXPECT_EQ(reply.code, static_cast<std::uint32_t>(Code::out_of_range));
    EXPECT_EQ(Describe<Plane>::fields[reply.field].name, "stiffness");
    EXPECT_EQ(reply.value, -5);
    EXPECT_EQ(reply.kind, kind_of<Plane>);
    EXPECT_EQ(fixture.servo.count(Count::commands_refused), 1u);
}

TEST(Commands, AGroupTakesEffectInOneCycleOrNotAtAll) {
    ClaimFixture fixture;
    fixture.claim.begin_group();
    fixture.claim.add(ClaimFixture::plane(100));
    fixture.claim.add(Plane{.stiffness = nan});
    fixture.claim.add(ClaimFixture::plane(100));
    fixture.claim.end_group();
    EXPECT_EQ(fixture.force(), 0);
    const std::vector<Reply> replies = fixture.claim.replies();
    ASSERT_EQ(replies.size(), 3u);
    EXPECT_EQ(replies[0].reason, static_cast<std::uint32_t>(RefusalReason::group_refused));
    EXPECT_EQ(replies[1].code, static_cast<std::uint32_t>(Code::not_finite));
    EXPECT_EQ(replies[2].reason, static_cast<std::uint32_t>(RefusalReason::group_refused));

    // The slots are free again: the same group without the mistake.
    fixture.claim.begin_group();
    const Plane good = ClaimFixture::plane(100);
    for (std::uint32_t slot = 0; slot < 3; ++slot)
        fixture.claim.add({slot, 1}, kind_of<Plane>, &good, sizeof good);
    fixture.claim.end_group();
    fixture.force();
    for (const Reply& reply : fixture.claim.replies()) EXPECT_EQ(reply.code, 0u);
    EXPECT_NEAR(fixture.force(), 0.1, 1e-12);
}

TEST(Commands, ALaterCommandOfAGroupMayBuildOnAnEarlierOne) {
    ClaimFixture fixture;
    const RepresentationId first = fixture.claim.add(ClaimFixture::plane(100));
    fixture.force();
    const Plane stiffer = ClaimFixture::plane(300), stiffest = ClaimFixture::plane(500);
    fixture.claim.begin_group();
    fixture.claim.remove(first);  // frees the slot
    fixture.claim.add({first.slot, 2}, kind_of<Plane>, &stiffer, sizeof stiffer);
    fixture.claim.remove({first.slot, 2});  // added by this very group
    fixture.claim.add({first.slot, 3}, kind_of<Plane>, &stiffest, sizeof stiffest);
    fixture.claim.end_group();
    EXPECT_NEAR(fixture.force(), 0.5, 1e-12);
    for (const Reply& reply : fixture.claim.replies()) EXPECT_EQ(reply.code, 0u);
}

TEST(Commands, ARefusedGroupLeavesWhatItMeantToRemove) {
    ClaimFixture fixture;
    const RepresentationId first = fixture.claim.add(ClaimFixture::plane(100));
    fixture.force();
    fixture.claim.begin_group();
    fixture.claim.remove(first);
    fixture.claim.remove(first);  // a second time: refused, and so is the first
    fixture.claim.end_group();
    EXPECT_NEAR(fixture.force(), 0.1, 1e-12);
    EXPECT_NEAR(fixture.force(), 0.1, 1e-12);
    fixture.claim.remove(first);
    fixture.claim.replies();
    fixture.force();
    EXPECT_EQ(fixture.code(), Code::ok) << "it is still there to be removed";
}

TEST(Commands, ParametersAreCheckedEvenInASlotThatTheGroupFrees) {
    ClaimFixture fixture;
    const RepresentationId first = fixture.claim.add(ClaimFixture::plane(100));
    fixture.force();
    const Plane bad{.stiffness = infinity * 0};
    fixture.claim.begin_group();
    fixture.claim.remove(first);
    fixture.claim.add({first.slot, 2}, kind_of<Plane>, &bad, sizeof bad);
    fixture.claim.end_group();
    EXPECT_NEAR(fixture.force(), 0.1, 1e-12);
    const std::vector<Reply> replies = fixture.claim.replies();
    EXPECT_EQ(replies.back().code, static_cast<std::uint32_t>(Code::not_finite));
}

TEST(Commands, SlotsAndProbesAreChecked) {
    ClaimFixture fixture;
    const Plane plane = ClaimFixture::plane(1);
    fixture.claim.add({0, 1}, kind_of<Plane>, &plane, sizeof plane);
    fixture.claim.add({0, 2}, kind_of<Plane>, &plane, sizeof plane);        // in use
    fixture.claim.add({100'000, 1}, kind_of<Plane>, &plane, sizeof plane);  // beyond the capacity
    fixture.claim.add({1, 1}, 77, &plane, sizeof plane);                    // no such kind
    fixture.claim.add({1, 1}, kind_of<Plane>, &plane, 8);                   // too short
    fixture.claim.add({1, 1}, kind_of<Plane>, &plane, sizeof plane, {.probe = 16});
    fixture.claim.remove({5, 1});
    fixture.claim.remove({0, 9});  // another generation
    fixture.claim.place_probe(16, {});
    fixture.claim.place_probe(1, {.offset = {}, .radius = -1});
    fixture.claim.place_probe(1, {.offset = {nan, 0, 0}, .radius = 0});
    fixture.servo.step();
    const Code expected[] = {Code::ok,           Code::slot_in_use,  Code::too_many,
                             Code::unknown_kind, Code::wrong_size,   Code::no_such_probe,
                             Code::no_such_slot, Code::no_such_slot, Code::no_such_probe,
                             Code::out_of_range, Code::not_finite};
    const std::vector<Reply> replies = fixture.claim.replies();
    ASSERT_EQ(replies.size(), std::size(expected));
    for (std::size_t i = 0; i < replies.size(); ++i)
        EXPECT_EQ(replies[i].code, static_cast<std::uint32_t>(expected[i])) << "command " << i + 1;
    // As text for people; for a placement the servo's answer has no kind.
    const auto sentence = [&](std::size_t i) {
        return describe(verdict_of(replies[i]), replies[i].kind, "");
    };
    EXPECT_EQ(sentence(5), "plane.probe = 16: there is no such probe; give 0 to 15");
    EXPECT_EQ(sentence(8), "probe = 16: there is no such probe; give 0 to 15");
    EXPECT_EQ(sentence(9), "probe.radius = -1 m is out of range; give a value from 0 to 1000000000 m");
}

TEST(Commands, TheDevicesStateRefusesWithAReason) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& claim = servo.claim();
    const auto reason = [&] {
        servo.step();
        const Reply reply = claim.replies().at(0);
        EXPECT_EQ(reply.code, static_cast<std::uint32_t>(reply.reason != 0 ? Code::refused : Code::ok));
        return static_cast<RefusalReason>(reply.reason);
    };
    device.calibrated = false;
    claim.arm();
    EXPECT_EQ(reason(), RefusalReason::not_calibrated);
    device.calibrated = true;
    claim.reset_fault();
    EXPECT_EQ(reason(), RefusalReason::not_in_fault);
    servo.servo().clock_jumped();
    claim.arm();
    EXPECT_EQ(reason(), RefusalReason::in_fault);
    claim.begin_group();
    claim.reset_fault();
    claim.arm();
    claim.end_group();
    EXPECT_EQ(reason(), RefusalReason::none) << "reset, then armed, in one group";
    servo.step();
    EXPECT_EQ(servo.servo().last().state, DeviceState::ramp_up);
}

TEST(Commands, UnreadRepliesHoldBackCommandsAndNothingIsLost) {
    ClaimFixture fixture;
    const std::uint32_t issued = protocol::reply_cells + 100;
    for (std::uint32_t i = 0; i < issued; ++i) fixture.claim.place_probe(1, {});
    run(fixture.servo, 50);
    EXPECT_EQ(fixture.servo.count(Count::commands_done), protocol::reply_cells);
    EXPECT_EQ(fixture.claim.replies().size(), protocol::reply_cells);
    run(fixture.servo, 50);
    const std::vector<Reply> rest = fixture.claim.replies();
    ASSERT_EQ(rest.size(), 100u);
    EXPECT_EQ(rest.back().command, issued);
}

TEST(Commands, ACycleDoesABoundedNumberButFinishesTheGroupThatItHasBegun) {
    ClaimFixture fixture;
    fixture.servo.step();
    for (std::uint32_t i = 0; i < 2 * protocol::command_cells_per_cycle; ++i)
        fixture.claim.place_probe(1, {});
    fixture.servo.step();
    EXPECT_EQ(fixture.servo.count(Count::commands_done), protocol::command_cells_per_cycle);
    fixture.servo.step();
    EXPECT_EQ(fixture.servo.count(Count::commands_done), 2 * protocol::command_cells_per_cycle);
    fixture.claim.replies();

    fixture.claim.begin_group();
    for (std::uint32_t i = 0; i < 2 * protocol::command_cells_per_cycle; ++i)
        fixture.claim.place_probe(1, {});
    fixture.claim.end_group();
    fixture.servo.step();
    EXPECT_EQ(fixture.servo.count(Count::commands_done), 4 * protocol::command_cells_per_cycle);
}

TEST(Commands, ManyClaimsShareWhatACycleTakesAndEachHasItsTurn) {
    PuppetDevice device;
    Offline servo(device);
    constexpr std::size_t claims = 100;
    constexpr std::uint32_t each = 2000;
    std::vector<OfflineClaim*> floods;
    for (std::size_t i = 0; i < claims; ++i) floods.push_back(&servo.claim());
    servo.step();
    for (OfflineClaim* flood : floods)
        for (std::uint32_t i = 0; i < each; ++i) flood->place_probe(1, {});
    std::vector<std::size_t> answered(claims);
    std::uint64_t done = servo.count(Count::commands_done);
    for (int cycle = 1; done < claims * each; ++cycle) {
        servo.step();
        const std::uint64_t now = servo.count(Count::commands_done);
        ASSERT_LE(now - done, protocol::intake_cells_per_cycle + protocol::least_command_cells);
        ASSERT_GT(now, done);
        done = now;
        for (std::size_t i = 0; i < claims; ++i) answered[i] += floods[i]->replies().size();
        const auto [least, most] = std::minmax_element(answered.begin(), answered.end());
        ASSERT_LE(*most - *least, 2 * protocol::least_command_cells) << "in cycle " << cycle;
    }
}

}  // namespace
}  // namespace knurl::servo
