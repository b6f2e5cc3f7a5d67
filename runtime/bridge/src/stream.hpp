#pragma once
// One claim or observer of a connection: its own UDP socket, so that only its reports wake a thread that
// waits for them; the reports in a ring like the servo's; the two channels. Used under the connection's lock,
// which every call takes itself unless stated otherwise.
//
//   application's thread: wait -> poll(socket, event) -> drain: datagrams -> ring -> next()
//   connection's thread:  every 10 ms: drain; if something came: event

#include <array>
#include <memory>
#include <vector>

#include <knurl/link/transport.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/shm/broadcast_ring.hpp>

#include "connection.hpp"
#include "feedback_assembly.hpp"
#include "pending_batch.hpp"
#include "report_tally.hpp"
#include "unanswered.hpp"

namespace knurl::bridge {

class Stream {
  public:
    Stream(std::shared_ptr<Connection> connection, const Attached& attached);
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;

    std::uint32_t id() const { return id_; }

    // ReportSource.
    bool next(Report& out) noexcept;
    bool latest(Report& out) noexcept;
    bool newest(Report& out) noexcept;
    bool fresh() const noexcept { return reader_.fresh(); }
    std::uint64_t unread() const noexcept { return reader_.unread(); }
    std::uint64_t missed() const noexcept { return reader_.missed() + gap_read_; }
    void wait(std::chrono::nanoseconds timeout, bool for_any) noexcept;
    int event() const noexcept { return loop_.get(); }
    void rearm() noexcept;
    Network network() noexcept;

    // ClaimChannel.
    bool push(const void* commands, std::uint32_t cells) noexcept;
    std::uint32_t command_cells() const noexcept { return unanswered_.capacity(); }
    bool reply(protocol::Reply& out) noexcept;
    bool publish(protocol::BatchHeader header, std::span<const std::byte> entries) noexcept;
    bool feedback(protocol::FeedbackHeader& header, std::vector<protocol::FeedbackEntry>& entries);

    // For the connection's thread, with the lock held.
    void tick(std::int64_t now) noexcept;
    /// Sends again what was not acknowledged for `resend_ns`. Returns when the next repetition is due.
    std::int64_t resend(std::int64_t now) noexcept;
    void take_replies(std::span<const std::byte> bytes) noexcept;
    void take_feedback(std::span<const std::byte> bytes) noexcept;
    /// The other end is gone: wakes all that wait.
    void wake() noexcept;

  private:
    /// A report in the ring, with the number of missing reports up to it.
    struct StoredReport {
        Report report;
        std::uint64_t gap = 0;
    };
    static_assert(sizeof(StoredReport) % 8 == 0);

    // All of these need the lock. True: something has arrived.
    bool drain() noexcept;  // true: something came
    void take_datagram(std::span<std::byte> datagram) noexcept;
    void take_report(std::uint64_t number, const Report& report) noexcept;
    void acknowledge(const protocol::FeedbackHeader& header, std::uint64_t answers) noexcept;
    void keep_event(bool raised) noexcept;
    void hello() noexcept;
    void send_batch(std::int64_t now) noexcept;
    bool send_pieces(std::span<const std::byte> message) noexcept;
    std::size_t piece_bytes() const noexcept;

    const std::shared_ptr<Connection> connection_;
    const std::uint32_t id_;
    shm::UniqueFd socket_, event_, loop_;  // loop_: an epoll over the other two
    bool polled_ = false;                  // by an event loop
    bool raised_ = false;                  // event_
    std::uint32_t asking_ = 0;             // threads that sleep until anything arrives

    struct Free {
        void operator()(std::byte* memory) const noexcept;
    };
    std::unique_ptr<std::byte[], Free> memory_;
    shm::BroadcastWriter writer_;
    shm::BroadcastReader reader_;
    std::uint64_t arrivals_ = 0;  // reports, feedback, answers
    ReportTally tally_;
    std::uint64_t gap_read_ = 0;                 // tally_.gaps() up to the last report that was read
    std::uint64_t duplicated_ = 0, resent_ = 0;  // datagrams, batches
    std::int64_t next_hello_ns_ = 0;

    PendingBatch batch_;
    bool batch_by_tcp_ = false, batch_sent_ = true;
    std::int64_t sent_ns_ = 0;
    Unanswered unanswered_;
    FeedbackAssembly feedback_;
};

}  // namespace knurl::bridge
