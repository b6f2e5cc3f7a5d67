// Any bytes, cut anywhere, into a plain connection. The resulting frames are those of a simple parse of the
// whole, and an illegal length ends the connection. The first byte chooses the side and how the bytes are
// cut.

#include <algorithm>
#include <cstring>
#include <vector>

#include "streams.hpp"

using namespace knurl;
using namespace knurl::bridge;

namespace {

constexpr FrameStream::Limits limits{.payload = 300, .outgoing = 1000};

struct Expected {
    std::vector<std::span<const std::uint8_t>> payloads;
    bool refused = false;
};

/// Parses by the definition of the format, independently of the implementation.
Expected read_plainly(std::span<const std::uint8_t> bytes) {
    Expected expected;
    while (bytes.size() >= 8 && !expected.refused) {
        const std::uint32_t length =
            bytes[0] | bytes[1] << 8 | bytes[2] << 16 | std::uint32_t{bytes[3]} << 24;
        expected.refused = length == 0 || length > limits.payload;
        if (expected.refused || bytes.size() - 8 < length) break;
        expected.payloads.push_back(bytes.subspan(8, length));
        bytes = bytes.subspan(8 + length);
    }
    return expected;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1 || size > 60'000) return 0;
    const bool server = data[0] & 1;
    const std::size_t cut = 1 + (data[0] >> 1) * (data[0] >> 1);
    const std::span<const std::uint8_t> bytes(data + 1, size - 1);

    fuzz::Ends ends = fuzz::connected();
    FrameStream stream(std::move(ends.ours), server, nullptr, limits);
    stream.pump();
    const Expected expected = read_plainly(bytes);
    std::size_t given = 0;
    for (std::size_t at = 0; at < bytes.size() && stream.state() != FrameStream::State::closed;) {
        const std::size_t now = std::min(cut, bytes.size() - at);
        const ssize_t sent = ::send(ends.theirs.get(), bytes.data() + at, now, MSG_NOSIGNAL);
        fuzz::require(sent > 0);
        at += static_cast<std::size_t>(sent);
        stream.pump();
        while (const Frame* frame = stream.next()) {
            fuzz::require(given < expected.payloads.size());
            const auto& payload = expected.payloads[given++];
            fuzz::require(frame->payload.size() == payload.size() &&
                          std::memcmp(frame->payload.data(), payload.data(), payload.size()) == 0);
        }
    }
    const bool closed = stream.state() == FrameStream::State::closed;
    // A TLS greeting is known by three bytes, before there is a length.
    const bool tls = given == 0 && bytes.size() >= 3 && (bytes[0] == 21 || bytes[0] == 22) && bytes[1] == 3 &&
                     (bytes[2] == 1 || bytes[2] == 3);
    fuzz::require(closed == (expected.refused || tls));
    fuzz::require(!closed || !stream.reason().empty());
    fuzz::require(given == expected.payloads.size() || tls);
    return 0;
}
