// Claims awake and sleeping, compared with a plain model: one vector of structs, in which a cycle processes
// every claim.

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/servo/offline.hpp>

#include "claim_set.hpp"

namespace knurl::servo {
namespace {

/// A claim that nobody serves.
struct Attached {
    OfflineMemory memory{protocol::claim_layout({}).total};
    Claim claim{ClaimTerms{}, memory.data(), nullptr};
    shm::SentCount sent{claim.impl->wake_target.flag};
    std::uint64_t sent_so_far() const { return shm::sent_so_far<>(claim.impl->wake_target.flag->sent); }
};

struct PlainClaim {
    Claim* claim = nullptr;
    std::uint64_t sent = 0, seen = 0;
    bool sleeping = false, is_awake = false;
    Sleep sleep = {};
    SleepingScene scene = {};
    SleepingClock clock = {};
};

struct PlainSet {
    std::vector<PlainClaim> claims;
    ClaimSet::Sleeping sleeping;
    std::uint64_t passed = 0;

    void look(const Eigen::Vector3d* hand, Nanoseconds now) {
        sleeping = {};
        for (PlainClaim& c : claims) {
            const bool near = c.sleep.present > 0 && (hand == nullptr || !c.scene.holds(*hand));
            if (c.sleeping && !near && c.sent == c.seen && now < c.sleep.until) {
                c.is_awake = false;
                sleeping.armed += c.sleep.armed;
                sleeping.keep_on |= c.sleep.keeps_on;
                sleeping.surfaces |= c.sleep.surfaces;
                sleeping.present += c.sleep.present;
                continue;
            }
            if (c.sleeping && !near) c.seen = c.sent;
            c.is_awake = true;
            c.sleeping = false;
        }
    }
    void pass_time(std::uint64_t cycle, double dt) {
        passed = cycle;
        for (PlainClaim& c : claims) {
            c.clock.time.all += dt;
            c.clock.time.held += dt * c.clock.held_share;
        }
    }
};

void expect_same(ClaimSet& set, const PlainSet& plain, bool looked) {
    ASSERT_EQ(set.size(), plain.claims.size());
    ASSERT_EQ(set.wake_targets().size(), plain.claims.size());
    std::vector<std::size_t> awake;
    for (std::size_t i = 0; i < plain.claims.size(); ++i) {
        const PlainClaim& c = plain.claims[i];
        ASSERT_EQ(&set.claim(i), c.claim);
        ASSERT_EQ(&set[i], c.claim->impl.get());
        ASSERT_EQ(set.wake_targets()[i].flag, c.claim->impl->wake_target.flag);
        ASSERT_EQ(set.sleeps_unarmed(i), c.sleeping && !c.sleep.armed);
        ASSERT_EQ(set.sleeping_scene(i).at, c.scene.at);
        ASSERT_EQ(set.sleeping_scene(i).since, c.scene.since);
        ASSERT_EQ(set.cycles_owed(i), plain.passed - c.scene.since);
        ASSERT_EQ(set.time(i).all, c.clock.time.all);
        ASSERT_EQ(set.time(i).held, c.clock.time.held);
        if (c.is_awake) awake.push_back(i);
    }
    if (!looked) return;
    ASSERT_EQ(std::vector<std::size_t>(set.awake().begin(), set.awake().end()), awake);
    ASSERT_EQ(set.sleeping().armed, plain.sleeping.armed);
    ASSERT_EQ(set.sleeping().keep_on, plain.sleeping.keep_on);
    ASSERT_EQ(set.sleeping().surfaces, plain.sleeping.surfaces);
    ASSERT_EQ(set.sleeping().present, plain.sleeping.present);
}

/// A servo's cycles, with random events of every sort.
TEST(ClaimSet, DoesWhatAPlainOneDoes) {
    std::size_t slept_in_all = 0, woken_by_hand = 0, fullest = 0;
    std::vector<std::unique_ptr<Attached>> outside;
    for (int i = 0; i < 200; ++i) outside.push_back(std::make_unique<Attached>());
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        const auto below = [&](std::uint64_t n) { return random() % n; };
        const auto part = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
        const std::uint64_t arrive_in = seed % 2 == 0 ? 1 : 30;  // a full device, and one with frequent
                                                                 // changes
        ClaimSet set;
        PlainSet plain;
        const auto attached = [&](const Claim* claim) {
            return std::any_of(plain.claims.begin(), plain.claims.end(),
                               [&](const PlainClaim& c) { return c.claim == claim; });
        };
        const auto place = [&] { return static_cast<std::size_t>(below(plain.claims.size())); };
        Eigen::Vector3d hand = Eigen::Vector3d::Zero();
        for (std::uint64_t cycle = 1; cycle <= 3000; ++cycle) {
            SCOPED_TRACE("cycle " + std::to_string(cycle));
            const auto now = static_cast<Nanoseconds>(cycle * 1'000'000);
            hand += 1e-4 * Eigen::Vector3d(part(), part(), part());
            if (below(500) == 0) hand = 0.05 * Eigen::Vector3d(part(), part(), part());
            const Eigen::Vector3d* seen_hand = below(300) == 0 ? nullptr : &hand;

            Attached& other = *outside[below(outside.size())];
            if (below(arrive_in) == 0 && !attached(&other.claim)) {
                const bool room = plain.claims.size() < protocol::max_clients;
                ASSERT_EQ(set.adopt(other.claim), room);
                if (room) plain.claims.push_back({.claim = &other.claim, .sent = other.sent_so_far()});
            }
            const auto found = std::find_if(plain.claims.begin(), plain.claims.end(),
                                            [&](const PlainClaim& c) { return c.claim == &other.claim; });
            ASSERT_EQ(set.find(&other.claim), found - plain.claims.begin());
            fullest = std::max(fullest, plain.claims.size());
            if (plain.claims.empty()) continue;
            if (below(40) == 0) {
                const std::size_t i = place();
                set.wake(i);
                plain.claims[i].sleeping = false;
            }
            for (auto& o : outside)
                if (below(400) == 0) {
                    o->sent.add();
                    for (PlainClaim& c : plain.claims) c.sent += c.claim == &o->claim;
                }

            const std::size_t slept = plain.sleeping.present;
            set.look(seen_hand, now);
            plain.look(seen_hand, now);
            woken_by_hand += plain.sleeping.present < slept;
            expect_same(set, plain, true);

            if (below(100) == 0) {
                std::vector<Claim::Impl*> woken, expected;
                set.wake_all([&](Claim::Impl& c) { woken.push_back(&c); });
                for (PlainClaim& c : plain.claims) {
                    if (c.sleeping) expected.push_back(c.claim->impl.get());
                    c.sleeping = false;
                    c.is_awake = true;
                }
                plain.sleeping = {};
                ASSERT_EQ(woken, expected);
                expect_same(set, plain, true);
            }

            for (const std::size_t i : set.awake()) {
                if (seen_hand == nullptr || below(4) != 0) continue;
                PlainClaim& c = plain.claims[i];
                c.scene = {.at = hand, .within = 2e-3 * (1 + part()) + 1e-4, .since = cycle};
                c.clock = {.time = {.all = part(), .held = part()}, .held_share = below(2) == 0 ? 0.0 : 1.0};
                set.put_scene_to_sleep(i, c.scene, c.clock);
            }
            const double dt = 1e-3 * (1 + 0.1 * part());
            set.pass_time(cycle, dt);
            plain.pass_time(cycle, dt);

            for (const std::size_t i : set.awake()) {
                if (below(2) == 0) continue;
                PlainClaim& c = plain.claims[i];
                const bool asleep = c.scene.since == cycle;
                c.sleep = {.until = below(2) == 0 ? Sleep::for_ever
                                                  : now + static_cast<Nanoseconds>(below(300'000'000)),
                           .present = asleep ? static_cast<std::uint32_t>(below(3)) : 0,
                           .armed = below(3) == 0,
                           .keeps_on = below(20) == 0,
                           .surfaces = below(20) == 0};
                c.sleeping = true;
                set.put_to_sleep(i, c.sleep);
                ++slept_in_all;
            }

            if (below(20) == 0) {
                const std::uint64_t share = below(8) == 0 ? 2 : 40;
                std::vector<Claim*> going, asked;
                for (const PlainClaim& c : plain.claims)
                    if (below(share) == 0) going.push_back(c.claim);
                const auto goes = [&](const Claim* c) {
                    return std::find(going.begin(), going.end(), c) != going.end();
                };
                set.let_go([&](Claim& c) {
                    asked.push_back(&c);
                    return goes(&c);
                });
                ASSERT_EQ(asked.size(), plain.claims.size());
                for (std::size_t i = 0; i < asked.size(); ++i) ASSERT_EQ(asked[i], plain.claims[i].claim);
                std::erase_if(plain.claims, [&](const PlainClaim& c) { return goes(c.claim); });
                expect_same(set, plain, going.empty());
            } else {
                expect_same(set, plain, true);
            }
            ASSERT_FALSE(::testing::Test::HasFatalFailure());
        }
    }
    EXPECT_GT(slept_in_all, 10'000u);
    EXPECT_GT(woken_by_hand, 1000u);
    EXPECT_EQ(fullest, protocol::max_clients);
}

}  // namespace
}  // namespace knurl::servo
