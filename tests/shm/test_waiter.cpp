#include <array>
#include <atomic>
#include <cerrno>
#include <random>
#include <span>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/shm/waiter.hpp>

#include "support.hpp"

namespace knurl::shm {
namespace {

using namespace std::chrono_literals;
using test::Memory;

constexpr auto never = std::chrono::nanoseconds::max();
constexpr auto hang = 20s;  // a wake-up that takes this long was lost

class Waiting : public testing::Test {
  protected:
    static constexpr std::uint32_t slots = 16;

    Waiting() : memory_(broadcast_bytes(slots, 8)) { broadcast_init(memory_.data()); }
    ~Waiting() override {
        if (!thread_.joinable()) return;
        waker_.stop();
        thread_.join();
    }

    void start_waker() {
        waker_.add(wake_target());
        thread_ = std::thread([this] { waker_.run(); });
    }
    /// What the servo does at the end of its cycle.
    void publish() {
        const std::uint64_t report = writer_.published();
        writer_.publish(&report);
        const WakeTarget wake_targets[] = {wake_target()};
        if (who_waits(wake_targets).count > 0) waker_.poke();
    }
    WakeTarget wake_target() { return {.flag = &flag_, .wake_fd = wake_.servo.get(), .trusted = true}; }
    bool readable() const {
        pollfd event{.fd = wake_.client.get(), .events = POLLIN, .revents = 0};
        return ::poll(&event, 1, 0) == 1;
    }
    bool anyone() {
        const WakeTarget wake_targets[] = {wake_target()};
        return who_waits(wake_targets).count > 0;
    }

