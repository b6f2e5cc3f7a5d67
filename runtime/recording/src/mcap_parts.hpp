#pragma once
// Shared by writer and reader of MCAP.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include <zlib.h>

namespace knurl::recording::mcap {

inline constexpr std::string_view magic = "\x89MCAP0\r\n";

enum class Op : std::uint8_t {
    header = 1,
    footer,
    schema,
    channel,
    message,
    chunk,
    message_index,
    chunk_index,
    attachment,
    attachment_index,
    statistics,
    metadata,
    metadata_index,
    data_end = 0x0f,
};
inline constexpr std::size_t record_head = 9;  // op, length

inline std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Little-endian, as on this machine.
template <class T>
void put(std::string& to, T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    to.append(bytes, sizeof bytes);
}

inline std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) {
    return static_cast<std::uint32_t>(
        crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace knurl::recording::mcap
