#pragma once
// The messages of callers to the broker, as bytes. Nothing in them is used before length and magic are
// checked.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include <fmt/format.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/servo/claim_table.hpp>

namespace knurl::servo {

/// Large enough for every message of a client, plus one byte that shows a longer message.
using Buffer = std::array<std::byte, std::max({sizeof(protocol::Hello), sizeof(protocol::ClaimRequest),
                                               sizeof(protocol::Release), sizeof(protocol::Mapped),
                                               sizeof(protocol::RecordRequest),
                                               sizeof(protocol::WatchRequest), sizeof(protocol::ShowAsset),
                                               sizeof(protocol::AssetOffer), sizeof(protocol::AssetForget)}) +
                                         1>;

template <class Message>
Message read_message(const Buffer& buffer, std::size_t bytes, const char* what) {
    if (bytes != sizeof(Message)) {
        throw RequestRefused(fmt::format("{}: {} bytes instead of {}; build client and servo alike", what,
                                         bytes, sizeof(Message)));
    }
    Message message;
    std::memcpy(static_cast<void*>(&message), buffer.data(), sizeof message);
    return message;
}

/// The type as an integer: loading an enum with an invalid value would be undefined behaviour.
inline std::optional<std::uint32_t> type_of(const Buffer& buffer, std::size_t bytes) {
    std::array<std::uint32_t, 2> header{};
    static_assert(sizeof header == sizeof(protocol::MessageHeader));
    if (bytes < sizeof header) return std::nullopt;
    std::memcpy(header.data(), buffer.data(), sizeof header);
    return header[0] == protocol::attach_magic ? std::optional(header[1]) : std::nullopt;
}

template <class Message>
std::span<const std::byte> bytes_of(const Message& message) {
    return std::as_bytes(std::span(&message, 1));
}

}  // namespace knurl::servo
