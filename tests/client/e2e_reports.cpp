// Reports: polled, waited for, through a descriptor; losses are always counted.

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <vector>

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

/// To the last report of a servo that stands still. Over a network some may still be under way, or lost: then
/// nothing more comes.
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
    // 4095 reports are kept. Lets four times as many pass, since over a network some of those are lost.
    for (int passed = 0; passed < 16'000;) passed += watch.next_report(1s) ? 1 : 0;
    const auto after = sleeper.next_report(10s);
    ASSERT_TRUE(after);
    EXPECT_GT(after->missed, 4096u);
    EXPECT_EQ(after->cycle - before->cycle, 1 + after->missed);
    EXPECT_EQ(sleeper.missed(), after->missed);
}

/// All that are unread, in calls of random size.
std::vector<HandReport> drained(Observer& observer, std::mt19937_64& random) {
    std::vector<HandReport> all;
    for (;;) {
        std::vector<HandReport> some(1 + random() % 300);
        const std::size_t count = observer.drain(some);
        all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
        if (count == 0) return all;
    }
}

TEST(Reports, drained_ones_are_those_that_come_one_by_one) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    ServoProcess servo;
    Client client = connect(), beside = connect_beside();
    Observer watch = beside.observe();
    const ClaimOptions own{.shared = true}, moved{.shared = true, .workspace_centre = {1, 2, 3}},
        scaled{.shared = true, .workspace_radius = 2, .workspace_centre = {0, -1, 0}};
    for (const ClaimOptions& options : {own, moved, scaled}) {
        Claim one = client.claim("", options), many = client.claim("", options);
        ASSERT_TRUE(one.next_report(10s));
        ASSERT_TRUE(many.next_report(10s));
        for (int i = 0; i < 700; ++i) watch.next_report(10s);
        servo.stop();
        std::map<std::uint64_t, HandReport> singly;
        while (const auto report = one.next_report(100ms)) singly[report->cycle] = *report;
        std::vector<HandReport> at_once;
        ASSERT_TRUE(eventually([&] {  // over a network some are still under way
            for (const HandReport& report : drained(many, random)) at_once.push_back(report);
            return at_once.size() >= 300;
        }));
        std::size_t both = 0;
        for (std::size_t i = 0; i < at_once.size(); ++i) {
            const HandReport& report = at_once[i];
            if (i > 0) {
                EXPECT_EQ(report.cycle, at_once[i - 1].cycle + 1 + report.missed - at_once[i - 1].missed);
            }
            const auto same = singly.find(report.cycle);
            if (same == singly.end()) continue;
            ++both;
            ASSERT_EQ(std::memcmp(static_cast<const Report*>(&report),
                                  static_cast<const Report*>(&same->second), sizeof(Report)),
                      0)
                << "cycle " << report.cycle;
        }
        EXPECT_GE(both, 300u);
        EXPECT_EQ(at_once.back().unread, 0u);
        servo.go_on();
    }
}

