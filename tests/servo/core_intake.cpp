// The two channels as the servo takes them: groups of commands whole or not at all, batches whole or not at
// all, and neither ever before the other's turn.

#include <cmath>
#include <cstring>
#include <limits>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;
using protocol::Refusal;
using protocol::Reply;
using Code = Verdict::Code;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Offline, the hand 1 mm below z = 0, no fades: forces say at once what is in force.
struct Desk {
    PuppetDevice device;
    Offline servo{device};
    OfflineClaim& claim = servo.claim();
    Desk() { device.tip = {0, 0, -1e-3}; }

    static Plane plane(double stiffness) { return {.stiffness = stiffness, .recovery = 0}; }
    double force() { return servo.step().scene_force.z; }
    Code code(std::size_t i = 0) { return static_cast<Code>(claim.replies().at(i).code); }
};

// --------------------------------------------------------------------------------------------- commands

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

// ---------------------------------------------------------------------------------------------- batches

TEST(Batches, AllOfABatchTakesEffectInOneCycle) {
    Desk desk;
    const Handle spring = desk.claim.add(Spring{.anchor = {0, 0, -1e-3}, .stiffness = 100, .duration = 0});
    const Handle pull = desk.claim.add(ConstantForce{.recovery = 0});
    desk.force();
    desk.claim.update(spring, Spring{.anchor = {0, 0, 9e-3}, .stiffness = 100, .duration = 0});
    desk.claim.update(pull, ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    EXPECT_EQ(desk.force(), 0) << "before the commit nothing is sent";
    desk.claim.commit();
    EXPECT_NEAR(desk.force(), 3, 1e-12);
}

TEST(Batches, AContradictionIsRefusedWithItsReason) {
    Desk desk;
    const Plane contradictory{.stiffness = 1, .friction = {.static_ = 0.25, .dynamic = 0.5}};
    desk.claim.add(contradictory);
    desk.servo.step();
    const Reply reply = desk.claim.replies().at(0);
    EXPECT_EQ(reply.code, static_cast<std::uint32_t>(Code::contradiction));
    EXPECT_EQ(Describe<Plane>::contradictions[reply.reason], static_below_dynamic);
    EXPECT_EQ(reply.value, 0.25);

    const Handle plane = desk.claim.add(Plane{.stiffness = 1});
    desk.force();
    desk.claim.update(plane, contradictory);
    desk.claim.commit();
    desk.force();
    const auto& header = desk.claim.feedback().header;
    EXPECT_EQ(header.refused_code, static_cast<std::uint32_t>(Code::contradiction));
    EXPECT_EQ(Describe<Plane>::contradictions[header.refused_reason], static_below_dynamic);
    EXPECT_EQ(Describe<Plane>::fields[header.refused_field].name, "friction.static");
    EXPECT_EQ(header.refused_value, 0.25);
}

TEST(Batches, ABadParameterRefusesTheWholeBatchAndTheOwnerIsTold) {
    Desk desk;
    const Handle first = desk.claim.add(ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    const Handle second = desk.claim.add(ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    desk.force();
    desk.claim.update(first, ConstantForce{.force = {0, 0, 10}, .recovery = 0});
    desk.claim.update(second, ConstantForce{.force = {0, 0, 20}, .recovery = -3});
    const std::uint64_t number = desk.claim.commit();
    EXPECT_NEAR(desk.force(), 3, 1e-12) << "old parameters stay";

    const auto& header = desk.claim.feedback().header;
    EXPECT_EQ(header.batches_refused, 1u);
    EXPECT_EQ(header.refused_batch, number);
    EXPECT_EQ(header.refused_code, static_cast<std::uint32_t>(Code::out_of_range));
    EXPECT_EQ(Describe<ConstantForce>::fields[header.refused_field].name, "recovery");
    EXPECT_EQ(header.refused_value, -3);
    EXPECT_EQ(header.refused_kind, kind_of<ConstantForce>);
    EXPECT_EQ(header.refused_slot, second.slot);
    EXPECT_EQ(header.batch, 0u) << "none has taken effect";

    // Without the mistake it goes through.
    desk.claim.update(first, ConstantForce{.force = {0, 0, 11}, .recovery = 0});
    desk.claim.update(second, ConstantForce{.force = {0, 0, 20}, .recovery = 0});
    desk.claim.commit();
    EXPECT_NEAR(desk.force(), 31, 1e-12);
}

TEST(Batches, ABatchNeverOvertakesTheCommandsIssuedBeforeIt) {
    Desk desk;
    // Fill the replies so that the servo may not do any more commands.
    for (std::uint32_t i = 0; i < protocol::reply_cells; ++i) desk.claim.place_probe(1, {});
    run(desk.servo, 20);
    const Handle pull = desk.claim.add(ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    desk.claim.update(pull, ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    const std::uint64_t number = desk.claim.commit();
    for (int i = 0; i < 20; ++i) EXPECT_EQ(desk.force(), 0);
    EXPECT_EQ(desk.servo.count(Count::batches_taken), 0u) << "its add is not done yet";

    desk.claim.replies();
    EXPECT_NEAR(desk.force(), 2, 1e-12) << "the command, and then the batch, in one cycle";
    EXPECT_EQ(desk.claim.feedback().header.batch, number);
}

TEST(Batches, WhatWasNotTakenIsMergedAndOnlyTheNewestIsFelt) {
    Desk desk;
    const Handle first = desk.claim.add(ConstantForce{.recovery = 0});
    const Handle second = desk.claim.add(ConstantForce{.recovery = 0});
    desk.claim.commit();
    desk.force();
    desk.claim.update(first, ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    desk.claim.commit();
    for (int i = 0; i < 9; ++i) {
        desk.claim.update(second, ConstantForce{.force = {0, 0, 10.0 + i}, .recovery = 0});
        desk.claim.commit();
    }
    EXPECT_NEAR(desk.force(), 19, 1e-12) << "1 from the first of ten commits, 18 from the last";
    EXPECT_EQ(desk.servo.count(Count::batches_merged), 9u);
    EXPECT_EQ(desk.claim.feedback().header.batch, 11u);
}

TEST(Batches, AnEntryMayBringAPlanesShapeAlone) {
    Desk desk;
    Plane plane{.normal = {0, 0, 1}, .offset = -1, .stiffness = 100, .recovery = 0};
    plane.friction.viscous = 2;
    const Handle handle = desk.claim.add(plane);
    desk.force();
    plane.offset = 0.01;
    desk.claim.update(handle, kind_of<Plane>, &plane, Describe<Plane>::shape_bytes);
    desk.claim.commit();
    const double shallow = desk.force();
    plane.offset = 0.02;
    desk.claim.update(handle, plane);
    desk.claim.commit();
    EXPECT_NEAR(desk.force() - shallow, 1, 1e-9) << "100 N/m, 10 mm deeper";
    plane.stiffness = -1;
    desk.claim.update(handle, kind_of<Plane>, &plane, Describe<Plane>::shape_bytes);
    desk.claim.commit();
    desk.force();
    EXPECT_EQ(desk.servo.count(Count::batches_refused), 1u);
}

TEST(Batches, UpdatesOfWhatIsGoneAreNoOps) {
    Desk desk;
    const Handle first = desk.claim.add(ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    const Handle second = desk.claim.add(ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    desk.force();
    // The update crosses the removal: committed before, taken after it.
    desk.claim.remove(first);
    const ConstantForce late{.force = {0, 0, 100}, .recovery = 0};
    desk.claim.update(first, kind_of<ConstantForce>, &late, sizeof late);
    desk.claim.update(second, ConstantForce{.force = {0, 0, 3}, .recovery = 0});
    desk.claim.commit();
    EXPECT_NEAR(desk.force(), 3, 1e-12);
    EXPECT_EQ(desk.servo.count(Count::batches_refused), 0u);

    // The slot lives again in another generation: an update for the old one does not touch it.
    const ConstantForce reborn{.force = {0, 0, 5}, .recovery = 0};
    desk.claim.add({first.slot, 2}, kind_of<ConstantForce>, &reborn, sizeof reborn);
    desk.claim.update(first, kind_of<ConstantForce>, &late, sizeof late);
    desk.claim.commit();
    EXPECT_NEAR(desk.force(), 8, 1e-12);
}

TEST(Batches, AnEntryThatArrivesTwiceIsAppliedOnce) {
    Desk desk;
    const Handle handle = desk.claim.add(ConstantForce{.recovery = 0});
    desk.force();
    shm::TripleWriter writer(desk.claim.memory() + desk.claim.layout().batches,
                             desk.claim.layout().batch_slot_bytes);
    const auto send = [&](double force, std::uint64_t version, std::uint64_t sequence) {
        struct {
            protocol::BatchHeader header;
            protocol::EntryHeader entry;
            ConstantForce params;
        } batch;
        batch.header = {.sequence = sequence, .entries = 1, .bytes = sizeof batch - sizeof batch.header};
        batch.entry = {.handle = handle,
                       .kind = kind_of<ConstantForce>,
                       .bytes = sizeof(ConstantForce),
                       .version = version};
        batch.params = {.force = {0, 0, force}, .recovery = 0};
        writer.publish(&batch, sizeof batch);
        return desk.force();
    };
    EXPECT_EQ(send(1, 5, 1), 1);
    EXPECT_EQ(send(9, 5, 2), 1) << "the same version";
    EXPECT_EQ(send(9, 4, 3), 1) << "an older one";
    EXPECT_EQ(send(2, 6, 4), 2);
}

TEST(Batches, FeedbackSaysWhenABatchTookEffectAndHowLateItWas) {
    Desk desk;
    desk.claim.add(Desk::plane(100));
    run(desk.servo, 10);
    const std::uint64_t seen = desk.servo.servo().last().cycle;
    const std::int64_t read = desk.servo.servo().last().read_ns;
    run(desk.servo, 7);
    const std::uint64_t number = desk.claim.commit(seen, 1234);
    const Report& report = desk.servo.step();
    const auto& header = desk.claim.feedback().header;
    EXPECT_EQ(header.cycle, report.cycle);
    EXPECT_EQ(header.batch, number);
    EXPECT_EQ(header.batch_cycle, report.cycle);
    EXPECT_EQ(header.batch_report_cycle, seen);
    EXPECT_EQ(header.batch_commit_ns, 1234);
    EXPECT_EQ(header.batch_write_ns, report.write_ns);
    EXPECT_EQ(header.batch_age_ns, report.write_ns - read);
    EXPECT_EQ(header.batch_age_ns, 8'000'000);

    desk.claim.commit(seen + 1'000'000);  // a report that there has not been
    desk.servo.step();
    EXPECT_EQ(desk.claim.feedback().header.batch_age_ns, 0);
}

TEST(Batches, FeedbackTellsEachRepresentationsShare) {
    Desk desk;
    const Handle plane = desk.claim.add(Desk::plane(100));
    const Handle quiet = [&] {
        const ConstantForce force{.force = {0, 0, 2}, .recovery = 0};
        desk.claim.add({1, 1}, kind_of<ConstantForce>, &force, sizeof force, {.feedback = 0});
        return Handle{1, 1};
    }();
    const Spring spring{.anchor = {0, 0, 4e-3}, .stiffness = 100};
    desk.claim.add({2, 1}, kind_of<Spring>, &spring, sizeof spring);
    desk.force();
    const auto& felt = desk.claim.feedback();
    ASSERT_EQ(felt.entries.size(), 2u) << "those that ask for it";
    for (const auto& entry : felt.entries) {
        EXPECT_NE(entry.handle, quiet);
        if (entry.handle == plane) {
            EXPECT_NEAR(entry.force.z, 0.1, 1e-12);
            EXPECT_NEAR(entry.contact_point.z, 0, 1e-12);
            EXPECT_EQ(entry.stiffness, 100);
            EXPECT_NE(entry.flags & Feedback::touching, 0u);
        } else {
            EXPECT_NEAR(entry.force.z, 0.5, 1e-12);
        }
    }
}

}  // namespace
}  // namespace knurl::servo