    Memory memory_;
    WaiterFlag flag_;
    WakePair wake_ = make_wake_pair();
    BroadcastWriter writer_{memory_.data(), slots, 8};
    BroadcastReader reader_{memory_.data(), slots, 8};
    Waiter waiter_{&flag_, wake_.client.get(), reader_};
    Waker waker_;
    std::thread thread_;
    std::uint64_t report_ = 0;
};

TEST_F(Waiting, DoesNotSleepWhenThereIsSomethingNew) {
    publish();
    EXPECT_TRUE(waiter_.wait(never));
    EXPECT_FALSE(anyone());
}

TEST_F(Waiting, EndsWithItsTimeOutAndLowersItsFlag) {
    EXPECT_FALSE(waiter_.wait(0ns));
    EXPECT_FALSE(waiter_.wait(1ms));
    EXPECT_FALSE(anyone());
}

TEST_F(Waiting, NoReportIsSleptThrough) {
    start_waker();
    std::mt19937_64 random(test::seed());
    SCOPED_TRACE("KNURL_SEED=" + std::to_string(test::seed()));
    constexpr std::uint64_t reports = 3000;
    std::atomic<std::uint64_t> seen = 0;
    std::atomic<bool> lost = false;
    std::thread client([&] {
        for (std::uint64_t n = 0; n < reports && !lost; ++n) {
            if (!waiter_.wait(hang) || !reader_.next(&report_) || report_ != n) lost = true;
            seen.store(n + 1);
        }
    });
    // Each report is published while the client is going to sleep, at another moment each time.
    for (std::uint64_t n = 0; n < reports && !lost; ++n) {
        while (seen.load() != n && !lost) std::this_thread::yield();
        for (std::uint64_t spin = random() % 2000; spin > 0; --spin)
            std::atomic_signal_fence(std::memory_order::seq_cst);
        publish();
    }
    client.join();
    EXPECT_FALSE(lost);
    EXPECT_EQ(seen.load(), reports);
}

TEST_F(Waiting, TheDescriptorIsReadableWhenAReportHasCome) {
    // The waker's sweeps are made here, one for each poke: a thread's first sweep could come at any moment,
    // and find this waiter before there is a report.
    waker_.add(wake_target());
    EXPECT_TRUE(waiter_.rearm());
    EXPECT_FALSE(readable());
    EXPECT_TRUE(anyone());
    publish();
    EXPECT_EQ(waker_.run_once(), 1u);
    EXPECT_TRUE(readable());
    ASSERT_TRUE(reader_.next(&report_));
    EXPECT_TRUE(waiter_.rearm());
    EXPECT_FALSE(readable());
}

TEST_F(Waiting, WhoeverPollsTheDescriptorIsWokenByTheWakersThread) {
    start_waker();
    ASSERT_TRUE(waiter_.rearm());
    publish();
    pollfd event{.fd = waiter_.fd(), .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&event, 1, 20000), 1);
    EXPECT_TRUE(reader_.next(&report_));
}

TEST_F(Waiting, OneThatSleepsAloneIsWokenWithoutTheWakersThread) {
    const WakeTarget wake_targets[] = {wake_target()};
    EXPECT_EQ(waker_.wake(wake_targets), 0u);
    std::atomic<bool> has_it = false;
    std::thread client([&] { has_it = waiter_.wait(never); });
    while (!anyone()) std::this_thread::yield();
    const std::uint64_t report = 0;
    writer_.publish(&report);
    EXPECT_EQ(waker_.wake(wake_targets), 1u);
    client.join();  // no thread of the waker runs
    EXPECT_TRUE(has_it);
    EXPECT_FALSE(anyone());  // it is woken once
    EXPECT_EQ(waker_.wake(wake_targets), 0u);
}

/// Whether the servo wakes those of these who wait by itself: then their flags are down afterwards.
bool wakes_itself(Waker& waker, std::span<const WakeTarget> wake_targets, WaiterFlag& flag) {
    const std::uint64_t waited = flag.waiting;
    EXPECT_EQ(waker.wake(wake_targets), 1u);
    const bool itself = flag.waiting == 0;
    flag.waiting = waited;
    return itself;
}

TEST_F(Waiting, TheServosThreadWakesNobodyWhoIsNotTrustedOrWaitsOnASocket) {
    flag_.waiting = static_cast<std::uint64_t>(Waits::on_flag);
    EXPECT_TRUE(wakes_itself(waker_, std::array{wake_target()}, flag_));
    EXPECT_FALSE(
        wakes_itself(waker_, std::array{WakeTarget{.flag = &flag_, .wake_fd = wake_.servo.get()}}, flag_));
    flag_.waiting = static_cast<std::uint64_t>(Waits::on_socket);
    EXPECT_FALSE(wakes_itself(waker_, std::array{wake_target()}, flag_));
    EXPECT_FALSE(readable());
    waker_.add(wake_target());
    EXPECT_EQ(waker_.run_once(), 1u);
    EXPECT_TRUE(readable());
}

TEST_F(Waiting, OneThatSleepsInACrowdIsLeftToTheWakersThread) {
    flag_.waiting = static_cast<std::uint64_t>(Waits::on_flag);
    std::vector<WaiterFlag> awake(8);
    std::vector<WakeTarget> wake_targets{wake_target()};
    for (WaiterFlag& flag : awake) wake_targets.push_back({.flag = &flag, .trusted = true});
    EXPECT_FALSE(wakes_itself(waker_, wake_targets, flag_));
    wake_targets.pop_back();
    EXPECT_TRUE(wakes_itself(waker_, wake_targets, flag_));
}

TEST_F(Waiting, ThoseWhoAreNotTrustedAreLeftToAnotherThread) {
    Waker far;
    waker_.leave_untrusted_to(far);
    WaiterFlag other;
    const WakeTarget wake_targets[] = {wake_target(), {.flag = &other}};
    for (const WakeTarget& each : wake_targets) waker_.add(each);
    flag_.waiting = other.waiting = static_cast<std::uint64_t>(Waits::on_flag);
    EXPECT_EQ(waker_.wake(wake_targets), 2u);
    EXPECT_EQ(flag_.waiting, 0u) << "the one who is trusted sleeps alone";
    EXPECT_NE(other.waiting, 0u);
    EXPECT_EQ(waker_.run_once(), 0u);
    EXPECT_EQ(far.run_once(), 1u);
    other.waiting = static_cast<std::uint64_t>(Waits::on_flag);
    waker_.remove(&other);
    EXPECT_EQ(far.run_once(), 0u);
    EXPECT_NE(other.waiting, 0u);
}

// A poke that the thread misses would leave it asleep for good.
TEST_F(Waiting, TheOtherThreadIsPokedForThoseWhoAreNotTrusted) {
    Waker far;
    waker_.leave_untrusted_to(far);
    const WakeTarget untrusted[] = {{.flag = &flag_, .wake_fd = wake_.servo.get()}};
    waker_.add(untrusted[0]);
    std::thread far_thread([&] { far.run(); });
    std::atomic<bool> has_it = false;
    std::thread client([&] { has_it = waiter_.wait(never); });
    while (!anyone()) std::this_thread::yield();
    const std::uint64_t report = 0;
    writer_.publish(&report);
    waker_.wake(untrusted);
    client.join();
    EXPECT_TRUE(has_it);
    far.stop();
    far_thread.join();
}

TEST_F(Waiting, SeveralAreLeftToTheWakersThread) {
    WaiterFlag other;
    const WakePair others = make_wake_pair();
    const WakeTarget wake_targets[] = {wake_target(),
                                       {.flag = &other, .wake_fd = others.servo.get(), .trusted = true}};
    for (const WakeTarget& each : wake_targets) {
        waker_.add(each);
        each.flag->waiting = static_cast<std::uint64_t>(Waits::on_socket);
    }
    EXPECT_EQ(waker_.wake(wake_targets), 2u);
    EXPECT_FALSE(readable());
    EXPECT_EQ(waker_.run_once(), 2u);
    EXPECT_TRUE(readable());
}

TEST_F(Waiting, RearmingSaysThatAReportCameBefore) {
    publish();  // nobody was waiting: nobody was woken
    EXPECT_FALSE(waiter_.rearm());
    ASSERT_TRUE(reader_.next(&report_));
    EXPECT_TRUE(waiter_.rearm());
    EXPECT_FALSE(readable());
    waiter_.disarm();
    EXPECT_FALSE(anyone());
}

// What a client can do with its own end, in its own process. None of the wake-ups below may hang; each that
// does hangs this test.
TEST_F(Waiting, NoWakeUpBlocksWhateverAClientDoesToItsSocket) {
    const auto wake = [&] {
        flag_.waiting = static_cast<std::uint64_t>(Waits::on_socket);
        EXPECT_EQ(waker_.run_once(), 1u);
    };
    waker_.add(wake_target());
    // It takes away the flag that keeps writing from blocking, and reads nothing: the buffer fills.
    ASSERT_EQ(::fcntl(wake_.client.get(), F_SETFL, 0), 0);
    const int largest = 1 << 30;
    for (const int option : {SO_SNDBUF, SO_RCVBUF})
        ::setsockopt(wake_.client.get(), SOL_SOCKET, option, &largest, sizeof largest);
    for (int i = 0; i < 10000; ++i) wake();
    const std::byte one{};
    EXPECT_EQ(::send(wake_.servo.get(), &one, 1, MSG_DONTWAIT | MSG_NOSIGNAL), -1);
    EXPECT_EQ(errno, EAGAIN) << "else the buffer was not full, and this proves nothing";
    int unread = 0;
    ASSERT_EQ(::ioctl(wake_.client.get(), FIONREAD, &unread), 0);
    EXPECT_LT(unread, 64) << "what a client leaves unread takes the servo's memory";
    EXPECT_TRUE(readable());
    ASSERT_FALSE(reader_.fresh());
    EXPECT_TRUE(waiter_.rearm());
    EXPECT_FALSE(readable());

    // It sends something back.
    EXPECT_EQ(::send(wake_.client.get(), &one, 1, MSG_DONTWAIT | MSG_NOSIGNAL), -1);
    EXPECT_EQ(errno, EPIPE);
    wake();
    EXPECT_TRUE(readable());
    // It hangs up, half and wholly: no SIGPIPE either.
    ::shutdown(wake_.client.get(), SHUT_RD);
    wake();
    ::shutdown(wake_.client.get(), SHUT_RDWR);
    wake();
    wake_.client.reset();
    wake();
}

TEST_F(Waiting, ASleeperIsWokenOnceHoweverLongItTakesToWakeUp) {
    waker_.add(wake_target());
    ASSERT_TRUE(waiter_.rearm());
    publish();
    EXPECT_EQ(waker_.run_once(), 1u);
    publish();
    EXPECT_EQ(waker_.run_once(), 0u);
    EXPECT_TRUE(readable());
}

TEST_F(Waiting, WhoeverIsRemovedIsNotTouchedAnyMore) {
    start_waker();
    for (int i = 0; i < 300; ++i) {
        // Memory that is gone afterwards: touching it would crash.
        void* page = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        ASSERT_NE(page, MAP_FAILED);
        auto* flag = new (page) WaiterFlag{.waiting = 1 + static_cast<std::uint64_t>(i % 2)};
        WakePair wake = make_wake_pair();
        waker_.add({.flag = flag, .wake_fd = wake.servo.get()});
        waker_.poke();
        if (i % 4 < 2) {
            waker_.remove(flag);
        } else {
            while (!waker_.try_remove(flag)) std::this_thread::yield();
        }
        ASSERT_EQ(::munmap(page, 4096), 0);
    }
}

TEST_F(Waiting, TheTableIsBoundedAndSaysSo) {
    std::vector<WaiterFlag> flags(Waker::max_entries + 1);
    for (std::size_t i = 0; i < Waker::max_entries; ++i)
        waker_.add({.flag = &flags[i], .wake_fd = wake_.servo.get()});
    EXPECT_THROW(waker_.add({.flag = &flags.back(), .wake_fd = wake_.servo.get()}), std::runtime_error);
    waker_.remove(&flags[17]);
    waker_.remove(&flags[17]);  // unknown by now
    EXPECT_TRUE(waker_.try_remove(&flags[17]));
    waker_.add({.flag = &flags.back(), .wake_fd = wake_.servo.get()});
    flags[17].waiting = 1;
    flags[18].waiting = 1;
    flags.back().waiting = 1;
    EXPECT_EQ(waker_.run_once(), 2u);
}

TEST_F(Waiting, StoppingBeforeRunningIsNotForgotten) {
    waker_.stop();
    waker_.run();  // returns
    thread_ = std::thread([this] { waker_.run(); });
    waker_.stop();
    thread_.join();
}

TEST_F(Waiting, EveryWaiterOfManyIsWoken) {
    constexpr int clients = 8;
    constexpr std::uint64_t reports = 200;
    std::vector<WaiterFlag> flags(clients);
    std::vector<WakePair> pairs;
    std::vector<WakeTarget> wake_targets;
    for (WaiterFlag& flag : flags) {
        pairs.push_back(make_wake_pair());
        wake_targets.push_back({.flag = &flag, .wake_fd = pairs.back().servo.get(), .trusted = true});
        waker_.add(wake_targets.back());
    }
    thread_ = std::thread([this] { waker_.run(); });
    std::atomic<std::uint64_t> seen = 0;
    std::atomic<bool> lost = false;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < clients; ++i)
        threads.emplace_back([&, i] {
            BroadcastReader reader(memory_.data(), slots, 8, 0);
            Waiter waiter(&flags[i], pairs[i].client.get(), reader);
            std::uint64_t report = 0;
            for (std::uint64_t n = 0; n < reports && !lost; ++n) {
                if (!waiter.wait(hang) || !reader.next(&report) || report != n) lost = true;
                ++seen;
            }
        });
    for (std::uint64_t n = 0; n < reports && !lost; ++n) {
        writer_.publish(&n);
        waker_.wake(wake_targets);
        while (seen.load() < (n + 1) * clients && !lost) std::this_thread::yield();
    }
    for (std::thread& thread : threads) thread.join();
    for (const WaiterFlag& flag : flags) waker_.remove(&flag);  // its thread looks at them until then
    EXPECT_FALSE(lost);
}

}  // namespace
}  // namespace knurl::shm
