// Across fork and exec, attached like a real client: segments and the event descriptor come over the socket.

#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "../temp_folder.hpp"
#include "peer.hpp"

namespace knurl::shm {
namespace {

using namespace test;
namespace fs = std::filesystem;

class Processes : public testing::Test {
  protected:
    Processes() {
        broadcast_init(reports_.data());
        spsc_init(claim_.data() + commands_at);
        spsc_init(claim_.data() + replies_at);
        triple_init(claim_.data() + batches_at);
        reports_.seal_against_new_writers();
        waker_.add({.flag = flag_, .wake_fd = wake_.servo.get()});
        thread_ = std::thread([this] { waker_.run(); });
    }
    ~Processes() override {
        waker_.stop();
        thread_.join();
        if (peer_ > 0) {
            ::kill(peer_, SIGKILL);
            ::waitpid(peer_, nullptr, 0);
        }
    }

    void start(const char* role, std::uint64_t count) {
        const fs::path path = folder_ / "default.sock";
        const std::string number = std::to_string(count);
        const UniqueFd listener = listen_at(path, 0600, 1);
        peer_ = ::fork();
        if (peer_ == 0) {
            ::execl(KNURL_SHM_PEER, KNURL_SHM_PEER, path.c_str(), role, number.c_str(), nullptr);
            ::_exit(127);
        }
        pollfd event{.fd = listener.get(), .events = POLLIN, .revents = 0};
        ASSERT_EQ(::poll(&event, 1, 20000), 1) << "the peer did not connect";
        socket_ = accept_from(listener);
        ASSERT_EQ(credentials_of(socket_).pid, peer_);
        const int fds[] = {reports_.fd(), claim_.fd(), wake_.client.get()};
        ASSERT_TRUE(send_message(socket_, std::as_bytes(std::span("attached")), fds));
    }
    bool alive() {
        pollfd event{.fd = socket_.get(), .events = POLLIN, .revents = 0};
        return ::poll(&event, 1, 0) == 0;
    }
    int exit_code() {
        int status = 0;
        ::waitpid(peer_, &status, 0);
        peer_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    }

    knurl::test::TempFolder folder_;
    Segment reports_ = Segment::create("knurl-test-reports", report_segment_bytes);
    Segment claim_ = Segment::create("knurl-test-claim", claim_segment_bytes);
    WakePair wake_ = make_wake_pair();
    UniqueFd socket_;
    WaiterFlag* flag_ = reinterpret_cast<WaiterFlag*>(claim_.data() + flag_at);
    Waker waker_;
    std::thread thread_;
    pid_t peer_ = -1;
};

TEST_F(Processes, ASleepingClientGetsEveryReportWhole) {
    constexpr std::uint64_t count = 3000;
    start("reports", count);
    BroadcastWriter writer(reports_.data(), report_slots, sizeof(Report));
    const WakeTarget wake_targets[] = {{.flag = flag_, .wake_fd = wake_.servo.get(), .trusted = true}};
    for (std::uint64_t n = 0; n < count; ++n) {
        const Report report = Report::numbered(n);
        writer.publish(&report);
        // Alternates the ways of waking one sleeper and several.
        if (n % 2 == 0)
            waker_.wake(wake_targets);
        else if (who_waits(wake_targets).count > 0)
            waker_.poke();
        if (n % 128 == 0)  // until the client has caught up and sleeps
            while (alive() && who_waits(wake_targets).count == 0) std::this_thread::yield();
    }
    EXPECT_EQ(exit_code(), 0);
}

TEST_F(Processes, CommandsAndRepliesCrossInOrder) {
    constexpr std::uint64_t count = 5000;
    start("echo", count);
    SpscProducer commands(claim_.data() + commands_at, ring_cells);
    SpscConsumer replies(claim_.data() + replies_at, ring_cells);
    std::uint64_t sent = 0, answered = 0;
    while (answered < count && (alive() || replies.available() > 0)) {
        Cell cell = Cell::numbered(sent);
        if (sent < count && commands.try_push(&cell, 1)) ++sent;
        if (replies.available() == 0) continue;
        ASSERT_TRUE(replies.peek(0, &cell, 1));
        ASSERT_TRUE(cell.is(answered));
        replies.pop(1);
        ++answered;
    }
    EXPECT_EQ(answered, count);
    EXPECT_EQ(exit_code(), 0);
}

TEST_F(Processes, TheLastBatchAlwaysArrives) {
    constexpr std::uint64_t count = 20000;
    start("batches", count);
    TripleReader reader(claim_.data() + batches_at, sizeof(Batch));
    std::uint64_t last = 0;
    for (bool running = true; last < count;) {
        const bool was_running = running;
        running = alive();
        if (!reader.take()) {
            if (!was_running) break;
            std::this_thread::yield();
            continue;
        }
        Batch batch;
        reader.copy(&batch, 0, sizeof batch);
        ASSERT_GT(reader.front_tag(), last);
        last = reader.front_tag();
        ASSERT_TRUE(batch.is(last));
    }
    EXPECT_EQ(last, count);
    EXPECT_EQ(exit_code(), 0);
}

}  // namespace
}  // namespace knurl::shm
