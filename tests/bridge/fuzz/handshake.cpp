// Any bytes into an end that expects TLS and a key: it never opens, never returns a frame, and states why it
// closed. The first byte chooses the side; the corpus has real first flights of both sides.

#include "streams.hpp"

using namespace knurl;
using namespace knurl::bridge;

namespace {

Key key() {
    Key k{.name = "lab", .role = Role::control};
    k.secret.fill(std::byte{7});
    return k;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto client = TlsContext::client(key());
    static const auto server = TlsContext::server({key()});
    if (size < 1 || size > 60'000) return 0;
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
