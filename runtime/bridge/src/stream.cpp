#include "stream.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <limits>
#include <new>

#include <netinet/in.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/link/clock.hpp>
#include <knurl/shm/deadline.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::bridge {

namespace {

using std::chrono::nanoseconds;

constexpr std::align_val_t ring_alignment{shm::line_bytes};
constexpr std::int64_t hello_interval_ns = 50'000'000;  // until the first report has arrived
// keeps the path open in firewalls and routers
constexpr std::int64_t remind_interval_ns = 1'000'000'000;
constexpr int most_rounds = 16;  // in one drain: 512 datagrams

std::byte* new_ring(std::size_t slot_bytes) {
    const std::size_t bytes = shm::broadcast_bytes(protocol::report_slots, slot_bytes);
    auto* memory = static_cast<std::byte*>(::operator new[](bytes, ring_alignment));
    std::memset(memory, 0, bytes);
    shm::broadcast_init(memory);
    return memory;
}

std::uint32_t cells_of(const protocol::ClaimCapacity& capacity) {
    return capacity.representations == 0 ? 0 : protocol::claim_layout(capacity).command_cells;
}

}  // namespace

void Stream::Free::operator()(std::byte* memory) const noexcept {
    ::operator delete[](memory, ring_alignment);
}

Stream::Stream(std::shared_ptr<Connection> connection, const Attached& attached)
    : connection_(std::move(connection)),
      id_(attached.stream),
      socket_(connection_->datagram_socket()),
      event_(shm::make_event()),
      loop_(::epoll_create1(EPOLL_CLOEXEC)),
      memory_(new_ring(sizeof(StoredReport))),
      writer_(memory_.get(), protocol::report_slots, sizeof(StoredReport)),
      reader_(memory_.get(), protocol::report_slots, sizeof(StoredReport)),
      batch_(attached.terms.capacity),
      unanswered_(cells_of(attached.terms.capacity)),
      feedback_(attached.terms.capacity.representations) {
    epoll_event event{.events = EPOLLIN, .data = {}};
    if (!loop_ || ::epoll_ctl(loop_.get(), EPOLL_CTL_ADD, socket_.get(), &event) != 0 ||
        ::epoll_ctl(loop_.get(), EPOLL_CTL_ADD, event_.get(), &event) != 0)
        throw Error(Error::Kind::refused,
                    "cannot wait for reports: no file descriptor is left; raise the limit (ulimit -n)");
}

// ---------------------------------------------------------------------------------------------- reports

bool Stream::next(Report& out) noexcept {
    const auto lock = connection_->lock();
    StoredReport slot;
    if (!reader_.next(&slot)) {
        drain();
        if (!reader_.next(&slot)) return false;
    }
    out = slot.report;
    gap_read_ = slot.gap;
    keep_event(reader_.fresh());
    return true;
}

bool Stream::latest(Report& out) noexcept {
    const auto lock = connection_->lock();
    drain();
    StoredReport slot;
    if (!reader_.latest(&slot)) return false;
    out = slot.report;
    gap_read_ = slot.gap;
    return true;
}

bool Stream::newest(Report& out) noexcept {
    const auto lock = connection_->lock();
    drain();
    StoredReport slot;
    const std::uint64_t end = reader_.published();
    if (end > 0 && reader_.at(end - 1, &slot)) {
        out = slot.report;
        keep_event(reader_.fresh());
        return true;
    }
    return false;
}

void Stream::wait(nanoseconds timeout, bool for_any) noexcept {
    const shm::Deadline deadline = shm::deadline_after(timeout);
    std::uint64_t seen = 0;
    for (bool first = true;; first = false) {
        {
            // The event is lowered before the search for datagrams. A datagram that the other thread drains
            // later raises it again; one that it has drained before is in the ring.
            const auto lock = connection_->lock();
            keep_event(false);
            if (first) seen = arrivals_;
            drain();
            if (for_any ? arrivals_ != seen : reader_.fresh()) return;
            if (std::chrono::steady_clock::now() >= deadline) return;
            asking_ += for_any ? 1 : 0;
        }
        pollfd sources[] = {{.fd = socket_.get(), .events = POLLIN, .revents = 0},
                            {.fd = event_.get(), .events = POLLIN, .revents = 0}};
        shm::poll_until(sources, deadline);
        if (!for_any) continue;
        const auto lock = connection_->lock();
        --asking_;
    }
}

