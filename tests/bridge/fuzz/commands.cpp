// Any frames of commands and batches from an admitted peer. The servo's ring gets only whole groups of
// messages, every command that a role restricts is marked, and all else ends the peer with a reason. The
// first byte is the role; each frame has a control byte (batch or commands, whether the ring has room) and
// two of length.

#include "../../fuzz/pieces.hpp"
#include "fake_claim.hpp"

using namespace knurl;
using namespace knurl::bridge;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    fuzz::FakeClaim claim;
    claim.channel->render = data[0] & 1;
    const Role role = claim.channel->render ? Role::render : Role::control;
    std::uint64_t sent = 0;
    fuzz::Pieces frames({data + 1, size - 1});
    for (fuzz::Pieces::Piece frame; frames.next(frame);) {
        const bool is_batch = frame.control & 1;
        claim.channel->full = frame.control & 2;
        const char* why = "";
        const bool good =
            is_batch ? claim.stream.batch(frame.bytes, why) : claim.stream.commands(frame.bytes, role, why);
        if (!good) {
            fuzz::require(*why != '\0');
            return 0;  // the peer is closed
        }
        if (!is_batch) sent += frame.bytes.size() / knurl::shm::cell_bytes;
        fuzz::require(claim.channel->cells <= sent);
    }
    return 0;
}
