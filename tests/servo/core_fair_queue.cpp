// The order of service among several owners with many jobs.

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "fair_queue.hpp"

namespace knurl::servo {
namespace {

using Queue = FairQueue<std::string>;

std::string all_of(Queue& queue) {
    std::string order;
    while (auto job = queue.pop()) order += *job + " ";
    return order;
}

TEST(FairQueue, OwnersTakeTurnsAndEachKeepsItsOrder) {
    Queue queue;
    for (const char* job : {"A1", "A2", "A3", "B1", "C1", "B2"}) queue.push(job[0], job);
    EXPECT_EQ(all_of(queue), "A1 B1 C1 A2 B2 A3 ");
}

TEST(FairQueue, WhatIsCalledOffIsNotServed) {
    Queue queue;
    for (const char* job : {"A1", "A2", "B1"}) queue.push(job[0], job);
    queue.erase_if([](const std::string& job) { return job == "A1"; });
    EXPECT_EQ(all_of(queue), "A2 B1 ");
    EXPECT_TRUE(queue.empty());
}

// Nobody is served twice while another waits, at any time of asking.
TEST(FairQueue, NobodyIsServedTwiceWhileAnotherWaits) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    FairQueue<std::uint64_t> queue;
    constexpr std::uint64_t owners = 5;
    std::uint64_t waiting[owners] = {}, since[owners][owners] = {};  // how often j was served while i waited
    for (int step = 0; step < 20'000; ++step) {
        if (random() % 2 == 0) {
            const std::uint64_t owner = random() % owners;
            if (waiting[owner]++ == 0) std::fill(since[owner], since[owner] + owners, 0);
            queue.push(owner, owner);
        } else if (const auto served = queue.pop()) {
            --waiting[*served];
            std::fill(since[*served], since[*served] + owners, 0);
            for (std::uint64_t i = 0; i < owners; ++i) {
                if (i == *served || waiting[i] == 0) continue;
                ASSERT_LE(++since[i][*served], 1u) << i << " waits, " << *served << " at step " << step;
            }
        }
    }
}

}  // namespace
}  // namespace knurl::servo
