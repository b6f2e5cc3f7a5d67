// Idle claims sleep, without any visible difference.

#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include <knurl/reps/all.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::CommandType;

/// Events can occur while a cycle reads the clock: after its read, and after its write.
struct InterruptedClock final : Clock {
    Nanoseconds time = 0;
    std::function<void()> at_reading;
    Nanoseconds now() noexcept override {
        if (at_reading) at_reading();
        return time;
    }
};

/// A servo with a crowd that holds its device, mostly silent.
struct Crowd {
    static constexpr std::size_t applications = 12, observers = 2;

    explicit Crowd(bool sleep) {
        ServoOptions options = live_options();
        options.sleep = sleep;
        servo = std::make_unique<Servo>(device, clock, segment.data(), options);
        for (std::size_t i = 0; i < applications + observers; ++i) {
            ClaimTerms terms;
            terms.observer = i >= applications;
            terms.capacity = {.representations = terms.observer ? 0u : 16u,
                              .batch_bytes = terms.observer ? 0u : 4096u};
            if (i % 4 == 1) {
                terms.frame.scale = 3;
                terms.frame.world_centre = {0.01, 0.02, -0.03};
            }
            terms.limits = limits_for(device.link(), options.rate, terms.frame);
            terms.update_interval = i % 3 == 0 ? 0.02 : 0;
            if (!terms.observer) {
                claims.push_back(std::make_unique<OfflineClaim>(terms, nullptr, &rows[i]));
                ids.emplace_back();
                servo->adopt(&claims.back()->servo_side());
            } else {
                watching.push_back(
                    std::make_unique<OfflineMemory>(protocol::claim_layout(terms.capacity).total));
                watchers.push_back(std::make_unique<Claim>(terms, watching.back()->data(), &rows[i]));
                servo->adopt(watchers.back().get());
            }
        }
    }

    void step() {
        clock.time += 1'000'000;
        servo->step(clock.time, clock.time);
    }
    /// What application `i` does.
    void act(std::size_t i, unsigned what, double size) {
        OfflineClaim& claim = *claims[i];
        std::vector<RepresentationId>& held = ids[i];
        switch (what) {
            case 0:
                return claim.arm();
            case 1:
                return claim.disarm();
            case 2:
                return claim.reset_fault();
            case 3: {  // acts on the hand, and stiff enough for several to exceed the budget
                if (held.size() >= 3) return;
                held.push_back({next_slot++ % 16, next_slot});
                if (next_slot % 8 == 0) {  // with bounds, which the hand reaches at times
                    const Sphere ball{
                        .center = {0.01, 0.02 * size - 0.02, 0}, .radius = 0.003, .stiffness = 300};
                    return claim.add(held.back(), kind_of<Sphere>, &ball, sizeof ball);
                }
                Plane plane{.offset = 0.01, .stiffness = 1000 * size};
                if (next_slot % 2 == 0) {  // out of reach for ever, or most of the time
                    plane.offset = -0.01 - 0.04 * size;
                    plane.friction = {.static_ = 0.5, .dynamic = 0.4};
                }
                const AddOptions use{.on_silence = static_cast<OnSilence>(next_slot % 3)};
                return claim.add(held.back(), kind_of<Plane>, &plane, sizeof plane, use);
            }
            case 4:
                if (held.empty()) return;
                claim.remove(held.back());
                return held.pop_back();
            case 5:
                if (!held.empty() && held.back().generation % 8 != 0)
                    claim.update(held.back(), Plane{.offset = 0.05 * size - 0.06, .stiffness = 200});
                [[fallthrough]];
            default:
                claim.commit();
        }
    }

    PuppetDevice device;
    InterruptedClock clock;
    OfflineMemory segment{protocol::device_layout().total};
    std::array<protocol::ClientRow, applications + observers> rows{};
    std::vector<std::unique_ptr<OfflineMemory>> watching;
    std::vector<std::unique_ptr<Claim>> watchers;
    std::vector<std::unique_ptr<OfflineClaim>> claims;
    std::vector<std::vector<RepresentationId>> ids;
    std::uint32_t next_slot = 0;
    std::unique_ptr<Servo> servo;
};

