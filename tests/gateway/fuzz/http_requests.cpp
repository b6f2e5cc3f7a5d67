// Any bytes as requests: answered in HTTP, and nothing that needs a session is reached without one.

#include "session.hpp"

using namespace knurl::gateway::fuzzed;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string answer = converse({}, {data + 1, size - 1}, piece_of(data[0]));
    require(answer.empty() || answer.starts_with("HTTP/1.1 "), "what it says is HTTP");
    return 0;
}
