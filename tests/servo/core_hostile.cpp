// Bytes in a claim's segment that no library would write. For all of them: no crash, bounded work, a finite
// and bounded wrench, and no effect on another claim, to the bit.

#include <cmath>
#include <cstring>
#include <random>

#include <knurl/reps/all.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;

/// An honest claim on a spring along x, its application committing every 20 cycles; the hand moves.
struct Honest {
    PuppetDevice device;
    Offline servo;
    OfflineClaim& claim;
    RepresentationId spring;
    int cycle = 0;

    Honest() : servo(device, options()), claim(servo.claim()) {
        spring = claim.add(Spring{.stiffness = 20, .duration = 0.05});
        claim.arm();
    }
    static ServoOptions options() { return live_options(); }

    const Report& step() {
        const double t = ++cycle * 1e-3;
        device.tip = {0.01 * std::sin(5 * t), 0.01 * std::sin(3 * t), 0};
        if (cycle % 20 == 0) {
            claim.update(spring,
                         Spring{.anchor = {0.02 * std::sin(t), 0, 0}, .stiffness = 20, .duration = 0.05});
            claim.commit();
        }
        return servo.step();
    }
};

/// The honest claim's spring force, cycle by cycle, with a neighbour that `spoil` spoils (or without one).
template <class Spoil>
std::vector<double> felt(int cycles, bool neighbour, Spoil spoil) {
    Honest honest;
    OfflineClaim* hostile = nullptr;
    if (neighbour) {
        hostile = &honest.servo.claim();
        hostile->arm();
    }
    std::vector<double> forces;
    for (int i = 0; i < cycles; ++i) {
        if (neighbour && i > 2) spoil(*hostile, i);
        const Report& report = honest.step();
        for (const double number : {report.sent_force.x, report.sent_force.y, report.sent_force.z,
                                    report.scene_force.x, report.scene_force.y, report.scene_force.z})
            EXPECT_TRUE(std::isfinite(number)) << "cycle " << i;
        EXPECT_LE(vec(report.sent_force).norm(), honest.device.link().peak_force * (1 + 1e-12));
        EXPECT_EQ(report.faults, 0u) << "cycle " << i;
        for (const auto& entry : honest.claim.feedback().entries)
            forces.insert(forces.end(), {entry.force.x, entry.force.y, entry.force.z});
        forces.push_back(honest.claim.feedback().header.gain);
    }
    return forces;
}

std::vector<double> alone(int cycles) {
    return felt(cycles, false, [](OfflineClaim&, int) {});
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(Hostile, RandomBytesOverTheWholeSegment) {
    const int cycles = 120;
    const std::vector<double> reference = alone(cycles);
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        const auto spoil = [&](OfflineClaim& claim, int) {
            const std::size_t words = claim.layout().total / 8;
            for (std::size_t i = 0; i < words; ++i) {
                std::uint64_t value = random();
                if (value % 4 == 0) value &= 7;  // small numbers pass more checks
                std::memcpy(claim.memory() + 8 * i, &value, 8);
            }
        };
        EXPECT_TRUE(same(felt(cycles, true, spoil), reference));
    }
}

TEST(Hostile, RandomWordsHereAndThere) {
    const int cycles = 1500;
    const std::vector<double> reference = alone(cycles);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        RepresentationId plane;
        const auto spoil = [&](OfflineClaim& claim, int cycle) {
            // It behaves like a good application, far away from the hand, while single words change.
            const Plane far{.normal = {0, 0, 1}, .offset = -10, .stiffness = 100};
            if (cycle == 3) plane = claim.add(far);
            if (cycle % 10 == 0) {
                claim.update(plane, far);
                claim.commit();
            }
            claim.replies();
            if (random() % 8 != 0) return;
            const std::size_t word = random() % (claim.layout().total / 8);
            std::uint64_t value = random() % 3 == 0 ? random() : random() % 16;
            // Only words that a client may spoil without changing its force: its own spring would rightly
            // act.
            if (word * 8 >= claim.layout().batches && word * 8 < claim.layout().replies) value &= 0xff;
            std::memcpy(claim.memory() + 8 * word, &value, 8);
        };
        EXPECT_TRUE(same(felt(cycles, true, spoil), reference));
    }
}

