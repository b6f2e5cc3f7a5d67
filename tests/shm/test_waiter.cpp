#include <atomic>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/mman.h>
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
    WakeTarget wake_target() { return {.flag = &flag_, .event_fd = event_.get()}; }
    bool readable() const {
        pollfd event{.fd = event_.get(), .events = POLLIN, .revents = 0};
        return ::poll(&event, 1, 0) == 1;
    }
    bool anyone() {
        const WakeTarget wake_targets[] = {wake_target()};
        return who_waits(wake_targets).count > 0;
    }

    Memory memory_;
    WaiterFlag flag_;
    UniqueFd event_ = make_event();
    BroadcastWriter writer_{memory_.data(), slots, 8};
    BroadcastReader reader_{memory_.data(), slots, 8};
    Waiter waiter_{&flag_, event_.get(), reader_};
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
    waiter_.rearm();
    EXPECT_FALSE(readable());
    EXPECT_TRUE(anyone());
    publish();
    EXPECT_EQ(waker_.run_once(), 1u);
    EXPECT_TRUE(readable());
    ASSERT_TRUE(reader_.next(&report_));
    waiter_.rearm();
    EXPECT_FALSE(readable());
}

TEST_F(Waiting, WhoeverPollsTheDescriptorIsWokenByTheWakersThread) {
    start_waker();
    waiter_.rearm();
    publish();
    pollfd event{.fd = waiter_.fd(), .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&event, 1, 20000), 1);
    EXPECT_TRUE(reader_.next(&report_));
}

TEST_F(Waiting, OneThatSleepsAloneIsWokenWithoutTheWakersThread) {
    const WakeTarget wake_targets[] = {wake_target()};
    EXPECT_EQ(waker_.wake(wake_targets), 0u);
    EXPECT_FALSE(readable());
    waiter_.rearm();
    EXPECT_EQ(waker_.wake(wake_targets), 1u);
    EXPECT_TRUE(readable());
    EXPECT_FALSE(anyone());  // it is woken once
    EXPECT_EQ(waker_.wake(wake_targets), 0u);
}

TEST_F(Waiting, OneWhoseDescriptorIsNotForTheServoIsLeftToTheWakersThread) {
    waker_.add(wake_target());
    waiter_.rearm();
    const WakeTarget wake_targets[] = {{.flag = &flag_}};
    EXPECT_EQ(waker_.wake(wake_targets), 1u);
    EXPECT_FALSE(readable());
    EXPECT_EQ(waker_.run_once(), 1u);
    EXPECT_TRUE(readable());
}

TEST_F(Waiting, OneThatSleepsInACrowdIsLeftToTheWakersThread) {
    waiter_.rearm();
    std::vector<WaiterFlag> awake(8);
    std::vector<WakeTarget> wake_targets{wake_target()};
    for (WaiterFlag& flag : awake) wake_targets.push_back({.flag = &flag, .event_fd = event_.get()});
    EXPECT_EQ(waker_.wake(wake_targets), 1u);
    EXPECT_FALSE(readable());
    wake_targets.pop_back();
    EXPECT_EQ(waker_.wake(wake_targets), 1u);
    EXPECT_TRUE(readable());
}

TEST_F(Waiting, SeveralAreLeftToTheWakersThread) {
    WaiterFlag other;
    const UniqueFd others_event = make_event();
    const WakeTarget wake_targets[] = {wake_target(), {.flag = &other, .event_fd = others_event.get()}};
    for (const WakeTarget& each : wake_targets) {
        waker_.add(each);
        each.flag->waiting = 1;
    }
    EXPECT_EQ(waker_.wake(wake_targets), 2u);
    EXPECT_FALSE(readable());
    EXPECT_EQ(waker_.run_once(), 2u);
    EXPECT_TRUE(readable());
}

TEST_F(Waiting, AReportThatCameBeforeRearmingMakesTheDescriptorReadableAtOnce) {
    publish();  // nobody was waiting: nobody was woken
    waiter_.rearm();
    EXPECT_TRUE(readable());
    ASSERT_TRUE(reader_.next(&report_));
    waiter_.rearm();
    EXPECT_FALSE(readable());
    waiter_.disarm();
    EXPECT_FALSE(anyone());
}

TEST_F(Waiting, ASleeperIsWokenOnceHoweverLongItTakesToWakeUp) {
    waker_.add(wake_target());
    waiter_.rearm();
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
        auto* flag = new (page) WaiterFlag{.waiting = 1};
        UniqueFd event = make_event();
        waker_.add({.flag = flag, .event_fd = event.get()});
        waker_.poke();
        waker_.remove(flag);
        ASSERT_EQ(::munmap(page, 4096), 0);
    }
}

TEST_F(Waiting, TheTableIsBoundedAndSaysSo) {
    std::vector<WaiterFlag> flags(Waker::max_entries + 1);
    for (std::size_t i = 0; i < Waker::max_entries; ++i)
        waker_.add({.flag = &flags[i], .event_fd = event_.get()});
    EXPECT_THROW(waker_.add({.flag = &flags.back(), .event_fd = event_.get()}), std::runtime_error);
    waker_.remove(&flags[17]);
    waker_.remove(&flags[17]);  // unknown by now
    waker_.add({.flag = &flags.back(), .event_fd = event_.get()});
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
    std::vector<UniqueFd> events;
    std::vector<WakeTarget> wake_targets;
    for (WaiterFlag& flag : flags) {
        events.push_back(make_event());
        wake_targets.push_back({.flag = &flag, .event_fd = events.back().get()});
        waker_.add(wake_targets.back());
    }
    thread_ = std::thread([this] { waker_.run(); });
    std::atomic<std::uint64_t> seen = 0;
    std::atomic<bool> lost = false;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < clients; ++i)
        threads.emplace_back([&, i] {
            BroadcastReader reader(memory_.data(), slots, 8, 0);
            Waiter waiter(&flags[i], events[i].get(), reader);
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
    EXPECT_FALSE(lost);
}

}  // namespace
}  // namespace knurl::shm
