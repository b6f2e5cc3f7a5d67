// Recorders over the servo's socket: what they get, and the handling of malformed requests.

#include <memory>
#include <random>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <knurl/servo/input_log.hpp>

#include "process_knurld.hpp"

namespace knurl::test {
namespace {

using testing::HasSubstr;

std::uint64_t written(const shm::Segment& input_log) {
    return servo::InputLog::written(input_log.data());
}

Answer record(RawClient& client, std::uint32_t device = 0) {
    client.send(protocol::RecordRequest{.device = device});
    return client.answer();
}

TEST(Recording, TheInputLogIsWrittenWhileSomebodyListensAndNoLonger) {
    const Home home;
    const Knurld knurld(home);
    auto first = std::make_unique<RawClient>(home), second = std::make_unique<RawClient>(home);
    ASSERT_TRUE(first->greet().welcome);
    ASSERT_TRUE(second->greet().welcome);
    const Answer answer = record(*first);
    ASSERT_TRUE(answer.recording);
    ASSERT_EQ(answer.fds.size(), 1u);
    const shm::Segment input_log =
        shm::Segment::open(answer.fds[0].get(), servo::input_log_bytes, shm::Segment::Access::read_only);
    ASSERT_TRUE(eventually([&] { return written(input_log) > answer.recording->from + 10; }));

    ASSERT_TRUE(record(*second).recording);
    first.reset();
    const std::uint64_t with_one = written(input_log);
    EXPECT_TRUE(eventually([&] { return written(input_log) > with_one + 10; })) << "the second still listens";

    RawClient looks_on(home);
    const Answer welcome = looks_on.greet();
    const DeviceView view(welcome.fds.at(0).get());
    second.reset();
    // Without recorders the input log does not grow, however many cycles there are.
    EXPECT_TRUE(eventually([&] {
        const std::uint64_t input_log_was = written(input_log), cycles = view.count(protocol::Count::cycles);
        if (!eventually([&] { return view.count(protocol::Count::cycles) > cycles + 20; })) return true;
        return written(input_log) == input_log_was;
    }));
}

TEST(Recording, TheInputLogCannotBeMappedForWriting) {
    const Home home;
    const Knurld knurld(home);
    RawClient client(home);
    ASSERT_TRUE(client.greet().welcome);
    const Answer answer = record(client);
    ASSERT_TRUE(answer.recording);
    const int fd = answer.fds.at(0).get();
    EXPECT_EQ(mmap(nullptr, servo::input_log_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0), MAP_FAILED);
    EXPECT_EQ(pwrite(fd, "x", 1, 0), -1);
    EXPECT_NE(ftruncate(fd, 0), 0);
}

TEST(Recording, WhatMakesNoSenseIsRefusedInOneLineAndTheRestGoesOn) {
    const Home home;
    const Knurld knurld(home, {"--device", "left=sim:premium15", "--device", "sim:cartesian3"});
    RawClient client(home);
    ASSERT_TRUE(client.greet().welcome);
    const Answer missing = record(client, 99);
    ASSERT_TRUE(missing.refused);
    EXPECT_THAT(missing.refused->text, HasSubstr("record: device 99 of 2"));
    EXPECT_TRUE(record(client, 1).recording) << "the connection is as good as before";
    const Answer second = record(client, 0);
    ASSERT_TRUE(second.refused);
    EXPECT_THAT(second.refused->text, HasSubstr("one connection records one device"));
    EXPECT_TRUE(client.claim({.observe = 1}).claimed);

    RawClient unknown(home);
    EXPECT_THAT(record(unknown).refused.value().text, HasSubstr("say Hello first"));
    RawClient shorter(home);
    ASSERT_TRUE(shorter.greet().welcome);
    const protocol::RecordRequest request;
    shorter.send_bytes(&request, sizeof request - 4);
    EXPECT_THAT(shorter.answer().refused.value().text, HasSubstr("record: 12 bytes instead of 16"));
    EXPECT_TRUE(shorter.answer().hung_up);
}

TEST(Recording, WhoComesAndGoesLeavesNothing) {
    constexpr unsigned seed = 20261123;
    SCOPED_TRACE(seed);
    const Home home;
    const Knurld knurld(home);
    {
        RawClient client(home);  // the input log is made once, and kept
        ASSERT_TRUE(client.greet().welcome);
        ASSERT_TRUE(record(client).recording);
    }
    std::size_t before = 0;
    ASSERT_TRUE(eventually([&] {
        const std::size_t now = descriptors_of(knurld.pid());
        return std::exchange(before, now) == now;
    }));
    std::mt19937 random(seed);
    for (int i = 0; i < 500; ++i) {
        RawClient client(home);
        ASSERT_TRUE(client.greet().welcome);
        for (int j = 0; j < 3; ++j) {
            const std::uint32_t device = random() % 2 == 0 ? 0 : static_cast<std::uint32_t>(random());
            protocol::RecordRequest request{.device = device,
                                            .reserved = static_cast<std::uint32_t>(random())};
            client.send(request);
            if (random() % 3 == 0) break;  // gone before the answer
            const Answer answer = client.answer();
            EXPECT_TRUE(answer.recording || answer.refused);
            EXPECT_FALSE(answer.recording && device != 0);
        }
    }
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }))
        << descriptors_of(knurld.pid()) << " descriptors, " << before << " before";
    RawClient last(home);
    ASSERT_TRUE(last.greet().welcome);
    const Answer answer = record(last);
    ASSERT_TRUE(answer.recording);
    const shm::Segment input_log =
        shm::Segment::open(answer.fds.at(0).get(), servo::input_log_bytes, shm::Segment::Access::read_only);
    EXPECT_TRUE(eventually([&] { return written(input_log) > answer.recording->from + 10; }));
}

}  // namespace
}  // namespace knurl::test
