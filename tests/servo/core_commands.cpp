// Commands as the servo takes them: groups whole or not at all, each answered, none lost.

#include <cmath>
#include <limits>

#include <knurl/reps/describe.hpp>

#include "core_desk.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;
using protocol::Refusal;
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
    Desk desk;
    desk.claim.add(Plane{.stiffness = -5});
    desk.servo.step();
    const Reply reply = desk.claim.replies().at(0);
    EXPECT_EQ(reply.code, static_cast<std::uint32_t>(Code::out_of_range));
    EXPECT_EQ(Describe<Plane>::fields[reply.field].name, "stiffness");
    EXPECT_EQ(reply.value, -5);
    EXPECT_EQ(reply.kind, kind_of<Plane>);
    EXPECT_EQ(desk.servo.count(Count::commands_refused), 1u);
}

TEST(Commands, AGroupTakesEffectInOneCycleOrNotAtAll) {
    Desk desk;
    desk.claim.begin_group();
    desk.claim.add(Desk::plane(100));
    desk.claim.add(Plane{.stiffness = nan});
    desk.claim.add(Desk::plane(100));
    desk.claim.end_group();
    EXPECT_EQ(desk.force(), 0);
    const std::vector<Reply> replies = desk.claim.replies();
    ASSERT_EQ(replies.size(), 3u);
    EXPECT_EQ(replies[0].reason, static_cast<std::uint32_t>(Refusal::group_refused));
    EXPECT_EQ(replies[1].code, static_cast<std::uint32_t>(Code::not_finite));
    EXPECT_EQ(replies[2].reason, static_cast<std::uint32_t>(Refusal::group_refused));

    // The slots are free again: the same group without the mistake.
    desk.claim.begin_group();
    const Plane good = Desk::plane(100);
    for (std::uint32_t slot = 0; slot < 3; ++slot)
        desk.claim.add({slot, 1}, kind_of<Plane>, &good, sizeof good);
    desk.claim.end_group();
    desk.force();
    for (const Reply& reply : desk.claim.replies()) EXPECT_EQ(reply.code, 0u);
    EXPECT_NEAR(desk.force(), 0.1, 1e-12);
}

TEST(Commands, ALaterCommandOfAGroupMayBuildOnAnEarlierOne) {
    Desk desk;
    const Handle first = desk.claim.add(Desk::plane(100));
    desk.force();
    const Plane stiffer = Desk::plane(300), stiffest = Desk::plane(500);
    desk.claim.begin_group();
    desk.claim.remove(first);  // frees the slot
    desk.claim.add({first.slot, 2}, kind_of<Plane>, &stiffer, sizeof stiffer);
    desk.claim.remove({first.slot, 2});  // what the group itself has added
    desk.claim.add({first.slot, 3}, kind_of<Plane>, &stiffest, sizeof stiffest);
    desk.claim.end_group();
    EXPECT_NEAR(desk.force(), 0.5, 1e-12);
    for (const Reply& reply : desk.claim.replies()) EXPECT_EQ(reply.code, 0u);
}

TEST(Commands, ARefusedGroupLeavesWhatItMeantToRemove) {
    Desk desk;
    const Handle first = desk.claim.add(Desk::plane(100));
    desk.force();
    desk.claim.begin_group();
    desk.claim.remove(first);
    desk.claim.remove(first);  // a second time: refused, and with it the first
    desk.claim.end_group();
    EXPECT_NEAR(desk.force(), 0.1, 1e-12);
    EXPECT_NEAR(desk.force(), 0.1, 1e-12);
    desk.claim.remove(first);
    desk.claim.replies();
    desk.force();
    EXPECT_EQ(desk.code(), Code::ok) << "it is still there to be removed";
}

TEST(Commands, ParametersAreCheckedEvenInASlotThatTheGroupFrees) {
    Desk desk;
    const Handle first = desk.claim.add(Desk::plane(100));
    desk.force();
    const Plane bad{.stiffness = infinity * 0};
    desk.claim.begin_group();
    desk.claim.remove(first);
    desk.claim.add({first.slot, 2}, kind_of<Plane>, &bad, sizeof bad);
    desk.claim.end_group();
    EXPECT_NEAR(desk.force(), 0.1, 1e-12);
    const std::vector<Reply> replies = desk.claim.replies();
    EXPECT_EQ(replies.back().code, static_cast<std::uint32_t>(Code::not_finite));
}