void Stream::rearm() noexcept {
    const auto lock = connection_->lock();
    polled_ = true;
    keep_event(false);
    drain();
    keep_event(reader_.fresh());
}

void Stream::keep_event(bool raised) noexcept {
    if (raised == raised_ || (raised && !polled_)) return;
    raised_ = raised;
    std::uint64_t count = 1;
    [[maybe_unused]] const ssize_t done =
        raised ? ::write(event_.get(), &count, sizeof count) : ::read(event_.get(), &count, sizeof count);
}

void Stream::wake() noexcept {
    raised_ = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t done = ::write(event_.get(), &one, sizeof one);
}

bool Stream::drain() noexcept {
    const std::uint64_t before = arrivals_;
    ReceiveBatch& bag = connection_->receive_batch();
    for (int round = 0; round < most_rounds; ++round) {
        const std::size_t count = bag.receive(socket_.get());
        for (std::size_t i = 0; i < count; ++i) take_datagram(bag.datagram(i));
        if (count < ReceiveBatch::most) break;
    }
    return arrivals_ != before;
}

void Stream::take_datagram(std::span<std::byte> datagram) noexcept {
    const IncomingDatagrams::Opened opened = connection_->open(datagram);
    if (opened.verdict == IncomingDatagrams::Verdict::foreign || opened.header.stream != id_ ||
        opened.header.kind != DatagramKind::report)
        return;
    if (opened.verdict == IncomingDatagrams::Verdict::already) {
        ++duplicated_;
        return;
    }
    std::span<const std::byte> body = opened.body;
    ReportPiece piece;
    if (!take(body, piece)) return;
    if (opened.verdict == IncomingDatagrams::Verdict::too_old) {
        if ((piece.flags & piece_flags::report) != 0) tally_.take_old(piece.number);
        return;
    }
    Report report;
    if ((piece.flags & piece_flags::report) != 0) {
        if (!take(body, report)) return;
        take_report(piece.number, report);
    }
    if (unanswered_.capacity() == 0) return;  // an observer
    protocol::FeedbackHeader header;
    if ((piece.flags & piece_flags::feedback) != 0) {
        if (!take(body, header)) return;
        acknowledge(header, piece.answers);
    }
    if ((piece.flags & piece_flags::entries) != 0) feedback_.piece(opened.header, piece, body);
}

void Stream::take_report(std::uint64_t number, const Report& report) noexcept {
    if (!tally_.take(number)) return;
    ++arrivals_;
    const StoredReport slot{.report = report, .gap = tally_.gaps()};
    writer_.publish(&slot);
}

Network Stream::network() noexcept {
    const auto lock = connection_->lock();
    const std::int64_t now = detail::monotonic_ns();
    const ClockEstimate& clock = connection_->clock();
    return {.lost = tally_.lost(),
            .late = tally_.late(),
            .duplicated = duplicated_ + tally_.copies(),
            .resent = resent_,
            .round_trip = nanoseconds(clock.round_trip()),
            .clock_offset = nanoseconds(clock.offset_at(now)),
            .clock_uncertainty = nanoseconds(clock.uncertainty(now)),
            .drift = clock.drift(),
            .drift_uncertainty = clock.drift_uncertainty(),
            .encrypted = connection_->encrypted()};
}

// --------------------------------------------------------------------------------------- the two channels

bool Stream::push(const void* commands, std::uint32_t cells) noexcept {
    const auto lock = connection_->lock();
    // It counts as lost on the way. A caller that waits for the answer learns the reason.
    if (connection_->dead()) return true;
    if (!unanswered_.fits(cells)) return false;
    const std::span part(static_cast<const std::byte*>(commands), std::size_t{cells} * shm::cell_bytes);
    if (!connection_->send(FrameType::commands, id_, {&part, 1})) return false;
    unanswered_.sent(commands, cells);
    return true;
}

bool Stream::reply(protocol::Reply& out) noexcept {
    const auto lock = connection_->lock();
    Unanswered::Answer answer;
    if (!unanswered_.next(answer)) return false;
    if (answer.removed) batch_.removed(answer.id);
    out = answer.reply;
    return true;
}

