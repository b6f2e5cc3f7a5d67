// Any frames of commands and batches from a peer that is in. What reaches the servo's ring is whole groups of
// messages, nothing that a role forbids goes unmarked, and everything else ends the peer with a reason. The
// first byte says the role; each frame has a control byte (batch or commands, whether the ring has room) and
// two of length.

#include "fake_claim.hpp"

using namespace knurl::bridge;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    fuzz::FakeClaim claim;
    claim.channel->render = data[0] & 1;
    const Role role = claim.channel->render ? Role::render : Role::control;
    std::uint64_t sent = 0;
    for (std::span<const std::uint8_t> rest(data + 1, size - 1); rest.size() >= 3;) {
        const unsigned control = rest[0];
        const std::size_t length = std::min<std::size_t>(rest[1] | rest[2] << 8, rest.size() - 3);
        // A copy to the byte: reading past its end is seen.
        std::vector<std::byte> frame(length);
        if (length > 0) std::memcpy(frame.data(), rest.data() + 3, length);
        rest = rest.subspan(3 + length);
        claim.channel->full = control & 2;
        const char* why = "";
        const bool good =
            control & 1 ? claim.stream.batch(frame, why) : claim.stream.commands(frame, role, why);
        if (!good) {
            fuzz::require(*why != '\0');
            return 0;  // the peer is closed
        }
        if (!(control & 1)) sent += length / knurl::shm::cell_bytes;
        fuzz::require(claim.channel->cells <= sent);
    }
    return 0;
}
