// The work of all claims together: what is refused, shed and ramped down when cycles get too long.

#include <array>
#include <memory>

#include <knurl/shm/counters.hpp>

#include "core_active.hpp"

namespace knurl::servo::core_load_tests {
namespace {

using namespace testing;
using protocol::Count;
using protocol::RefusalReason;

constexpr Nanoseconds period = 1'000'000;

/// Runs so many cycles of this length.
void run_long(Active& active, int cycles, Nanoseconds took) {
    for (int i = 0; i < cycles; ++i) {
        active.servo.step();
        active.servo.servo().took(took);
    }
}

RefusalReason answer(OfflineClaim& claim) {
    return static_cast<RefusalReason>(claim.replies().back().reason);
}

TEST(Load, CyclesLongerThanThePeriodRampTheDeviceDownAndAreAFault) {
    Active active;
    run_long(active, 100, period / 2);
    EXPECT_EQ(active.state(), DeviceState::active);
    double last = active.device.force().z();
    int cycles = 0;
    while (active.state() == DeviceState::active && ++cycles < 200) run_long(active, 1, period * 13 / 10);
    // From 0.5 to 1 of 1.3 with a memory of 20 ms: 20 ms ln(0.8 / 0.3) = 19.6 ms.
    EXPECT_NEAR(cycles, 20, 3);
    EXPECT_EQ(active.state(), DeviceState::ramp_down);
    while (active.state() == DeviceState::ramp_down) {
        EXPECT_LE(last - active.device.force().z(), 2 * 0.5 / 50 + 1e-9) << "N: two ramps, no step";
        last = active.device.force().z();
        run_long(active, 1, period * 13 / 10);
    }
    run_long(active, 2, period * 13 / 10);
    EXPECT_EQ(active.state(), DeviceState::fault);
    EXPECT_EQ(active.faults(), fault::overload);
    EXPECT_TRUE(active.device.force().isZero(0));

    // While the cause goes on nobody resets it; once it has gone, it is reset and armed as after any fault.
    active.claim.reset_fault();
    run_long(active, 1, period * 13 / 10);
    EXPECT_EQ(answer(active.claim), RefusalReason::cause_persists);
    run_long(active, 200, period / 10);
    active.claim.reset_fault();
    active.claim.arm();
    run_long(active, 700, period / 10);
    EXPECT_EQ(active.state(), DeviceState::active);
    EXPECT_EQ(active.faults(), 0u);
}

TEST(Load, OneLongCycleIsNoLoad) {
    Active active;
    for (int i = 0; i < 20; ++i) {
        run_long(active, 1, 19 * period);
        run_long(active, 40, period / 10);
        ASSERT_EQ(active.state(), DeviceState::active) << i;
    }
}

TEST(Load, NewWorkIsRefusedWhereTheCycleHasNoTimeForIt) {
    Active active;
    run_long(active, 200, period * 65 / 100);
    active.claim.add(Plane{});
    run_long(active, 1, period * 65 / 100);
    const auto replies = active.claim.replies();
    EXPECT_EQ(static_cast<RefusalReason>(replies.back().reason), RefusalReason::cycle_full);
    EXPECT_NEAR(replies.back().value, 0.65, 0.01);
    EXPECT_DOUBLE_EQ(replies.back().against, 0.6);
    EXPECT_NEAR(active.device.force().z(), 0.5, 1e-12) << "what is there is felt as before";
    run_long(active, 200, period / 2);
    active.claim.add(Plane{});
    run_long(active, 1, period / 2);
    EXPECT_EQ(answer(active.claim), RefusalReason::none);
}

/// Advances at each reading, so each claim takes as long as any other.
struct MeteredClock final : Clock {
    Nanoseconds time = 0;
    Nanoseconds now() noexcept override { return time += 40'000; }
};

/// One claim of process 1 (at `alone`) and three of process 2, each with a plane of 500 N/m, the hand 1 mm deep in all.
struct Crowd {
    PuppetDevice device;
    MeteredClock clock;
    OfflineMemory segment{protocol::device_layout().total};
    Servo servo{device, clock, segment.data(), Active::without_silence()};
    std::array<protocol::ClientRow, 4> rows{};
    std::vector<std::unique_ptr<OfflineMemory>> memory;
    std::vector<std::unique_ptr<OfflineClaim>> claims;
    Nanoseconds at = 0;

