#include <knurl/bridge/wire_sizes.hpp>

#include "frame_stream.hpp"
#include "seal.hpp"
#include "wire.hpp"

namespace knurl::bridge {

WireSizes wire_sizes(bool encrypted) noexcept {
    constexpr std::size_t tls_record = 5 + 1 + 16;  // header, type, tag: RFC 8446, 5.2
    static_assert(sizeof(protocol::CommandHeader) <= shm::cell_bytes &&
                  sizeof(protocol::Reply) == shm::cell_bytes);
    return {.datagram = sizeof(DatagramHeader) + sizeof(ReportPiece) + sizeof(Report) +
                        sizeof(protocol::FeedbackHeader) + sizeof(protocol::FeedbackEntry) +
                        (encrypted ? tag_bytes : 0),
            .command = sizeof(FrameHeader) + shm::cell_bytes + (encrypted ? tls_record : 0)};
}

}  // namespace knurl::bridge
