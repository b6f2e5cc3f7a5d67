// Reports: polled, waited for, through a descriptor; none lost without being counted.

#include <map>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/epoll.h>

#include "servo_process.hpp"

namespace {

using namespace knurl;
using namespace client_test;

bool readable(int fd, int timeout_ms = 0) {
    pollfd one{.fd = fd, .events = POLLIN, .revents = 0};
    return ::poll(&one, 1, timeout_ms) == 1;
}

/// To the end of what a servo that stands still has said. Some of it may be on its way over a network yet, or
/// lost there: then nothing more comes.
void read_to(Observer& observer, std::uint64_t last_cycle) {
    for (auto report = observer.latest(); report && report->cycle < last_cycle;)
        report = observer.next_report(1s);
}

TEST(Reports, come_one_by_one_in_order) {
    ServoProcess servo;
    Client client = connect();
    Observer observer = client.observe();
    auto last = observer.next_report(10s);
    ASSERT_TRUE(last);
    for (int i = 0; i < 200; ++i) {
        const auto report = observer.next_report(10s);
        ASSERT_TRUE(report);
        ASSERT_EQ(report->cycle, last->cycle + 1 + (report->missed - last->missed));
        last = report;
    }
}

TEST(Reports, a_reader_that_slept_is_told_exactly_how_many_it_missed) {
    ServoProcess servo({"--device", "sim:cartesian3", "--rate", "16000"});
    Client client = connect();
    Observer sleeper = client.observe(), watch = client.observe();
    const auto before = sleeper.next_report(10s);
    ASSERT_TRUE(before);
    // 4095 reports are kept: let four times as many pass, for over a network some of those are lost.
    for (int passed = 0; passed < 16'000;) passed += watch.next_report(1s) ? 1 : 0;
    const auto after = sleeper.next_report(10s);
    ASSERT_TRUE(after);
    EXPECT_GT(after->missed, 4096u);
    EXPECT_EQ(after->cycle - before->cycle, 1 + after->missed);
    EXPECT_EQ(sleeper.missed(), after->missed);
}

TEST(Reports, latest_skips_what_nobody_asked_for_and_repeats_what_it_has) {
    ServoProcess servo;
    Client client = connect(), beside = connect_beside();
    Observer observer = client.observe(), watch = beside.observe();
    ASSERT_TRUE(observer.next_report(10s));
    for (int i = 0; i < 20; ++i) watch.next_report(1s);
    servo.stop();
    const std::uint64_t last_cycle = watch.latest()->cycle;
    ASSERT_TRUE(eventually([&] { return observer.latest()->cycle == last_cycle; }));
    const auto newest = observer.latest();
    EXPECT_EQ(newest->missed, 0u) << "passing over is not missing";
    EXPECT_EQ(observer.latest()->cycle, newest->cycle);
    EXPECT_FALSE(observer.next_report(0ns)) << "it was read";
    servo.go_on();
    EXPECT_EQ(observer.next_report(10s)->cycle, newest->cycle + 1);
}

TEST(Reports, waiting_ends_with_nothing_when_none_comes_in_time) {
    ServoProcess servo;
    Client client = connect(), beside = connect_beside();
    Observer observer = client.observe(), watch = beside.observe();
    ASSERT_TRUE(observer.next_report(10s));
    servo.stop();
    read_to(observer, watch.latest()->cycle);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_FALSE(observer.next_report(30ms));
    EXPECT_GE(std::chrono::steady_clock::now() - start, 30ms);
    EXPECT_TRUE(observer.connected()) << "a servo that stands still has not gone";
    servo.go_on();
    EXPECT_TRUE(observer.next_report(10s));
}

TEST(Reports, the_descriptor_is_readable_exactly_while_a_report_is_unread) {
    ServoProcess servo({"--device", "sim:cartesian3", "--rate", "500"});
    Client client = connect(), beside = connect_beside();
    Observer observer = client.observe(), watch = beside.observe();
    const int fd = observer.fd();
    ASSERT_TRUE(readable(fd, 10'000)) << "from the start, without a read before";
    for (int round = 0; round < 5; ++round) {
        ASSERT_TRUE(observer.next_report(10s));
        // Let three more come, then hold the servo: now nothing changes by itself.
        const auto cycle = observer.latest()->cycle;
        while (watch.next_report(10s)->cycle < cycle + 3) {
        }
        servo.stop();
        ASSERT_TRUE(readable(fd, 10'000));
        ASSERT_TRUE(observer.next_report(0ns));
        ASSERT_TRUE(readable(fd, 10'000)) << "one read, others are left";
        read_to(observer, watch.latest()->cycle);
        ASSERT_FALSE(readable(fd)) << "all read, round " << round;
        servo.go_on();
        ASSERT_TRUE(readable(fd, 10'000)) << "a new one came";
        ASSERT_TRUE(observer.next_report(0ns)) << "and it was no false alarm";
    }
}

TEST(Reports, an_epoll_loop_sees_every_report_of_two_readers) {
    ServoProcess servo;
    Client client = connect();
    Observer one = client.observe(), two = client.observe();
    std::map<int, Observer*> readers{{one.fd(), &one}, {two.fd(), &two}};
    const int loop = ::epoll_create1(EPOLL_CLOEXEC);
    for (const auto& [fd, reader] : readers) {
        epoll_event event{.events = EPOLLIN, .data = {.fd = fd}};
        ASSERT_EQ(::epoll_ctl(loop, EPOLL_CTL_ADD, fd, &event), 0);
    }
    std::map<int, std::uint64_t> count, last;
    while (count[one.fd()] < 200 || count[two.fd()] < 200) {
        epoll_event event;
        ASSERT_EQ(::epoll_wait(loop, &event, 1, 10'000), 1);
        while (const auto report = readers[event.data.fd]->next_report(0ns)) {
            if (count[event.data.fd]++ > 0) {
                ASSERT_EQ(report->cycle, last[event.data.fd] + 1);
            }
            last[event.data.fd] = report->cycle;
        }
    }
    ::close(loop);
}

}  // namespace