/// Everything visible of both: reports, the device's efforts, the table, counters, replies, feedback.
void expect_same(Crowd& one, Crowd& other) {
    ASSERT_EQ(std::memcmp(&one.servo->last(), &other.servo->last(), sizeof(Report)), 0);
    ASSERT_EQ(std::memcmp(&one.device.last, &other.device.last, sizeof one.device.last), 0);
    ASSERT_EQ(one.device.notice_count, other.device.notice_count);
    const std::size_t counters = protocol::device_layout().counters;
    ASSERT_EQ(std::memcmp(one.segment.data() + counters, other.segment.data() + counters,
                          protocol::device_layout().clients - counters),
              0);
    const auto row_bytes = [](const Crowd& crowd) {
        return reinterpret_cast<const char*>(crowd.rows.data());
    };
    ASSERT_EQ(std::memcmp(row_bytes(one), row_bytes(other), sizeof one.rows), 0);
    for (std::size_t i = 0; i < Crowd::applications; ++i) {
        SCOPED_TRACE("application " + std::to_string(i));
        const auto replies = one.claims[i]->replies(), expected = other.claims[i]->replies();
        ASSERT_EQ(replies.size(), expected.size());
        for (std::size_t r = 0; r < replies.size(); ++r)
            ASSERT_EQ(std::memcmp(&replies[r], &expected[r], sizeof replies[r]), 0);
        const OfflineClaim::FeedbackSet &felt = one.claims[i]->feedback(),
                                        &wanted = other.claims[i]->feedback();
        ASSERT_EQ(std::memcmp(&felt.header, &wanted.header, sizeof felt.header), 0);
        ASSERT_EQ(felt.entries.size(), wanted.entries.size());
        for (std::size_t e = 0; e < felt.entries.size(); ++e)
            ASSERT_EQ(std::memcmp(&felt.entries[e], &wanted.entries[e], sizeof felt.entries[e]), 0);
    }
}

TEST(Sleep, NobodyCanTell) {
    int silent = 0, shared = 0, active = 0, idle = 0, faults = 0, left_alone = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        const auto chance = [&](std::uint64_t one_in) { return random() % one_in == 0; };
        Crowd sleeping(true), awake(false);
        std::vector<bool> gone(Crowd::applications);
        int away = 0;
        for (int cycle = 0; cycle < 6000; ++cycle) {
            // From lively to very quiet, so that sleep begins and ends in every way.
            if (chance(std::uint64_t{10} << (cycle / 1000))) {
                const std::size_t i = random() % Crowd::applications;
                const auto what = static_cast<unsigned>(random() % 7);
                const double size = static_cast<double>(random() % 100) / 50;
                for (Crowd* crowd : {&sleeping, &awake})
                    if (!gone[i]) crowd->act(i, what, size);
                if (!gone[i] && chance(60)) {
                    gone[i] = true;
                    for (Crowd* crowd : {&sleeping, &awake})
                        crowd->servo->drop(&crowd->claims[i]->servo_side());
                }
            }
            if (away > 0 ? --away == 0 : chance(2500) && (away = 40, true))
                for (Crowd* crowd : {&sleeping, &awake})
                    crowd->device.status =
                        away > 0 ? drivers::ReadStatus::unplugged : drivers::ReadStatus::ok;
            if (chance(4000))
                for (Crowd* crowd : {&sleeping, &awake}) crowd->servo->clock_jumped();
            const double t = 1e-3 * cycle;
            for (Crowd* crowd : {&sleeping, &awake}) {
                crowd->device.tip = 0.02 * Eigen::Vector3d(std::sin(3 * t), std::cos(2 * t), std::sin(7 * t));
                crowd->step();
            }
            expect_same(sleeping, awake);
            ASSERT_FALSE(::testing::Test::HasFatalFailure()) << "cycle " << cycle;
            const DeviceState state = sleeping.servo->last().state;
            active += state == DeviceState::active;
            idle += state == DeviceState::idle;
            faults += state == DeviceState::fault;
            silent += sleeping.rows[0].silent.load() == 1;
            for (std::size_t i = 0; i < Crowd::applications; ++i) {
                const protocol::FeedbackHeader& said = sleeping.claims[i]->feedback().header;
                left_alone += !gone[i] && said.entries > 0 && said.cycle < sleeping.servo->last().cycle;
            }
            shared += protocol::scales_of(sleeping.claims[0]->feedback().header).contacts < 1;
        }
    }
    EXPECT_GT(silent, 100);
    EXPECT_GT(shared, 100);
    EXPECT_GT(left_alone, 10'000) << "scenes out of reach were not left alone";
    EXPECT_GT(active, 100);
    EXPECT_GT(idle, 100);
    EXPECT_GT(faults, 100);
}