TEST(Commands, SlotsAndProbesAreChecked) {
    Desk desk;
    const Plane plane = Desk::plane(1);
    desk.claim.add({0, 1}, kind_of<Plane>, &plane, sizeof plane);
    desk.claim.add({0, 2}, kind_of<Plane>, &plane, sizeof plane);        // in use
    desk.claim.add({100'000, 1}, kind_of<Plane>, &plane, sizeof plane);  // beyond the capacity
    desk.claim.add({1, 1}, 77, &plane, sizeof plane);                    // no such kind
    desk.claim.add({1, 1}, kind_of<Plane>, &plane, 8);                   // too short
    desk.claim.add({1, 1}, kind_of<Plane>, &plane, sizeof plane, {.probe = 16});
    desk.claim.remove({5, 1});
    desk.claim.remove({0, 9});  // another generation
    desk.claim.place_probe(16, {});
    desk.claim.place_probe(1, {.offset = {}, .radius = -1});
    desk.claim.place_probe(1, {.offset = {nan, 0, 0}, .radius = 0});
    desk.servo.step();
    const Code expected[] = {Code::ok,           Code::slot_in_use,  Code::too_many,
                             Code::unknown_kind, Code::wrong_size,   Code::no_such_probe,
                             Code::no_such_slot, Code::no_such_slot, Code::no_such_probe,
                             Code::out_of_range, Code::not_finite};
    const std::vector<Reply> replies = desk.claim.replies();
    ASSERT_EQ(replies.size(), std::size(expected));
    for (std::size_t i = 0; i < replies.size(); ++i)
        EXPECT_EQ(replies[i].code, static_cast<std::uint32_t>(expected[i])) << "command " << i + 1;
    // As people read them; of a placement the servo's answer names no kind.
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
        return static_cast<Refusal>(reply.reason);
    };
    device.calibrated = false;
    claim.arm();
    EXPECT_EQ(reason(), Refusal::not_calibrated);
    device.calibrated = true;
    claim.reset_fault();
    EXPECT_EQ(reason(), Refusal::not_in_fault);
    servo.servo().clock_jumped();
    claim.arm();
    EXPECT_EQ(reason(), Refusal::in_fault);
    claim.begin_group();
    claim.reset_fault();
    claim.arm();
    claim.end_group();
    EXPECT_EQ(reason(), Refusal::none) << "reset, then armed, in one group";
    servo.step();
    EXPECT_EQ(servo.servo().last().state, DeviceState::ramp_up);
}

TEST(Commands, UnreadRepliesHoldBackCommandsAndNothingIsLost) {
    Desk desk;
    const std::uint32_t issued = protocol::reply_cells + 100;
    for (std::uint32_t i = 0; i < issued; ++i) desk.claim.place_probe(1, {});
    run(desk.servo, 50);
    EXPECT_EQ(desk.servo.count(Count::commands_done), protocol::reply_cells);
    EXPECT_EQ(desk.claim.replies().size(), protocol::reply_cells);
    run(desk.servo, 50);
    const std::vector<Reply> rest = desk.claim.replies();
    ASSERT_EQ(rest.size(), 100u);
    EXPECT_EQ(rest.back().command, issued);
}

TEST(Commands, ACycleDoesABoundedNumberButFinishesTheGroupThatItHasBegun) {
    Desk desk;
    desk.servo.step();
    for (std::uint32_t i = 0; i < 2 * protocol::command_cells_per_cycle; ++i) desk.claim.place_probe(1, {});
    desk.servo.step();
    EXPECT_EQ(desk.servo.count(Count::commands_done), protocol::command_cells_per_cycle);
    desk.servo.step();
    EXPECT_EQ(desk.servo.count(Count::commands_done), 2 * protocol::command_cells_per_cycle);
    desk.claim.replies();

    desk.claim.begin_group();
    for (std::uint32_t i = 0; i < 2 * protocol::command_cells_per_cycle; ++i) desk.claim.place_probe(1, {});
    desk.claim.end_group();
    desk.servo.step();
    EXPECT_EQ(desk.servo.count(Count::commands_done), 4 * protocol::command_cells_per_cycle);
}

}  // namespace
}  // namespace knurl::servo
