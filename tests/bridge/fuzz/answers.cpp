// Any answers of a bridge to a client: about itself and its devices, to a claim, to commands. The client's
// end of the connection is real, with its thread. The fake bridge answers each frame with the next piece of
// the input, as it is or (by the control byte) after the beginning of a valid answer. When no piece is left,
// it disconnects. In every case the client ends soon with a line, and has no more than it requested. Each
// piece has a control byte and two bytes of length.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>

#include <knurl/bridge/remote.hpp>

#include "../../fuzz/pieces.hpp"
#include "streams.hpp"
#include "wire.hpp"

using namespace knurl;
using namespace knurl::bridge;

namespace {

constexpr int patience_ms = 1;
constexpr unsigned good_start = 8, another = 128;  // `another`: the next piece goes with this one
constexpr FrameType types[] = {FrameType::welcome, FrameType::attached, FrameType::refused,
                               FrameType::replies, FrameType::feedback, FrameType::gone,
                               FrameType::hello,   FrameType{999}};
constexpr protocol::ClaimCapacity capacity{.representations = 16, .batch_bytes = 8192};

DeviceRow good_row() {
    DeviceRow row;
    put_text(row.name, "hand");
    row.rate = 1000;
    return row;
}

/// Overwrites the first bytes of the input: a welcome with one device, or the requested terms.
void put_right(FrameType type, std::vector<std::byte>& bytes) {
    const auto over = [&](const auto&... parts) {
        bytes.resize(std::max(bytes.size(), (sizeof parts + ...)));
        write(bytes, parts...);
    };
    if (type == FrameType::welcome) over(Welcome{.session = 7, .devices = 1}, good_row());
    if (type == FrameType::attached) {
        Attached attached;
        attached.stream = 1;
        attached.terms.capacity = capacity;
        over(attached);
    }
}

shm::UniqueFd bound(int type, sockaddr_in& at) {
    shm::UniqueFd fd(::socket(AF_INET, type | SOCK_CLOEXEC, 0));
    socklen_t length = sizeof at;
    fuzz::require(::bind(fd.get(), reinterpret_cast<sockaddr*>(&at), length) == 0);
    ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&at), &length);
    return fd;
}

/// The bridge: one thread for all inputs, one connection for each.
class Bridge {
  public:
    Bridge() {
        at_.sin_family = AF_INET;
        at_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        listener_ = bound(SOCK_STREAM, at_);
        datagrams_ = bound(SOCK_DGRAM, at_);
        ::listen(listener_.get(), 1);
        std::thread([this] {
            for (;;) serve();
        }).detach();
    }
    /// Before the client connects.
    void play(std::span<const std::uint8_t> input) {
        input_ = input;
        done_ = false;
    }
    void await_end() { done_.wait(false); }
    const sockaddr_in& at() const { return at_; }