TEST(Reports, drained_ones_tell_exactly_how_many_were_missed_before_each) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    ServoProcess servo({"--device", "sim:cartesian3", "--rate", "16000"});
    Client client = connect();
    Observer sleeper = client.observe(), watch = client.observe();
    auto last = sleeper.next_report(10s);
    ASSERT_TRUE(last);
    std::uint64_t got = 0;
    const std::uint64_t first = last->cycle;
    // 4095 reports are kept: after each pause the oldest is overwritten while it is read, or was before.
    for (int round = 0; round < 5; ++round) {
        for (auto passed = static_cast<int>(4000 + random() % 400); passed > 0;)
            passed -= watch.next_report(1s) ? 1 : 0;
        for (const HandReport& report : drained(sleeper, random)) {
            ASSERT_EQ(report.cycle, last->cycle + 1 + report.missed - last->missed);
            last = report;
            ++got;
        }
    }
    EXPECT_EQ(last->cycle - first, got + last->missed);
    EXPECT_EQ(sleeper.missed(), last->missed);
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
        // Lets three more come, then stops the servo: now nothing changes by itself.
        const auto cycle = observer.latest()->cycle;
        while (watch.next_report(10s)->cycle < cycle + 3) {
        }
        ASSERT_TRUE(readable(fd, 10'000));  // its waker comes after the report, and stops with it
        servo.stop();
        ASSERT_TRUE(readable(fd));
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

TEST(Reports, newest_is_the_last_one_however_many_came_since) {
    ServoProcess servo;
    Client client = connect(), beside = connect_beside();
    Observer observer = client.observe(), watch = beside.observe();
    const auto first = observer.newest(10s);
    ASSERT_TRUE(first);
    for (int i = 0; i < 200; ++i) watch.next_report(1s);
    servo.stop();
    const std::uint64_t last_cycle = watch.latest()->cycle;
    std::optional<HandFrame> newest;
    std::uint64_t passed = 0;
    ASSERT_TRUE(eventually([&] {
        if (const auto frame = observer.newest(10ms)) {
            newest = frame;
            passed += 1 + frame->skipped;
        }
        return newest && newest->cycle == last_cycle;
    }));
    EXPECT_EQ(newest->cycle - first->cycle, passed);
    EXPECT_EQ(newest->unread, 0u);
    EXPECT_FALSE(observer.newest(0ns)) << "it was read";
    servo.go_on();
    EXPECT_GT(observer.newest(10s)->cycle, last_cycle);
}

TEST(Reports, newest_tells_of_a_contact_that_has_ended_meanwhile) {
    ServoProcess servo;
    Client client = connect(), beside = connect_beside();
    Claim hand = client.claim();
    Observer watch = beside.observe();
    ASSERT_TRUE(hand.newest(10s));
    const auto touching = [&](bool wanted) {
        return eventually([&] {
            const auto report = watch.next_report(1s);
            return report && ((report->flags & report_flags::touching) != 0) == wanted;
        });
    };
    auto floor = hand.add(Plane{.normal = {0, 0, 1}, .offset = 0.002, .stiffness = 300});
    ASSERT_TRUE(touching(true));
    floor.remove();
    ASSERT_TRUE(touching(false));
    bool touched = false;
    std::uint32_t touches = 0;
    ASSERT_TRUE(eventually([&] {
        const auto frame = hand.newest(1s);
        if (!frame) return false;
        touched = touched || frame->touched;
        touches += frame->touches;
        return touched && (frame->flags & report_flags::touching) == 0;
    }));
    EXPECT_EQ(touches, 1u);
    EXPECT_FALSE(hand.newest(10s)->touched) << "told once";
}

/// Redirects this process's standard error into a file.
class Errors {
  public:
    Errors()
        : path_(std::filesystem::temp_directory_path() / ("knurl-errors-" + std::to_string(::getpid()))) {
        const int file = ::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
        ::dup2(file, 2);
        ::close(file);
    }
    ~Errors() {
        ::dup2(kept_, 2);
        ::close(kept_);
        std::filesystem::remove(path_);
    }
    std::string said() const {
        std::ostringstream all;
        all << std::ifstream(path_).rdbuf();
        return all.str();
    }
    bool say(const std::string& what) const { return said().find(what) != std::string::npos; }

  private:
    std::filesystem::path path_;
    const int kept_ = ::dup(2);
};

TEST(Hints, a_reader_that_falls_behind_is_told_once) {
    if (ServoProcess::through_bridge()) return;  // the library's, whatever carries the reports
    ServoProcess servo;
    Client client = connect(), silent = Client::connect("knurl:default", {.wait = 20s, .hints = false});
    Observer slow = client.observe(), unhinted = silent.observe(), watch = silent.observe();
    const Errors errors;
    std::uint64_t unread = 0;
    const auto falls_behind = [&](int reads) {
        for (int i = 0; i < reads; ++i) {
            for (int passed = 0; passed < 30; ++passed) watch.next_report(1s);
            unhinted.next_report(1s);
            if (const auto report = slow.next_report(1s)) unread = report->unread;
        }
    };
    ASSERT_TRUE(eventually([&] {
        falls_behind(1);
        return errors.say("newest() gives the newest");
    }));
    EXPECT_GT(unread, 200u);
    const std::string said = errors.said();
    falls_behind(20);
    EXPECT_EQ(errors.said(), said) << "once, and not at all where hints are off";
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST(Hints, a_program_that_forgets_arm_or_commit_is_told_once) {
    if (ServoProcess::through_bridge()) return;
    ServoProcess servo({"--device", "left=sim:cartesian3", "--device", "right=sim:cartesian3"});
    Client client = connect();
    Claim unarmed = client.claim("left"), uncommitted = client.claim("right", {.update_interval = 1ms});
    const Errors errors;
    unarmed.add(Plane{.offset = -0.08});
    uncommitted.add(Plane{.offset = -0.08});
    uncommitted.arm();
    ASSERT_TRUE(eventually([&] {
        unarmed.newest(1s);
        unarmed.commit();
        uncommitted.newest(1s);
        return errors.say("device 'left'") && errors.say("device 'right'");
    }));
    EXPECT_TRUE(errors.say("device 'left': nothing of what was added is felt: arm() was not called"));
    EXPECT_TRUE(errors.say("device 'right': commit() was never called"));
    const std::string said = errors.said();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
}

}  // namespace
