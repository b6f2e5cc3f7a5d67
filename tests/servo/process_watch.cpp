// Who watches the scenes of a device, over the servo's socket: what they get, and the handling of malformed requests.

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <knurl/servo/scene_log.hpp>

#include "process_knurld.hpp"

namespace knurl::test {
namespace {

using testing::HasSubstr;

Answer watch(RawClient& client, std::uint32_t device = 0) {
    client.send(protocol::WatchRequest{.device = device});
    return client.answer();
}

Answer show(RawClient& client, std::uint32_t device, std::uint32_t row, std::uint32_t number) {
    client.send(protocol::ShowAsset{.device = device, .row = row, .number = number});
    return client.answer();
}

shm::Segment mapped(const Answer& answer) {
    return shm::Segment::open(answer.fds.at(0).get(), servo::scene_log_bytes,
                              shm::Segment::Access::read_only);
}

/// Number of claims that were shown since `from`.
std::size_t claims_shown(const shm::Segment& log, std::uint64_t from) {
    servo::RecordLogReader reader(log.data(), servo::scene_log_slots, from, servo::max_scene_record);
    servo::LogRecord record;
    std::size_t claims = 0;
    while (reader.next(record) == servo::RecordLogReader::Next::record)
        claims += record.type == static_cast<std::uint16_t>(servo::SceneRecord::claim) ? 1 : 0;
    return claims;
}

TEST(Watching, EachWatcherIsShownEverythingFromTheBeginning) {
    const Home home;
    const Knurld knurld(home);
    RawClient holder(home), first(home), second(home);
    ASSERT_TRUE(holder.greet().welcome);
    ASSERT_TRUE(holder.claim({}).claimed);
    for (RawClient* client : {&first, &second}) {
        ASSERT_TRUE(client->greet().welcome);
        const Answer answer = watch(*client);
        ASSERT_TRUE(answer.watching);
        const shm::Segment log = mapped(answer);
        EXPECT_TRUE(eventually([&] { return claims_shown(log, answer.watching->from) == 1; }));
    }
    const Answer again = watch(first);
    ASSERT_TRUE(again.watching) << "who has missed something asks once more";
    const shm::Segment log = mapped(again);
    EXPECT_TRUE(eventually([&] { return claims_shown(log, again.watching->from) == 1; }));
}

TEST(Watching, TheSceneLogCannotBeMappedForWriting) {
    const Home home;
    const Knurld knurld(home);
    RawClient client(home);
    ASSERT_TRUE(client.greet().welcome);
    const Answer answer = watch(client);
    ASSERT_TRUE(answer.watching);
    const int fd = answer.fds.at(0).get();
    EXPECT_EQ(mmap(nullptr, servo::scene_log_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0), MAP_FAILED);
    EXPECT_EQ(pwrite(fd, "x", 1, 0), -1);
    EXPECT_NE(ftruncate(fd, 0), 0);
}

TEST(Watching, WhatMakesNoSenseIsRefusedInOneLineAndTheRestGoesOn) {
    const Home home;
    const Knurld knurld(home, {"--device", "left=sim:premium15", "--device", "sim:cartesian3"});
    RawClient client(home);
    ASSERT_TRUE(client.greet().welcome);
    EXPECT_THAT(watch(client, 99).refused.value().text, HasSubstr("watch: device 99 of 2"));
    EXPECT_THAT(show(client, 0, 0, 1).refused.value().text, HasSubstr("does not watch that device"));
    EXPECT_TRUE(watch(client, 1).watching) << "the connection is as good as before";
    EXPECT_THAT(watch(client, 0).refused.value().text, HasSubstr("one connection watches one device"));
    EXPECT_THAT(show(client, 0, 0, 1).refused.value().text, HasSubstr("does not watch that device"));
    constexpr std::uint32_t far = 0xffffffff;
    for (const auto& [row, number] : {std::pair{0u, 1u}, {far, 1u}, {0u, far}, {0u, 0u}})
        EXPECT_THAT(show(client, 1, row, number).refused.value().text, HasSubstr("has no asset"));
    EXPECT_TRUE(client.claim({.device = 1, .observe = 1}).claimed);

    RawClient unknown(home);
    EXPECT_THAT(watch(unknown).refused.value().text, HasSubstr("say Hello first"));
    RawClient shorter(home);
    ASSERT_TRUE(shorter.greet().welcome);
    const protocol::WatchRequest request;
    shorter.send_bytes(&request, sizeof request - 4);
    EXPECT_THAT(shorter.answer().refused.value().text, HasSubstr("watch: 12 bytes instead of 16"));
    EXPECT_TRUE(shorter.answer().hung_up);
}

TEST(Watching, WhoComesAndGoesLeavesNothing) {
    constexpr unsigned seed = 20261128;
    SCOPED_TRACE(seed);
    const Home home;
    const Knurld knurld(home);
    const auto come = [&](RawClient& client) { return client.greet().welcome && watch(client).watching; };
    {
        RawClient client(home);  // the log is made once, and kept
        ASSERT_TRUE(come(client));
    }
    std::size_t before = 0;
    ASSERT_TRUE(eventually([&] {
        const std::size_t now = descriptors_of(knurld.pid());
        return std::exchange(before, now) == now;
    }));
    std::mt19937 random(seed);
    for (int i = 0; i < 200; ++i) {
        RawClient client(home);
        ASSERT_TRUE(client.greet().welcome);
        for (int j = 0; j < 3; ++j) {
            client.send(protocol::WatchRequest{
                .device = random() % 2 == 0 ? 0 : static_cast<std::uint32_t>(random())});
            if (random() % 3 == 0) break;  // gone before the answer
            const Answer answer = client.answer();
            EXPECT_TRUE(answer.watching || answer.refused);
        }
    }
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }));
    RawClient last(home);
    EXPECT_TRUE(come(last));
}

}  // namespace
}  // namespace knurl::test
