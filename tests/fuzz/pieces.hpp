#pragma once
// Splits an input into pieces: each has a control byte, two bytes of length (little-endian), and its bytes.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace knurl::fuzz {

class Pieces {
  public:
    explicit Pieces(std::span<const std::uint8_t> input) : rest_(input) {}

    struct Piece {
        unsigned control = 0;
        std::vector<std::byte> bytes;  // an exact copy, so that reading past its end is detected
    };
    /// The last piece may be shorter than its length states. False: no piece is left.
    bool next(Piece& piece) {
        if (rest_.size() < 3) return false;
        piece.control = rest_[0];
        const std::size_t length = std::min<std::size_t>(rest_[1] | rest_[2] << 8, rest_.size() - 3);
        piece.bytes = std::vector<std::byte>(length);
        if (length > 0) std::memcpy(piece.bytes.data(), rest_.data() + 3, length);
        rest_ = rest_.subspan(3 + length);
        return true;
    }

  private:
    std::span<const std::uint8_t> rest_;
};

}  // namespace knurl::fuzz
