// Places that all clients share: whoever takes as many as he can leaves some to the others.

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fair_share.hpp"

namespace knurl::servo::core_fair_share_tests {
namespace {

constexpr std::size_t places = 128;

struct Crowd {
    std::vector<Peer> holders;

    bool take(const Peer& peer) {
        Share held;
        for (const Peer& holder : holders) held.count(holder, peer);
        if (takes_too_much(held, peer, places - holders.size())) return false;
        holders.push_back(peer);
        return true;
    }
    std::size_t take_all(const Peer& peer) {
        std::size_t taken = 0;
        while (take(peer)) ++taken;
        return taken;
    }
};

const uid_t stranger = ::geteuid() + 1000;

TEST(FairShare, EachGreedyProcessTakesHalfOfWhatIsLeft) {
    Crowd crowd;
    std::vector<std::size_t> taken;
    for (pid_t pid = 1; pid <= 7; ++pid) taken.push_back(crowd.take_all({.pid = pid, .uid = 0, .name = {}}));
    EXPECT_EQ(taken, (std::vector<std::size_t>{64, 32, 16, 8, 4, 2, 1}));
    EXPECT_TRUE(crowd.take({.pid = 8, .uid = 0, .name = {}})) << "the last one";
    EXPECT_FALSE(crowd.take({.pid = 9, .uid = 0, .name = {}}));
}

TEST(FairShare, AUsersProcessesTogetherTakeNoMoreThanOneUnlessItIsTheServos) {
    Crowd crowd;
    std::size_t taken = 0;
    for (pid_t pid = 1; pid <= 500; ++pid) taken += crowd.take_all({.pid = pid, .uid = stranger, .name = {}});
    EXPECT_EQ(taken, places / 2);
    EXPECT_TRUE(crowd.take({.pid = 501, .uid = stranger + 1, .name = {}}));
    for (pid_t pid = 502; pid <= 1000; ++pid) taken += crowd.take_all({.pid = pid, .uid = 0, .name = {}});
    EXPECT_EQ(crowd.holders.size(), places);
}

TEST(FairShare, WhoHoldsNothingFindsAPlaceAsLongAsThereIsOne) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    for (int round = 0; round < 200; ++round) {
        Crowd crowd;
        for (int i = 0; i < 400; ++i) {
            const auto pid = static_cast<pid_t>(1 + random() % 20);
            crowd.take({.pid = pid,
                        .uid = random() % 2 == 0 ? 0 : stranger + static_cast<uid_t>(pid % 5),
                        .name = {}});
            if (random() % 3 == 0 && !crowd.holders.empty())
                crowd.holders.erase(crowd.holders.begin() +
                                    static_cast<std::ptrdiff_t>(random() % crowd.holders.size()));
            if (crowd.holders.size() == places) continue;
            Crowd with_newcomer = crowd;
            ASSERT_TRUE(with_newcomer.take({.pid = 1000, .uid = stranger + 1000, .name = {}})) << i;
        }
    }
}

}  // namespace
}  // namespace knurl::servo::core_fair_share_tests