    explicit Crowd(std::size_t alone = 1) {
        device.tip = {0, 0, -1e-3};
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rows[i].pid = i == alone ? 1 : 2;
            ClaimTerms terms;
            terms.capacity = {.representations = 16, .batch_bytes = 4096};
            terms.frame = frame_for(device.link(), {});
            terms.limits = limits_for(device.link(), 1000, terms.frame);
            terms.shared = true;
            memory.push_back(std::make_unique<OfflineMemory>(protocol::claim_layout(terms.capacity).total));
            claims.push_back(std::make_unique<OfflineClaim>(terms, memory.back()->data(), &rows[i]));
            EXPECT_TRUE(servo.adopt(&claims.back()->servo_side()));
            claims.back()->add(Plane{.stiffness = 500, .recovery = 0});
            claims.back()->add(Plane{.offset = -1, .stiffness = 500, .recovery = 0});
            claims.back()->arm();
        }
        run(600, period / 10);
        EXPECT_EQ(servo.last().state, DeviceState::active);
        EXPECT_NEAR(device.force().z(), 2.0, 1e-9);
    }
    void run(int cycles, Nanoseconds took) {
        for (int i = 0; i < cycles; ++i) {
            at += period;
            servo.step(at, at);
            servo.took(took);
        }
    }
    std::uint64_t count(Count which) const {
        return shm::CountersReader(segment.data() + protocol::device_layout().counters, protocol::count_names)
            .read(static_cast<std::size_t>(which));
    }
    std::vector<std::size_t> shed_rows() const {
        std::vector<std::size_t> shed;
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (rows[i].shed != 0) shed.push_back(i);
        return shed;
    }
};

/// All claims take the same time, so the first and the last show that processes are compared, not claims.
class LoadOfProcesses : public ::testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Alone, LoadOfProcesses, ::testing::Values(0, 1, 3));

TEST_P(LoadOfProcesses, TheOneThatTakesMostIsShedAndTheOthersForceStays) {
    Crowd crowd(GetParam());
    for (int i = 0; i < 200 && crowd.count(Count::claims_shed) == 0; ++i) crowd.run(1, period * 8 / 10);
    ASSERT_EQ(crowd.count(Count::claims_shed), 1u);
    double last = crowd.device.force().z(), steepest = 0;
    for (int i = 0; i < 100; ++i) {
        crowd.run(1, period / 10);
        steepest = std::max(steepest, std::abs(crowd.device.force().z() - last));
        last = crowd.device.force().z();
    }
    ASSERT_EQ(crowd.shed_rows().size(), 1u);
    const std::size_t shed = crowd.shed_rows()[0];
    EXPECT_NE(shed, GetParam()) << "process 1 takes a quarter, process 2 the rest";
    EXPECT_NEAR(crowd.device.force().z(), 1.5, 1e-9);
    EXPECT_LE(steepest, 0.5 / 50 + 1e-9) << "N a cycle: its force fades";
    EXPECT_EQ(crowd.servo.last().state, DeviceState::active);
    EXPECT_EQ(crowd.servo.last().faults, 0u);

    // It comes back with half of what it had, or less.
    OfflineClaim& claim = *crowd.claims[shed];
    (void)claim.replies();
    claim.arm();
    crowd.run(32, period / 10);
    const protocol::Reply refused = claim.replies().back();
    EXPECT_EQ(static_cast<RefusalReason>(refused.reason), RefusalReason::cycle_full);
    EXPECT_EQ(refused.against, 0) << "that it was shed";
    claim.add(Plane{});
    crowd.run(32, period / 10);
    EXPECT_EQ(answer(claim), RefusalReason::cycle_full);
    claim.remove({1, 1});
    crowd.run(32, period / 10);
    claim.arm();
    crowd.run(120, period / 10);
    EXPECT_EQ(answer(claim), RefusalReason::none);
    EXPECT_TRUE(crowd.shed_rows().empty());
    EXPECT_NEAR(crowd.device.force().z(), 2.0, 1e-9);
}

TEST(Load, WithoutLongCyclesTheClockIsReadNoMoreOftenThanBefore) {
    Crowd crowd;
    const auto readings = [&](Nanoseconds took) {
        crowd.run(2, took);
        const Nanoseconds before = crowd.clock.time;
        crowd.run(1, took);
        return (crowd.clock.time - before) / 40'000;
    };
    EXPECT_LE(readings(period / 10), 2 + 7) << "reads, writes, and in one cycle in 64 the stages";
    EXPECT_GE(readings(period * 55 / 100), 2 + 8) << "each claim twice";
}

}  // namespace
}  // namespace knurl::servo::core_load_tests