bool Stream::publish(protocol::BatchHeader header, std::span<const std::byte> entries) noexcept {
    const auto lock = connection_->lock();
    const std::int64_t now = detail::monotonic_ns();
    header.commit_ns += connection_->clock().offset_at(now);
    batch_.merge(header, entries);
    send_batch(now);
    return true;  // unacknowledged parameters are kept here and sent again with the next batch
}

bool Stream::feedback(protocol::FeedbackHeader& header, std::vector<protocol::FeedbackEntry>& entries) {
    const auto lock = connection_->lock();
    drain();
    keep_event(reader_.fresh());
    return feedback_.take(unanswered_.answers(), header, entries);
}

void Stream::acknowledge(const protocol::FeedbackHeader& header, std::uint64_t answers) noexcept {
    if (header.cycle >= feedback_.newest_cycle()) ++arrivals_;
    feedback_.header(header, answers);
    batch_.acknowledged(std::max(header.batch, header.refused_batch));
}

std::size_t Stream::piece_bytes() const noexcept {
    return (connection_->mtu().bytes() - connection_->overhead() - sizeof(BatchPiece)) / 8 * 8;
}

void Stream::send_batch(std::int64_t now) noexcept {
    const std::span<const std::byte> message = batch_.message();
    sent_ns_ = now;
    batch_by_tcp_ = message.size() > max_pieces * piece_bytes() || !send_pieces(message);
    batch_sent_ = !batch_by_tcp_ || connection_->send(FrameType::batch, id_, {&message, 1});
}

bool Stream::send_pieces(std::span<const std::byte> message) noexcept {
    alignas(8) std::array<std::byte, datagram_bytes> room;
    const std::size_t most = piece_bytes();
    const std::size_t pieces = (message.size() + most - 1) / most;
    for (std::size_t i = 0; i < pieces; ++i) {
        const std::span part = message.subspan(i * most, std::min(most, message.size() - i * most));
        const DatagramHeader header{.kind = DatagramKind::batch,
                                    .stream = static_cast<std::uint8_t>(id_),
                                    .piece = static_cast<std::uint8_t>(i),
                                    .pieces = static_cast<std::uint8_t>(pieces)};
        const BatchPiece piece{.sequence = batch_.sequence(),
                               .offset = static_cast<std::uint32_t>(i * most),
                               .total = static_cast<std::uint32_t>(message.size())};
        const std::size_t head = write(room, header, piece);
        std::memcpy(room.data() + head, part.data(), part.size());
        if (connection_->post(socket_.get(), room, head + part.size())) continue;
        return false;  // the path has become narrower: this one goes by TCP, the next ones in smaller pieces
    }
    return true;
}

void Stream::hello() noexcept {
    alignas(8) std::array<std::byte, 128> room;
    const DatagramHeader header{.kind = DatagramKind::hello, .stream = static_cast<std::uint8_t>(id_)};
    const HelloBody body{.received = tally_.newest()};
    connection_->post(socket_.get(), room, write(room, header, body));
}

void Stream::tick(std::int64_t now) noexcept {
    if (drain()) wake();
    if (now >= next_hello_ns_) {
        hello();
        next_hello_ns_ = now + (tally_.newest() == 0 ? hello_interval_ns : remind_interval_ns);
    }
    if (batch_.unacknowledged() && batch_by_tcp_ && !batch_sent_)
        send_batch(now);  // it was waiting for room; once sent by TCP it arrives
}

std::int64_t Stream::resend(std::int64_t now) noexcept {
    if (!batch_.unacknowledged() || batch_by_tcp_) return std::numeric_limits<std::int64_t>::max();
    if (now - sent_ns_ >= resend_ns) {
        ++resent_;
        send_batch(now);
    }
    return sent_ns_ + resend_ns;
}

void Stream::take_replies(std::span<const std::byte> bytes) noexcept {
    protocol::Reply reply;
    while (take(bytes, reply)) unanswered_.answered(reply);
    // A caller that waits for it may have the report of that cycle already, and would wait for the next one.
    ++arrivals_;
    if (asking_ > 0) wake();
}

void Stream::take_feedback(std::span<const std::byte> bytes) noexcept {
    protocol::FeedbackHeader header;
    if (!take(bytes, header)) return;
    batch_.acknowledged(std::max(header.batch, header.refused_batch));
    feedback_.all(header, bytes);
}

}  // namespace knurl::bridge
