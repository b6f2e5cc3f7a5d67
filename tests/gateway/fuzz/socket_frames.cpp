// Any bytes as frames of an open WebSocket.

#include "session.hpp"

using namespace knurl::gateway::fuzzed;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string answer = converse(
        "GET /socket HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        {data + 1, size - 1}, piece_of(data[0]));
    require(answer.starts_with("HTTP/1.1 101 "), "it was open");
    return 0;
}
