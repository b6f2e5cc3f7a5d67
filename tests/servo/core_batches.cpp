// Batches as the servo takes them: whole or not at all, never before the commands' turn, and told of.

#include <knurl/reps/describe.hpp>

#include "core_desk.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;
using protocol::Reply;
using Code = Verdict::Code;

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
    EXPECT_EQ(kinds()[kind_of<Plane>].contradictions[reply.reason], static_below_dynamic);
    EXPECT_EQ(reply.value, 0.25);

    const Handle plane = desk.claim.add(Plane{.stiffness = 1});
    desk.force();
    desk.claim.update(plane, contradictory);
    desk.claim.commit();
    desk.force();
    const auto& header = desk.claim.feedback().header;
    EXPECT_EQ(header.refused_code, static_cast<std::uint32_t>(Code::contradiction));
    EXPECT_EQ(kinds()[kind_of<Plane>].contradictions[header.refused_reason], static_below_dynamic);
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

TEST(Batches, AnEntryMayBringAPlanesGeometryAlone) {
    Desk desk;
    Plane plane{.normal = {0, 0, 1}, .offset = -1, .stiffness = 100, .recovery = 0};
    plane.friction.viscous = 2;
    const Handle handle = desk.claim.add(plane);
    desk.force();
    plane.offset = 0.01;
    desk.claim.update(handle, kind_of<Plane>, &plane, geometry_bytes<Plane>());
    desk.claim.commit();
    const double shallow = desk.force();
    plane.offset = 0.02;
    desk.claim.update(handle, plane);
    desk.claim.commit();
    EXPECT_NEAR(desk.force() - shallow, 1, 1e-9) << "100 N/m, 10 mm deeper";
    plane.offset = std::nan("");
    desk.claim.update(handle, kind_of<Plane>, &plane, geometry_bytes<Plane>());
    desk.claim.commit();
    desk.force();
    EXPECT_EQ(desk.servo.count(Count::batches_refused), 1u);
}

namespace {

template <class R>
void takes_the_geometry_alone() {
    SCOPED_TRACE(Describe<R>::name);
    const R params{};
    const std::size_t geometry = geometry_bytes<R>();
    Desk desk;
    const Handle handle = desk.claim.add(params);
    desk.force();
    const auto send = [&](std::size_t bytes) {
        desk.claim.update(handle, kind_of<R>, &params, bytes);
        desk.claim.commit();
        desk.force();
        return desk.claim.feedback().header;
    };
    EXPECT_EQ(send(sizeof params).batches_refused, 0u);
    EXPECT_EQ(send(geometry).batches_refused, 0u);
    const protocol::FeedbackHeader header = send(geometry - 8);
    EXPECT_EQ(header.batches_refused, 1u);
    const std::string line = describe(protocol::verdict_of(header), header.refused_kind, "");
    EXPECT_EQ(line, std::string(Describe<R>::name) + ": parameters of " + std::to_string(geometry - 8) +
                        " bytes instead of " + std::to_string(sizeof params) +
                        (Surface<R> ? " (or of " + std::to_string(geometry) + ", its geometry alone)" : "") +
                        "; build the application and the servo from the same version");
}

template <class... R>
void each_takes_the_geometry_alone(TypeList<R...>) {
    (takes_the_geometry_alone<R>(), ...);
}

}  // namespace

TEST(Batches, OfAnyKindAnEntryBringsAllOrTheGeometryAlone) {
    each_takes_the_geometry_alone(Representations{});
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

TEST(Batches, OfTwoEntriesForOneRepresentationTheLastIsAppliedWholeWhateverTheirVersions) {
    for (const bool upwards : {true, false}) {
        Desk desk;
        const Plane before{.offset = -1, .stiffness = 100, .recovery = 0};
        const Handle handle = desk.claim.add(before);
        desk.force();
        // The one differs from what is in force in its way of acting, the other in its place alone.
        struct Entry {
            protocol::EntryHeader header;
            Plane params;
        };
        struct {
            protocol::BatchHeader header;
            Entry entries[2];
        } batch;
        Plane other = before, last = before;
        other.combine = PlaneCombine::sum;
        other.offset = 0.5;
        last.offset = 0.01;
        batch.header = {.sequence = 1, .entries = 2, .bytes = sizeof batch - sizeof batch.header};
        for (Entry& entry : batch.entries)
            entry.header = {.handle = handle, .kind = kind_of<Plane>, .bytes = sizeof(Plane)};
        batch.entries[0].header.version = upwards ? 4 : 5;
        batch.entries[1].header.version = upwards ? 5 : 4;
        batch.entries[0].params = other;
        batch.entries[1].params = last;
        shm::TripleWriter writer(desk.claim.memory() + desk.claim.layout().batches,
                                 desk.claim.layout().batch_slot_bytes);
        writer.publish(&batch, sizeof batch);
        EXPECT_NEAR(desk.force(), 1.1, 1e-9) << "100 N/m, 11 mm deep; upwards: " << upwards;
    }
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
