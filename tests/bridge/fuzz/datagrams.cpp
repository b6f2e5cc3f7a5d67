// Any datagrams at both ends of the data channel. The first byte says whether there is a key; then follow
// datagrams, each with a control byte and two of length. With a key nothing from a stranger is accepted.
// Without one it may be, and then the servo gets only whole batches within the claim's bounds.

#include <array>

#include "../../fuzz/pieces.hpp"
#include "datagram_channel.hpp"
#include "fake_claim.hpp"
#include "feedback_assembly.hpp"

using namespace knurl;
using namespace knurl::bridge;

namespace {

constexpr std::uint64_t session = 0x123456789abcdef0;
// What the control byte corrects, so that random input passes the first checks.
constexpr unsigned right_session = 1, next_counter = 2, is_batch = 4, is_report = 8;

/// Parses it like the client's end.
void to_feedback(FeedbackAssembly& assembly, const DatagramHeader& header, std::span<const std::byte> body) {
    ReportPiece piece;
    if (!take(body, piece)) return;
    knurl::Report report;
    knurl::protocol::FeedbackHeader feedback;
    if ((piece.flags & piece_flags::report) != 0 && !take(body, report)) return;
    if ((piece.flags & piece_flags::feedback) != 0) {
        if (!take(body, feedback)) return;
        assembly.header(feedback, piece.answers);
    }
    if ((piece.flags & piece_flags::entries) != 0) assembly.piece(header, piece, body);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    constexpr std::array<std::byte, key_bytes> key{};
    const bool sealed = data[0] & 1;
    IncomingDatagrams incoming(session, sealed ? &key : nullptr);
    std::array<CounterWindow, max_streams + 1> windows{};
    fuzz::FakeClaim claim;
    FeedbackAssembly feedback(16);
    std::vector<knurl::protocol::FeedbackEntry> entries;
    std::uint64_t counter = 0;

    fuzz::Pieces datagrams({data + 1, size - 1});
    for (fuzz::Pieces::Piece next; datagrams.next(next);) {
        const unsigned control = next.control;
        std::vector<std::byte>& datagram = next.bytes;
        if (datagram.size() >= sizeof(DatagramHeader)) {
            DatagramHeader header;
            std::memcpy(&header, datagram.data(), sizeof header);
            if (control & right_session) header.session = session;
            if (control & next_counter) header.counter = ++counter;
            if (control & is_batch) header.kind = DatagramKind::batch, header.stream = 1;
            if (control & is_report) header.kind = DatagramKind::report, header.stream = 1;
            std::memcpy(datagram.data(), &header, sizeof header);
        }
        std::vector<std::byte> again = datagram;
        const IncomingDatagrams::Opened opened = incoming.open(datagram, windows);
        if (opened.verdict != IncomingDatagrams::Verdict::good) continue;
        fuzz::require(!sealed);
        fuzz::require(incoming.open(again, windows).verdict !=
                      IncomingDatagrams::Verdict::good);  // once only
        if (opened.header.kind == DatagramKind::batch) claim.stream.batch_piece(opened.header, opened.body);
        if (opened.header.kind == DatagramKind::report) {
            to_feedback(feedback, opened.header, opened.body);
            knurl::protocol::FeedbackHeader header;
            if (feedback.take(counter, header, entries))
                fuzz::require(header.entries == entries.size() && entries.size() <= 16);
        }
    }
    return 0;
}
