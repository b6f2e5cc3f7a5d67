// Any bytes into an end that expects TLS and a key: it never opens, never returns a frame, and states why it
// closed. The first byte chooses the side; the corpus has real first flights of both sides. The waiting room
// reads a caller's bytes once they have a whole hello, cannot become one, or reach the bound.

#include "streams.hpp"
#include "waiting_room.hpp"

using namespace knurl;
using namespace knurl::bridge;

namespace {

Key key() {
    Key k{.name = "lab", .role = Role::control};
    k.secret.fill(std::byte{7});
    return k;
}

void require_reading_once_worth_it(std::span<const std::byte> bytes, bool tls) {
    bool worth = false;
    for (std::size_t size = 0; size <= std::min(bytes.size(), max_hello_bytes); ++size) {
        const bool now = is_worth_reading(bytes.first(size), tls);
        fuzz::require(now || !worth);
        worth = now;
    }
    fuzz::require(worth || bytes.size() < max_hello_bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto client = TlsContext::client(key());
    static const auto server = TlsContext::server({key()});
    if (size < 1 || size > 60'000) return 0;
    for (const bool tls : {true, false})
        require_reading_once_worth_it(std::as_bytes(std::span(data + 1, size - 1)), tls);
    const bool we_serve = data[0] & 1;
    fuzz::Ends ends = fuzz::connected();
    FrameStream stream(std::move(ends.ours), we_serve, we_serve ? server : client,
                       {.payload = 300, .outgoing = 1000});
    stream.pump();
    ::send(ends.theirs.get(), data + 1, size - 1, MSG_NOSIGNAL);
    ::shutdown(ends.theirs.get(), SHUT_WR);
    for (int rounds = 0; rounds < 10 && stream.state() == FrameStream::State::handshaking; ++rounds) {
        stream.pump();
        fuzz::discard(ends.theirs);
    }
    fuzz::require(stream.state() == FrameStream::State::closed);
    fuzz::require(!stream.reason().empty());
    fuzz::require(stream.next() == nullptr);
    fuzz::require(!stream.export_keys("x"));
    return 0;
}
