#pragma once
// The bridge's end of one claim of a peer; the test takes the part of the servo.

#include <deque>

#include "net_pair.hpp"
#include "peer_stream.hpp"

namespace knurl::bridge::test {

inline constexpr std::uint32_t ring_cells = 64;
inline constexpr std::uint32_t batch_capacity = 4096;  // bytes
inline constexpr std::int64_t start_ns = 1'000'000'000'000, cycle_ns = 1'000'000;
inline constexpr std::uint8_t stream_id = 5;

/// The servo's side of the claim: what it received, and what it will answer.
struct Played {
    std::size_t room = 1000;  // cells
    std::vector<std::vector<std::byte>> groups;
    std::vector<std::uint64_t> batches;
    std::deque<protocol::Reply> replies;
    protocol::FeedbackHeader feedback;
    std::vector<protocol::FeedbackEntry> entries;
};

class PlayedChannel final : public detail::ClaimChannel {
  public:
    explicit PlayedChannel(Played& played) : played_(played) {}
    bool push(const void* commands, std::uint32_t cells) noexcept override {
        const auto* at = static_cast<const std::byte*>(commands);
        if (cells > played_.room) return false;
        played_.room -= cells;
        played_.groups.emplace_back(at, at + cells * shm::cell_bytes);
        return true;
    }
    std::uint32_t command_cells() const noexcept override { return ring_cells; }
    bool reply(protocol::Reply& out) noexcept override {
        if (played_.replies.empty()) return false;
        out = played_.replies.front();
        played_.replies.pop_front();
        return true;
    }
    bool publish(const protocol::BatchHeader& header, std::span<const std::byte>) noexcept override {
        played_.batches.push_back(header.sequence);
        return true;
    }
    bool feedback(protocol::FeedbackHeader& header, std::vector<protocol::FeedbackEntry>& entries) override {
        header = played_.feedback;
        entries = played_.entries;
        return true;
    }

  private:
    Played& played_;
};

/// A datagram that arrived at the peer.
struct Came {
    DatagramHeader header;
    ReportPiece piece;
    std::optional<Report> report;
    std::optional<protocol::FeedbackHeader> feedback;
    std::vector<std::byte> felt;
};

struct Stream : testing::Test {
    Stream() {
        pair.open();
        mtu.came_through(datagram_bytes);
    }

    detail::Attachment attachment() {
        detail::Attachment attached;
        attached.terms.capacity = {.representations = 300, .batch_bytes = batch_capacity};
        attached.channel = std::make_unique<PlayedChannel>(servo);
        return attached;
    }
    /// Sets the destination of datagrams.
    void bind(PeerStream& stream) {
        PeerAddress to;
        const sockaddr_in at = loopback(port_of(peer));
        std::memcpy(&to.address, &at, sizeof at);
        to.length = sizeof at;
        stream.bind(to);
    }
    /// Ends cycle `number`, so many ms after cycle 0. `unseen`: number of earlier cycles that the bridge
    /// missed.
    bool cycle(PeerStream& stream, std::int64_t number, std::uint64_t unseen = 0) {
        Report report;
        report.cycle = static_cast<std::uint64_t>(number);
        report.deadline_ns = start_ns + number * cycle_ns;
        const bool good = stream.cycle(report, unseen, report.deadline_ns, way, why);
        out.flush();
        return good;
    }
    /// All that arrived, up to an empty datagram sent here, since a busy kernel may deliver after send()
    /// returns.
    std::vector<Came> datagrams() {
        std::vector<Came> all;
        std::array<std::byte, datagram_bytes> bytes;
        const sockaddr_in to = loopback(port_of(peer));
        EXPECT_EQ(::sendto(ours.get(), nullptr, 0, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
        for (;;) {
            pollfd one{.fd = peer.get(), .events = POLLIN, .revents = 0};
            EXPECT_EQ(::poll(&one, 1, 10'000), 1);
            const ssize_t n = ::recv(peer.get(), bytes.data(), bytes.size(), 0);
            if (n <= 0) break;
            std::span<const std::byte> rest(bytes.data(), static_cast<std::size_t>(n));
            Came& came = all.emplace_back();
            EXPECT_TRUE(take(rest, came.header) && take(rest, came.piece));
            EXPECT_EQ(came.header.stream, stream_id);
            if ((came.piece.flags & piece_flags::report) != 0) {
                EXPECT_TRUE(take(rest, came.report.emplace()));
            }
            if ((came.piece.flags & piece_flags::feedback) != 0) {
                EXPECT_TRUE(take(rest, came.feedback.emplace()));
            }
            came.felt.assign(rest.begin(), rest.end());
        }
        return all;
    }
    std::vector<Received> frames() {
        pair.server.pump();
        pair.client.pump();
        return take_all(pair.client);
    }
    Pair pair;
    shm::UniqueFd peer = bound(SOCK_DGRAM | SOCK_NONBLOCK), ours = bound(SOCK_DGRAM | SOCK_NONBLOCK);
    OutQueue out{ours.get()};
    OutgoingDatagrams outgoing{1, nullptr};
    PathMtu mtu;
    Way way{.frames = pair.server, .outgoing = outgoing, .out = out, .mtu = mtu};
    Played servo;
    const char* why = "";
};

}  // namespace knurl::bridge::test
