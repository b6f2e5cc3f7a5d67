// Any chunks as a PNG, with the lengths, checksums and packed rows that libpng demands before it looks any
// further. They are refused in one line, or become finite heights. Five bytes are the header. A piece
// (fuzz/pieces.hpp) is a chunk; its control byte has its type, and which parts are made valid.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include <zlib.h>

#include "../../fuzz/pieces.hpp"
#include "check_heights.hpp"

namespace {

constexpr std::string_view types[] = {"IDAT", "tEXt", "tRNS", "zTXt", "gAMA", "iTXt", "abCd", "IEND"};
constexpr unsigned type_mask = 7, rows = 8, wrong_checksum = 16, key_of_ours = 32, of_cells = 64;

/// Big-endian, as PNG has it.
std::string four(std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
}

std::string chunk(std::string_view type, const std::string& content, bool wrong = false) {
    const std::string checked = std::string(type) + content;
    const auto crc = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size()));
    return four(static_cast<std::uint32_t>(content.size())) + checked + four(wrong ? crc + 1 : crc);
}

std::string packed(const std::string& plain) {
    std::string bytes(compressBound(plain.size()), '\0');
    uLongf size = bytes.size();
    compress2(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
              plain.size(), 1);
    bytes.resize(size);
    return bytes;
}

/// All rows of 16-bit samples, each after its filter byte; the bytes are repeated as often as needed.
std::string rows_of(std::string_view bytes, std::size_t columns, std::size_t count) {
    std::string plain;
    std::size_t next = 0;
    const auto take = [&] { return bytes.empty() ? '\0' : bytes[next++ % bytes.size()]; };
    for (std::size_t row = 0; row < count; ++row) {
        plain += static_cast<char>(take() % 5);
        for (std::size_t i = 0; i < 2 * columns; ++i) plain += take();
    }
    return packed(plain);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 5) return 0;
    const std::size_t columns = data[0] % 40u, count = data[1] % 40u;
    // Mostly the form that can be read: 16 bits, grey, not interlaced.
    std::string header = four(static_cast<std::uint32_t>(columns)) + four(static_cast<std::uint32_t>(count));
    header += static_cast<char>(data[2] < 200 ? 16 : data[2] % 33);
    header += static_cast<char>(data[3] < 200 ? 0 : data[3] % 7);
    header += std::string(2, '\0') + static_cast<char>(data[4] < 128 ? 0 : data[4] % 3);
    std::string bytes = "\x89PNG\r\n\x1a\n" + chunk("IHDR", header);
    knurl::fuzz::Pieces pieces({data + 5, size - 5});
    for (knurl::fuzz::Pieces::Piece piece; pieces.next(piece);) {
        const std::string_view type = types[piece.control & type_mask];
        std::string content(reinterpret_cast<const char*>(piece.bytes.data()), piece.bytes.size());
        if (type == "IDAT" && (piece.control & rows) != 0) content = rows_of(content, columns, count);
        if ((piece.control & key_of_ours) != 0) {
            const std::string key((piece.control & of_cells) != 0 ? surface::key_metres_per_cell
                                                                  : surface::key_metres_per_count);
            content = key + '\0' + (type == "zTXt" ? '\0' + packed(content) : content);
        }
        bytes += chunk(type, content, (piece.control & wrong_checksum) != 0);
    }
    bytes += chunk("IEND", "");
    bytes.shrink_to_fit();
    knurl::fuzz::check_heights(bytes);
    return 0;
}