/// Without raising the count.
void send_without_counting(OfflineClaim& claim, CommandType type, std::uint64_t number) {
    shm::SpscProducer commands(claim.memory() + claim.layout().commands, claim.layout().command_cells);
    std::array<std::byte, shm::cell_bytes> cell{};
    const protocol::CommandHeader header{.cells = 1, .type = type, .number = number};
    std::memcpy(cell.data(), &header, sizeof header);
    EXPECT_TRUE(commands.try_push(cell.data(), 1));
}
shm::SentCount count_of(OfflineClaim& claim) {
    return shm::SentCount(reinterpret_cast<shm::WaiterFlag*>(claim.memory() + claim.layout().waiter));
}

/// A message without a count stays unread, which harms only its sender. The first counted message brings all
/// of them.
TEST(Sleep, LooksAtOneWordAlone) {
    Crowd crowd(true);
    for (int i = 0; i < 1000; ++i) crowd.step();
    OfflineClaim& claim = *crowd.claims[1];
    send_without_counting(claim, CommandType::arm, 1);
    for (int i = 0; i < 1000; ++i) crowd.step();
    EXPECT_TRUE(claim.replies().empty()) << "its rings were looked at";
    crowd.claims[2]->arm();
    crowd.step();
    EXPECT_EQ(crowd.claims[2]->replies().size(), 1u) << "who counts is heard in the same cycle";
    EXPECT_TRUE(claim.replies().empty());
    send_without_counting(claim, CommandType::arm, 2);
    count_of(claim).add();
    crowd.step();
    EXPECT_EQ(claim.replies().size(), 2u);
}

/// A message may arrive at any moment of a claim's falling asleep, and be counted at any later moment. The
/// first cycle that begins after the count has it.
TEST(Sleep, NoMomentIsMissed) {
    Crowd crowd(true);
    for (int i = 0; i < 400; ++i) crowd.step();
    OfflineClaim& claim = *crowd.claims[0];
    shm::SentCount count = count_of(claim);
    std::uint64_t sent = 0;
    // Three moments of a cycle: before it, before the rings are read, and after that.
    constexpr int of_a_cycle = 3, moments = 6 * of_a_cycle;
    for (int push_at = 0; push_at < moments; ++push_at)
        for (int count_at = push_at; count_at < push_at + 2 * of_a_cycle; ++count_at) {
            SCOPED_TRACE("pushed at " + std::to_string(push_at) + ", counted at " + std::to_string(count_at));
            count.add();  // looked at again
            int moment = 0;
            const auto pass = [&] {
                if (moment == push_at) send_without_counting(claim, CommandType::disarm, ++sent);
                if (moment == count_at) count.add();
                ++moment;
            };
            crowd.clock.at_reading = pass;
            std::size_t answers = 0;
            while (moment < moments + 2 * of_a_cycle) {
                const bool counted = count_at <= moment;
                pass();
                crowd.step();
                answers += claim.replies().size();
                if (counted) {
                    ASSERT_EQ(answers, 1u) << "at " << moment;
                }
            }
            crowd.clock.at_reading = nullptr;
        }
}

/// A claim that always counts and sends nothing is processed in every cycle, as before; the others sleep.
TEST(Sleep, WhoAlwaysCountsIsLookedAtAlone) {
    Crowd crowd(true);
    for (int i = 0; i < 1000; ++i) crowd.step();
    OfflineClaim& loud = *crowd.claims[1];
    OfflineClaim& quiet = *crowd.claims[2];
    shm::SentCount count = count_of(loud);
    for (int i = 0; i < 100; ++i) {
        count.add();
        crowd.step();
    }
    send_without_counting(loud, CommandType::arm, 1);
    send_without_counting(quiet, CommandType::arm, 1);
    count.add();
    crowd.step();
    EXPECT_EQ(loud.replies().size(), 1u);
    EXPECT_TRUE(quiet.replies().empty());
}

}  // namespace
}  // namespace knurl::servo
