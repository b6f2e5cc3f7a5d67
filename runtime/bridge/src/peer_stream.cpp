#include "peer_stream.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <knurl/shm/spsc_ring.hpp>

namespace knurl::bridge {

namespace {

constexpr std::int64_t feedback_interval_ns = 20'000'000;  // for feedback that is too large for datagrams
constexpr std::size_t feedback_backlog = 64 * 1024;        // with more bytes than this already waiting, none
                                                           // is sent
constexpr std::size_t entry_bytes = sizeof(protocol::FeedbackEntry);

/// Only whole messages, of which the last ends its group. The servo counts cells in the same way, so that a
/// flag set here is one that it reads there.
bool well_formed(std::span<const std::byte> cells) noexcept {
    bool more = true;
    while (!cells.empty()) {
        protocol::CommandHeader header;
        if (cells.size() < shm::cell_bytes) return false;
        std::memcpy(static_cast<void*>(&header), cells.data(), sizeof header);
        const std::size_t bytes = std::size_t{header.cells} * shm::cell_bytes;
        if (bytes == 0 || bytes > cells.size() || (header.flags & ~protocol::command_flags::more) != 0)
            return false;
        more = header.flags != 0;
        cells = cells.subspan(bytes);
    }
    return !more;
}

/// Marks the commands as restricted; the servo decides, by the device's state in that cycle.
void restrict(std::span<std::byte> cells) noexcept {
    for (std::size_t at = 0; at < cells.size();) {
        std::uint32_t count = 0, bits = 0;
        std::byte* const flags = cells.data() + at + offsetof(protocol::CommandHeader, flags);
        std::memcpy(&count, cells.data() + at, sizeof count);
        std::memcpy(&bits, flags, sizeof bits);
        bits |= protocol::command_flags::restricted;
        std::memcpy(flags, &bits, sizeof bits);
        at += std::size_t{count} * shm::cell_bytes;
    }
}

}  // namespace

PeerStream::PeerStream(std::uint32_t id, detail::Attachment attachment, double report_rate)
    : id_(id),
      attachment_(std::move(attachment)),
      period_ns_(report_rate > 0 ? std::llround(std::min(1e9 / report_rate, 3.6e12)) : 0) {
    if (!attachment_.channel) return;
    const std::size_t ring = std::size_t{attachment_.channel->command_cells()} * shm::cell_bytes;
    waiting_.reserve(ring);
    scratch_.reserve(ring);
    entries_.reserve(attachment_.terms.capacity.representations);
}

// ------------------------------------------------------------------------------------------ to the servo

bool PeerStream::commands(std::span<const std::byte> cells, Role role, const char*& why) noexcept {
    why = "commands of an observer";
    if (!attachment_.channel) return false;
    why = "commands that are not whole groups of messages";
    if (cells.size() % shm::cell_bytes != 0 || !well_formed(cells)) return false;
    // A correct peer stays within the ring until it has the answers.
    why = "more commands than it has room for";
    if (cells.size() > scratch_.capacity() || waiting_.size() + cells.size() > waiting_.capacity())
        return false;
    scratch_.assign(cells.begin(), cells.end());
    if (role == Role::render) restrict(scratch_);
    if (push_waiting() && attachment_.channel->push(
                              scratch_.data(), static_cast<std::uint32_t>(scratch_.size() / shm::cell_bytes)))
        return true;
    // The servo answers before it frees the cells, so a fast peer's next commands may arrive in between.
    waiting_.insert(waiting_.end(), scratch_.begin(), scratch_.end());
    return true;
}

/// Pushes waiting groups in their order. True: none is left.
bool PeerStream::push_waiting() noexcept {
    std::size_t done = 0;
    while (done < waiting_.size()) {
        std::size_t end = done;
        bool more = true;
        while (more && end < waiting_.size()) {
            std::uint32_t cells = 0, flags = 0;
            std::memcpy(&cells, waiting_.data() + end, sizeof cells);
            std::memcpy(&flags, waiting_.data() + end + offsetof(protocol::CommandHeader, flags),
                        sizeof flags);
            more = (flags & protocol::command_flags::more) != 0;
            end += std::size_t{cells} * shm::cell_bytes;
        }
        if (!attachment_.channel->push(waiting_.data() + done,
                                       static_cast<std::uint32_t>((end - done) / shm::cell_bytes)))
            break;
        done = end;
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
    return waiting_.empty();
}

bool PeerStream::batch(std::span<const std::byte> whole, const char*& why) noexcept {
    why = "a batch that is none";
    protocol::BatchHeader header;
    if (!attachment_.channel || whole.size() < sizeof header) return false;
    std::memcpy(&header, whole.data(), sizeof header);
    if (header.bytes != whole.size() - sizeof header || header.bytes > attachment_.terms.capacity.batch_bytes)
        return false;
    if (batches_.whole(header.sequence)) publish(whole);
    return true;
}

void PeerStream::batch_piece(const DatagramHeader& header, std::span<const std::byte> body) noexcept {
    BatchPiece piece;
    if (!attachment_.channel || !take(body, piece)) return;
    const std::span<const std::byte> whole = batches_.add(header, piece, body);
    if (!whole.empty()) publish(whole);
}

/// The servo checks the content. Only a batch that does not fit the ring, or differs from what its datagrams
/// announced, stops here.
void PeerStream::publish(std::span<const std::byte> whole) noexcept {
    protocol::BatchHeader header;
    if (whole.size() < sizeof header) return;
    std::memcpy(&header, whole.data(), sizeof header);
    const std::span<const std::byte> entries = whole.subspan(sizeof header);
    if (header.bytes != entries.size() || header.bytes % 8 != 0 ||
        header.bytes > attachment_.terms.capacity.batch_bytes)
        return;
    attachment_.channel->publish(header, entries);
}

// ------------------------------------------------------------------------------------------- to the peer

bool PeerStream::cycle(const Report& report, std::uint64_t unseen, std::int64_t now, const Way& way,
                       const char*& why) noexcept {
    bool acknowledges = false;
    if (attachment_.channel) {
        if (!waiting_.empty()) push_waiting();
        // In this order: the answers that this feedback acknowledges are sent before it.
        attachment_.channel->feedback(feedback_, entries_);
        if (!answer(way, why)) return false;
        acknowledges = feedback_.batch != told_batch_ || feedback_.refused_batch != told_refused_;
        told_batch_ = feedback_.batch;
        told_refused_ = feedback_.refused_batch;
        why = "it does not read what it is sent";
        if (!send_feedback(now, way)) return false;
    }
    const std::uint64_t numbers = due(report, unseen);
    const bool is_due = numbers > 0;
    if (is_due) note(report, numbers);
    if (to_.length == 0) return true;
    if (is_due) {
        send(&report, way);
    } else if (acknowledges) {
        send(nullptr, way);  // a slow reader also learns at once what has taken effect
    }
    return true;
}

void PeerStream::note(const Report& newest, std::uint64_t numbers) noexcept {
    number_ += numbers;
    newest_ = newest;
}

void PeerStream::repeat(const Way& way) noexcept {
    if (number_ > 0) send(&newest_, way);
}

/// How many reports were due up to this one, which gets the last of their numbers: itself, plus those that
/// the bridge missed, so that the other end counts them as lost. 0: this report is not due.
std::uint64_t PeerStream::due(const Report& report, std::uint64_t unseen) noexcept {
    if (period_ns_ == 0) return 1 + unseen;
    if (report.deadline_ns < due_ns_) return 0;
    const auto passed = static_cast<std::uint64_t>((report.deadline_ns - due_ns_) / period_ns_);
    // Follows the grid, so that a rate that does not divide the servo's is right on average.
    due_ns_ = (report.deadline_ns - due_ns_ > period_ns_ ? report.deadline_ns : due_ns_) + period_ns_;
    return 1 + std::min(passed, unseen);
}

bool PeerStream::answer(const Way& way, const char*& why) noexcept {
    why = "it does not read the answers to its commands";
    std::array<protocol::Reply, 64> replies;
    for (std::size_t count = replies.size(); count == replies.size();) {
        for (count = 0; count < replies.size() && attachment_.channel->reply(replies[count]);) ++count;
        if (count > 0 &&
            !way.frames.send(static_cast<std::uint16_t>(FrameType::replies), static_cast<std::uint16_t>(id_),
                             std::as_bytes(std::span(replies.data(), count))))
            return false;
        answers_ += count;
    }
    return true;
}

/// Number of datagrams for all of it; above max_pieces it goes by TCP.
std::size_t PeerStream::pieces(const Way& way, bool report) const noexcept {
    const std::size_t room = way.mtu.bytes() - way.outgoing.overhead() - sizeof(ReportPiece);
    const std::size_t first = room - (report ? sizeof(Report) : 0) - sizeof(protocol::FeedbackHeader);
    if (entries_.size() <= first / entry_bytes) return 1;
    const std::size_t left = entries_.size() - first / entry_bytes, each = room / entry_bytes;
    return 1 + (left + each - 1) / each;
}

void PeerStream::send(const Report* report, const Way& way) noexcept {
    // Sending may show that the path is narrower: all pieces use one length.
    const std::size_t overhead = way.outgoing.overhead(), limit = way.mtu.bytes();
    const bool claim = attachment_.channel != nullptr;
    std::size_t count = claim && !entries_.empty() ? pieces(way, report != nullptr) : 1;
    const bool with_feedback = claim && !entries_.empty() && count <= max_pieces;
    if (!with_feedback) count = 1;
    std::size_t entry = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<std::byte> room = way.out.room();
        const DatagramHeader header{.kind = DatagramKind::report,
                                    .stream = static_cast<std::uint8_t>(id_),
                                    .piece = static_cast<std::uint8_t>(i),
                                    .pieces = static_cast<std::uint8_t>(count)};
        ReportPiece piece{.number = number_, .feedback_cycle = feedback_.cycle, .answers = answers_};
        std::size_t at = sizeof header + sizeof piece;
        const auto put = [&](const void* bytes, std::size_t size) {
            std::memcpy(room.data() + at, bytes, size);
            at += size;
        };
        if (i == 0 && report != nullptr) {
            piece.flags |= piece_flags::report;
            put(report, sizeof *report);
        }
        if (i == 0 && claim) {
            piece.flags |= piece_flags::feedback;
            put(&feedback_, sizeof feedback_);
        }
        if (with_feedback) {
            const std::size_t tag = overhead - sizeof header;
            piece.flags |= piece_flags::entries;
            piece.first_entry = static_cast<std::uint32_t>(entry);
            piece.entries = static_cast<std::uint32_t>(
                std::min((limit - at - tag) / entry_bytes, entries_.size() - entry));
            put(entries_.data() + entry, piece.entries * entry_bytes);
            entry += piece.entries;
        }
        std::memcpy(room.data(), &header, sizeof header);
        std::memcpy(room.data() + sizeof header, &piece, sizeof piece);
        if (const std::size_t length = way.outgoing.close(room, at)) way.out.put(length, to_, &way.mtu);
    }
}

/// Sends feedback that is too large for datagrams, at intervals. False: no room.
bool PeerStream::send_feedback(std::int64_t now, const Way& way) noexcept {
    if (entries_.empty() || feedback_.cycle == feedback_sent_ ||
        now - feedback_sent_ns_ < feedback_interval_ns || pieces(way, true) <= max_pieces ||
        way.frames.queued() > feedback_backlog)
        return true;
    feedback_sent_ = feedback_.cycle;
    feedback_sent_ns_ = now;
    const std::array parts{bytes_of(feedback_), std::as_bytes(std::span(entries_))};
    return way.frames.send(static_cast<std::uint16_t>(FrameType::feedback), static_cast<std::uint16_t>(id_),
                           parts);
}

}  // namespace knurl::bridge