/// Commands and batches of the right form with wrong contents: they pass the form checks and reach every
/// validator.
TEST(Hostile, MessagesThatAreAlmostRight) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        PuppetDevice device;
        ServoOptions options = live_options();
        options.silence = false;
        Offline servo(device, options);
        ClaimTerms terms;
        terms.capacity = {.representations = 8, .batch_bytes = 1024};
        terms.limits = limits_for(device.link(), 1000, {});
        OfflineClaim& claim = servo.claim(terms);
        shm::TripleWriter batches(claim.memory() + claim.layout().batches, claim.layout().batch_slot_bytes);
        claim.arm();
        const auto number = [&]() -> double {
            switch (random() % 8) {
                case 0:
                    return std::numeric_limits<double>::quiet_NaN();
                case 1:
                    return std::numeric_limits<double>::infinity();
                case 2:
                    return -1e308;
                case 3:
                    return 1e-320;
                case 4:
                    return -std::ldexp(1.0, static_cast<int>(random() % 60));
                default:
                    return std::ldexp(1.0, static_cast<int>(random() % 60) - 30);
            }
        };
        for (int i = 0; i < 2000; ++i) {
            double params[64];
            for (double& p : params) p = number();
            const auto kind = static_cast<Kind>(random() % 5);
            const std::size_t bytes = random() % 3 == 0 || kind >= Representations::size
                                          ? random() % (protocol::max_parameter_bytes / 8 + 1) * 8
                                          : kinds()[kind].size;
            const RepresentationId id{static_cast<std::uint32_t>(random() % 10),
                                      static_cast<std::uint32_t>(random() % 3)};
            switch (random() % 6) {
                case 0:
                    claim.add(id, kind, params, bytes,
                              {.probe = static_cast<std::uint32_t>(random() % 20),
                               .on_silence = static_cast<OnSilence>(random() % 5),
                               .silence_time = number(),
                               .feedback = static_cast<std::uint32_t>(random())});
                    break;
                case 1:
                    claim.remove(id);
                    break;
                case 2: {
                    const ProbePlacement placement{.offset = {number(), number(), number()},
                                                   .radius = number()};
                    claim.place_probe(static_cast<std::uint32_t>(random() % 20), placement);
                    break;
                }
                case 3: {
                    protocol::BatchHeader header{.sequence = random(),
                                                 .commands_before = random(),
                                                 .report_cycle = random(),
                                                 .commit_ns = static_cast<std::int64_t>(random()),
                                                 .entries = static_cast<std::uint32_t>(random() % 4),
                                                 .bytes = static_cast<std::uint32_t>(random() % 40 * 8)};
                    protocol::EntryHeader entry{.id = id,
                                                .kind = kind,
                                                .bytes = static_cast<std::uint32_t>(bytes),
                                                .version = random() % 100};
                    if (random() % 2 == 0) {
                        header.entries = 1;
                        header.bytes = static_cast<std::uint32_t>(sizeof entry + (bytes + 7) / 8 * 8);
                    }
                    std::byte all[sizeof header + sizeof entry + sizeof params] = {};
                    std::memcpy(all, &header, sizeof header);
                    std::memcpy(all + sizeof header, &entry, sizeof entry);
                    std::memcpy(all + sizeof header + sizeof entry, params, sizeof params);
                    batches.publish(all, sizeof all);
                    break;
                }
                case 4:
                    claim.reset_fault();
                    break;
                default:
                    claim.arm();
                    break;
            }
            claim.replies();
            device.tip = 0.05 * Eigen::Vector3d(std::sin(i * 0.01), std::cos(i * 0.013), std::sin(i * 0.007));
            const Report& report = servo.step();
            ASSERT_TRUE(vec(report.scene_force).allFinite()) << i;
            ASSERT_TRUE(vec(report.sent_force).allFinite()) << i;
            ASSERT_LE(vec(report.sent_force).norm(), device.link().peak_force * (1 + 1e-12)) << i;
        }
        EXPECT_GT(servo.count(Count::commands_done) + servo.count(Count::commands_refused), 500u);
    }
}

TEST(Hostile, AMalformedCommandEndsTheClaimAndItsForceFades) {
    Honest honest;
    for (int i = 0; i < 700; ++i) honest.step();
    ASSERT_EQ(honest.servo.servo().last().state, DeviceState::active);
    shm::SpscProducer commands(honest.claim.memory() + honest.claim.layout().commands,
                               honest.claim.layout().command_cells);
    std::uint64_t cell[8] = {0x0000000700000063, 99};
    commands.try_push(cell, 1);
    honest.step();
    const std::vector<protocol::Reply> replies = honest.claim.replies();
    EXPECT_EQ(replies.back().reason, static_cast<std::uint32_t>(protocol::RefusalReason::malformed));
    for (int i = 0; i < 50; ++i) honest.step();
    EXPECT_TRUE(honest.device.force().isZero(0));
    EXPECT_EQ(honest.servo.servo().last().faults, 0u) << "the device is not to blame";
    EXPECT_EQ(honest.servo.servo().last().state, DeviceState::idle);
}

TEST(Hostile, AGroupThatNeverEndsIsMalformed) {
    PuppetDevice device;
    Offline servo(device);
    OfflineClaim& claim = servo.claim();
    servo.step();
    shm::SpscProducer commands(claim.memory() + claim.layout().commands, claim.layout().command_cells);
    std::vector<std::uint64_t> cells(std::size_t{claim.layout().command_cells} * 8);
    for (std::size_t i = 0; i < claim.layout().command_cells; ++i) {
        const protocol::CommandHeader header{.cells = 1,
                                             .type = protocol::CommandType::disarm,
                                             .number = i + 1,
                                             .flags = protocol::command_flags::more};
        std::memcpy(&cells[8 * i], &header, sizeof header);
    }
    commands.try_push(cells.data(), claim.layout().command_cells);
    servo.step();
    EXPECT_EQ(servo.count(Count::commands_done), 0u);
    EXPECT_EQ(servo.count(Count::commands_refused), 1u);
}

}  // namespace
}  // namespace knurl::servo
