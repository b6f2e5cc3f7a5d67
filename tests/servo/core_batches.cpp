// How the servo takes batches: whole or not at all, never before earlier commands, and acknowledged.

#include <knurl/reps/all.hpp>
#include <knurl/reps/describe.hpp>

#include "core_claim_fixture.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;
using protocol::Reply;
using Code = Verdict::Code;

TEST(Batches, AllOfABatchTakesEffectInOneCycle) {
    ClaimFixture fixture;
    const RepresentationId spring =
        fixture.claim.add(Spring{.anchor = {0, 0, -1e-3}, .stiffness = 100, .duration = 0});
    const RepresentationId pull = fixture.claim.add(ConstantForce{.recovery = 0});
    fixture.force();
    fixture.claim.update(spring, Spring{.anchor = {0, 0, 9e-3}, .stiffness = 100, .duration = 0});
    fixture.claim.update(pull, ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    EXPECT_EQ(fixture.force(), 0) << "before the commit nothing is sent";
    fixture.claim.commit();
    EXPECT_NEAR(fixture.force(), 3, 1e-12);
}

TEST(Batches, AContradictionIsRefusedWithItsReason) {
    ClaimFixture fixture;
    const Plane contradictory{.stiffness = 1, .friction = {.static_ = 0.25, .dynamic = 0.5}};
    fixture.claim.add(contradictory);
    fixture.servo.step();
    const Reply reply = fixture.claim.replies().at(0);
    EXPECT_EQ(reply.code, static_cast<std::uint32_t>(Code::contradiction));
    EXPECT_EQ(kinds()[kind_of<Plane>].contradictions[reply.reason], static_below_dynamic);
    EXPECT_EQ(reply.value, 0.25);

    const RepresentationId plane = fixture.claim.add(Plane{.stiffness = 1});
    fixture.force();
    fixture.claim.update(plane, contradictory);
    fixture.claim.commit();
    fixture.force();
    const auto& header = fixture.claim.feedback().header;
    EXPECT_EQ(header.refused_code, static_cast<std::uint32_t>(Code::contradiction));
    EXPECT_EQ(kinds()[kind_of<Plane>].contradictions[header.refused_reason], static_below_dynamic);
    EXPECT_EQ(Describe<Plane>::fields[header.refused_field].name, "friction.static");
    EXPECT_EQ(header.refused_value, 0.25);
}

TEST(Batches, ABadParameterRefusesTheWholeBatchAndTheOwnerIsTold) {
    ClaimFixture fixture;
    const RepresentationId first = fixture.claim.add(ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    const RepresentationId second = fixture.claim.add(ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    fixture.force();
    fixture.claim.update(first, ConstantForce{.force = {0, 0, 10}, .recovery = 0});
    fixture.claim.update(second, ConstantForce{.force = {0, 0, 20}, .recovery = -3});
    const std::uint64_t number = fixture.claim.commit();
    EXPECT_NEAR(fixture.force(), 3, 1e-12) << "old parameters stay";

    const auto& header = fixture.claim.feedback().header;
    EXPECT_EQ(header.batches_refused, 1u);
    EXPECT_EQ(header.refused_batch, number);
    EXPECT_EQ(header.refused_code, static_cast<std::uint32_t>(Code::out_of_range));
    EXPECT_EQ(Describe<ConstantForce>::fields[header.refused_field].name, "recovery");
    EXPECT_EQ(header.refused_value, -3);
    EXPECT_EQ(header.refused_kind, kind_of<ConstantForce>);
    EXPECT_EQ(header.refused_slot, second.slot);
    EXPECT_EQ(header.batch, 0u) << "none has taken effect";

    // Without the mistake the batch is taken.
    fixture.claim.update(first, ConstantForce{.force = {0, 0, 11}, .recovery = 0});
    fixture.claim.update(second, ConstantForce{.force = {0, 0, 20}, .recovery = 0});
    fixture.claim.commit();
    EXPECT_NEAR(fixture.force(), 31, 1e-12);
}

TEST(Batches, ABatchNeverOvertakesTheCommandsIssuedBeforeIt) {
    ClaimFixture fixture;
    // Fills the replies so that the servo cannot execute further commands.
    for (std::uint32_t i = 0; i < protocol::reply_cells; ++i) fixture.claim.place_probe(1, {});
    run(fixture.servo, 20);
    const RepresentationId pull = fixture.claim.add(ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    fixture.claim.update(pull, ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    const std::uint64_t number = fixture.claim.commit();
    for (int i = 0; i < 20; ++i) EXPECT_EQ(fixture.force(), 0);
    EXPECT_EQ(fixture.servo.count(Count::batches_taken), 0u) << "its add is not done yet";

    fixture.claim.replies();
    EXPECT_NEAR(fixture.force(), 2, 1e-12) << "the command, and then the batch, in one cycle";
    EXPECT_EQ(fixture.claim.feedback().header.batch, number);
}

TEST(Batches, WhatWasNotTakenIsMergedAndOnlyTheNewestIsFelt) {
    ClaimFixture fixture;
    const RepresentationId first = fixture.claim.add(ConstantForce{.recovery = 0});
    const RepresentationId second = fixture.claim.add(ConstantForce{.recovery = 0});
    fixture.claim.commit();
    fixture.force();
    fixture.claim.update(first, ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    fixture.claim.commit();
    for (int i = 0; i < 9; ++i) {
        fixture.claim.update(second, ConstantForce{.force = {0, 0, 10.0 + i}, .recovery = 0});
        fixture.claim.commit();
    }
    EXPECT_NEAR(fixture.force(), 19, 1e-12) << "1 from the first of ten commits, 18 from the last";
    EXPECT_EQ(fixture.servo.count(Count::batches_merged), 9u);
    EXPECT_EQ(fixture.claim.feedback().header.batch, 11u);
}

TEST(Batches, AnEntryMayBringAPlanesGeometryAlone) {
    ClaimFixture fixture;
    Plane plane{.normal = {0, 0, 1}, .offset = -1, .stiffness = 100, .recovery = 0};
    plane.friction.viscous = 2;
    const RepresentationId id = fixture.claim.add(plane);
    fixture.force();
    plane.offset = 0.01;
    fixture.claim.update(id, kind_of<Plane>, &plane, geometry_bytes<Plane>());
    fixture.claim.commit();
    const double shallow = fixture.force();
    plane.offset = 0.02;
    fixture.claim.update(id, plane);
    fixture.claim.commit();
    EXPECT_NEAR(fixture.force() - shallow, 1, 1e-9) << "100 N/m, 10 mm deeper";
    plane.offset = std::nan("");
    fixture.claim.update(id, kind_of<Plane>, &plane, geometry_bytes<Plane>());
    fixture.claim.commit();
    fixture.force();
    EXPECT_EQ(fixture.servo.count(Count::batches_refused), 1u);
}

namespace {

template <class R>
void takes_the_geometry_alone() {
    SCOPED_TRACE(Describe<R>::name);
    const R params{};
    const std::size_t geometry = geometry_bytes<R>();
    ClaimFixture fixture;
    const RepresentationId id = fixture.claim.add(params);
    fixture.force();
    const auto send = [&](std::size_t bytes) {
        fixture.claim.update(id, kind_of<R>, &params, bytes);
        fixture.claim.commit();
        fixture.force();
        return fixture.claim.feedback().header;
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
    ClaimFixture fixture;
    const RepresentationId first = fixture.claim.add(ConstantForce{.force = {0, 0, 1}, .recovery = 0});
    const RepresentationId second = fixture.claim.add(ConstantForce{.force = {0, 0, 2}, .recovery = 0});
    fixture.force();
    // The update crosses the removal: committed before it, taken after it.
    fixture.claim.remove(first);
    const ConstantForce late{.force = {0, 0, 100}, .recovery = 0};
    fixture.claim.update(first, kind_of<ConstantForce>, &late, sizeof late);
    fixture.claim.update(second, ConstantForce{.force = {0, 0, 3}, .recovery = 0});
    fixture.claim.commit();
    EXPECT_NEAR(fixture.force(), 3, 1e-12);
    EXPECT_EQ(fixture.servo.count(Count::batches_refused), 0u);

    // The slot is used again with another generation: an update for the old one does not affect it.
    const ConstantForce reborn{.force = {0, 0, 5}, .recovery = 0};
    fixture.claim.add({first.slot, 2}, kind_of<ConstantForce>, &reborn, sizeof reborn);
    fixture.claim.update(first, kind_of<ConstantForce>, &late, sizeof late);
    fixture.claim.commit();
    EXPECT_NEAR(fixture.force(), 8, 1e-12);
}

TEST(Batches, AnEntryThatArrivesTwiceIsAppliedOnce) {
    ClaimFixture fixture;
    const RepresentationId id = fixture.claim.add(ConstantForce{.recovery = 0});
    fixture.force();
    shm::TripleWriter writer(fixture.claim.memory() + fixture.claim.layout().batches,
                             fixture.claim.layout().batch_slot_bytes);
    const auto send = [&](double force, std::uint64_t version, std::uint64_t sequence) {
        struct {
            protocol::BatchHeader header;
            protocol::EntryHeader entry;
            ConstantForce params;
        } batch;
        batch.header = {.sequence = sequence, .entries = 1, .bytes = sizeof batch - sizeof batch.header};
        batch.entry = {
            .id = id, .kind = kind_of<ConstantForce>, .bytes = sizeof(ConstantForce), .version = version};
        batch.params = {.force = {0, 0, force}, .recovery = 0};
        writer.publish(&batch, sizeof batch);
        return fixture.force();
    };
    EXPECT_EQ(send(1, 5, 1), 1);
    EXPECT_EQ(send(9, 5, 2), 1) << "the same version";
    EXPECT_EQ(send(9, 4, 3), 1) << "an older one";
    EXPECT_EQ(send(2, 6, 4), 2);
}

TEST(Batches, OfTwoEntriesForOneRepresentationTheLastIsAppliedWholeWhateverTheirVersions) {
    for (const bool upwards : {true, false}) {
        ClaimFixture fixture;
        const Plane before{.offset = -1, .stiffness = 100, .recovery = 0};
        const RepresentationId id = fixture.claim.add(before);
        fixture.force();
        // One entry differs from the parameters in force in how it acts, the other only in its place.
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
            entry.header = {.id = id, .kind = kind_of<Plane>, .bytes = sizeof(Plane)};
        batch.entries[0].header.version = upwards ? 4 : 5;
        batch.entries[1].header.version = upwards ? 5 : 4;
        batch.entries[0].params = other;
        batch.entries[1].params = last;
        shm::TripleWriter writer(fixture.claim.memory() + fixture.claim.layout().batches,
                                 fixture.claim.layout().batch_slot_bytes);
        writer.publish(&batch, sizeof batch);
        EXPECT_NEAR(fixture.force(), 1.1, 1e-9) << "100 N/m, 11 mm deep; upwards: " << upwards;
    }
}

TEST(Batches, FeedbackSaysWhenABatchTookEffectAndHowLateItWas) {
    ClaimFixture fixture;
    fixture.claim.add(ClaimFixture::plane(100));
    run(fixture.servo, 10);
    const std::uint64_t seen = fixture.servo.servo().last().cycle;
    const std::int64_t read = fixture.servo.servo().last().read_ns;
    run(fixture.servo, 7);
    const std::uint64_t number = fixture.claim.commit(seen, 1234);
    const Report& report = fixture.servo.step();
    const auto& header = fixture.claim.feedback().header;
    EXPECT_EQ(header.cycle, report.cycle);
    EXPECT_EQ(header.batch, number);
    EXPECT_EQ(header.batch_cycle, report.cycle);
    EXPECT_EQ(header.batch_report_cycle, seen);
    EXPECT_EQ(header.batch_commit_ns, 1234);
    EXPECT_EQ(header.batch_write_ns, report.write_ns);
    EXPECT_EQ(header.batch_age_ns, report.write_ns - read);
    EXPECT_EQ(header.batch_age_ns, 8'000'000);

    fixture.claim.commit(seen + 1'000'000);  // a report that does not exist yet
    fixture.servo.step();
    EXPECT_EQ(fixture.claim.feedback().header.batch_age_ns, 0);
}

TEST(Batches, FeedbackTellsEachRepresentationsShare) {
    ClaimFixture fixture;
    const RepresentationId plane = fixture.claim.add(ClaimFixture::plane(100));
    const RepresentationId quiet = [&] {
        const ConstantForce force{.force = {0, 0, 2}, .recovery = 0};
        fixture.claim.add({1, 1}, kind_of<ConstantForce>, &force, sizeof force, {.feedback = 0});
        return RepresentationId{1, 1};
    }();
    const Spring spring{.anchor = {0, 0, 4e-3}, .stiffness = 100};
    fixture.claim.add({2, 1}, kind_of<Spring>, &spring, sizeof spring);
    fixture.force();
    const auto& felt = fixture.claim.feedback();
    ASSERT_EQ(felt.entries.size(), 2u) << "those that ask for it";
    for (const auto& entry : felt.entries) {
        EXPECT_NE(entry.id, quiet);
        if (entry.id == plane) {
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
