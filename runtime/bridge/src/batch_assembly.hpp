#pragma once
// The servo's end of the data channel: assembles a batch from its datagrams. Only the newest batch counts. A
// sequence that was complete once is never returned again, so a repeated datagram does not renew a claim.

#include <array>
#include <cstring>
#include <span>

#include "wire.hpp"

namespace knurl::bridge {

class BatchAssembly {
  public:
    /// The whole batch (BatchHeader + entries) if this was its last piece, valid until the next call; else
    /// empty. Accepts any bytes.
    std::span<const std::byte> add(const DatagramHeader& header, const BatchPiece& piece,
                                   std::span<const std::byte> bytes) noexcept {
        if (piece.sequence <= done_ || piece.sequence < sequence_) return {};
        if (header.pieces == 0 || header.pieces > max_pieces || header.piece >= header.pieces) return {};
        if (piece.total > buffer_.size() || piece.offset > piece.total ||
            bytes.size() > piece.total - piece.offset)
            return {};
        // When the path has become narrower, a repeated batch may come in other pieces.
        if (piece.sequence != sequence_ || header.pieces != pieces_ || piece.total != total_) {
            sequence_ = piece.sequence;
            pieces_ = header.pieces;
            total_ = piece.total;
            here_ = 0;
            filled_ = 0;
        }
        const unsigned bit = 1u << header.piece;
        if ((here_ & bit) != 0) return {};
        here_ |= bit;
        filled_ += bytes.size();
        if (!bytes.empty()) std::memcpy(buffer_.data() + piece.offset, bytes.data(), bytes.size());
        if (here_ != (1u << pieces_) - 1 || filled_ != total_) return {};
        done_ = sequence_;
        return {buffer_.data(), total_};
    }

    /// A batch that came as a whole, by TCP. False: it is not newer.
    bool whole(std::uint64_t sequence) noexcept {
        if (sequence <= done_) return false;
        done_ = sequence;
        return true;
    }

  private:
    std::uint64_t done_ = 0, sequence_ = 0;
    unsigned pieces_ = 0, here_ = 0;
    std::size_t total_ = 0, filled_ = 0;
    std::array<std::byte, max_pieces * datagram_bytes> buffer_{};
};

}  // namespace knurl::bridge