  private:
    void serve() {
        const shm::UniqueFd peer(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
        fuzz::Pieces pieces(input_);
        std::vector<char> bytes(65536);
        int asked = 0;
        for (;;) {
            pollfd sources[] = {{.fd = peer.get(), .events = POLLIN, .revents = 0},
                                {.fd = datagrams_.get(), .events = POLLIN, .revents = 0}};
            const bool silent = ::poll(sources, 2, patience_ms) == 0;
            if (sources[1].revents != 0) echo();
            if (sources[0].revents == 0 && !silent) continue;
            // Any request counts, since the client makes one at a time. A piece that the client does not
            // accept as an answer would leave it waiting, so a silent client is sent the next piece.
            if (!silent && ::recv(peer.get(), bytes.data(), bytes.size(), 0) <= 0) break;
            if (!say_next(peer, pieces, ++asked <= 2)) ::shutdown(peer.get(), SHUT_WR);
        }
        done_ = true;
        done_.notify_one();
    }

    /// `waits`: for an answer, which neither replies nor feedback are.
    static bool say_next(const shm::UniqueFd& peer, fuzz::Pieces& pieces, bool waits) {
        for (fuzz::Pieces::Piece piece; pieces.next(piece);) {
            const FrameType type = types[piece.control & 7];
            if (piece.control & good_start) put_right(type, piece.bytes);
            struct {
                std::uint32_t bytes;
                std::uint16_t type, stream;
            } header{static_cast<std::uint32_t>(piece.bytes.size()), static_cast<std::uint16_t>(type),
                     static_cast<std::uint16_t>(piece.control >> 4 & 3)};
            ::send(peer.get(), &header, sizeof header, MSG_NOSIGNAL | MSG_MORE);
            ::send(peer.get(), piece.bytes.data(), piece.bytes.size(), MSG_NOSIGNAL);
            const bool news = type == FrameType::replies || type == FrameType::feedback;
            if ((piece.control & another) == 0 && !(waits && news)) return true;
        }
        return false;
    }

    void echo() {
        std::array<std::byte, 2048> bytes;
        sockaddr_in from{};
        socklen_t length = sizeof from;
        const ssize_t got = ::recvfrom(datagrams_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT,
                                       reinterpret_cast<sockaddr*>(&from), &length);
        if (got < static_cast<ssize_t>(sizeof(DatagramHeader) + sizeof(PongBody))) return;
        DatagramHeader header;
        std::memcpy(&header, bytes.data(), sizeof header);
        header.kind = DatagramKind::pong;
        std::memcpy(bytes.data(), &header, sizeof header);
        ::sendto(datagrams_.get(), bytes.data(), static_cast<std::size_t>(got), 0,
                 reinterpret_cast<const sockaddr*>(&from), length);
    }

    sockaddr_in at_{};
    shm::UniqueFd listener_, datagrams_;
    std::span<const std::uint8_t> input_;
    std::atomic<bool> done_ = false;
};

void require_a_line(const std::string& text) {
    fuzz::require(!text.empty() && text.find_first_of("\n\r\x1b") == std::string::npos);
}

/// Claims, and sends commands while the other end is there and answers.
void use(detail::Link& link) {
    protocol::ClaimRequest request;
    request.capacity = capacity;
    const detail::Attachment hand = link.attach(0, request);
    fuzz::require(hand.terms.frame.scale > 0 && hand.channel != nullptr);
    std::array<std::byte, shm::cell_bytes> cell{};
    std::uint64_t number = 0;
    for (int full = 0; full < 3; ++full) {
        const protocol::CommandHeader command{
            .cells = 1, .type = protocol::CommandType::arm, .number = ++number};
        std::memcpy(cell.data(), &command, sizeof command);
        hand.channel->push(cell.data(), 1);
        protocol::Reply reply;
        std::uint64_t replies = 0;
        while (hand.channel->reply(reply)) ++replies;
        fuzz::require(replies <= number);
        protocol::FeedbackHeader header;
        std::vector<protocol::FeedbackEntry> entries;
        if (hand.channel->feedback(header, entries))
            fuzz::require(header.entries == entries.size() && entries.size() <= capacity.representations);
        pollfd gone{.fd = link.hang_up(), .events = POLLRDHUP, .revents = 0};
        if (::poll(&gone, 1, 0) > 0) break;
    }
    link.release(hand);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Bridge& bridge = *new Bridge;
    if (size > 60'000) return 0;
    bridge.play({data, size});
    Endpoint at{.length = sizeof(sockaddr_in), .text = "played"};
    std::memcpy(&at.address, &bridge.at(), sizeof(sockaddr_in));
    try {
        const auto link = connect_remote(std::span(&at, 1), {.client_name = "fuzz"});
        fuzz::require(link->devices().size() <= protocol::max_devices);
        if (!link->devices().empty()) use(*link);
    } catch (const Error& error) {
        require_a_line(error.what());
        // It has not waited for an answer from a bridge that had hung up. (A refusal may have any text.)
        fuzz::require(!std::string_view(error.what()).starts_with("bridge played does not answer"),
                      error.what());
    }
    bridge.await_end();
    return 0;
}
