#pragma once
// The running firmware's packets, 16 bytes each way:
//   '<', twelve bytes of 0x41 + nibble (three int16, least significant nibble first), 0x41 + info, 0x41, '>'.
// The facts are as published with libnifalcon; nothing was tried on a device.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace knurl::drivers::falcon {

inline constexpr std::size_t message_bytes = 16;

/// To the device. Bits of info.
inline constexpr std::uint8_t info_homing = 0x01, info_green = 0x02, info_blue = 0x04, info_red = 0x08;

struct Command {
    std::array<std::int16_t, 3> motors = {};
    std::uint8_t info = 0;
};

/// From the device.
struct State {
    std::array<std::int16_t, 3> encoders = {};
    std::uint8_t buttons = 0;  // bits 0-3: plus, forward, centre, minus
    std::uint8_t homed = 0;    // bits 0-2, one per leg
};

inline constexpr std::uint8_t all_homed = 7;

inline void encode(const Command& command, std::span<std::uint8_t, message_bytes> bytes) noexcept {
    constexpr std::uint8_t base = 0x41;
    bytes[0] = '<';
    for (std::size_t i = 0; i < 12; ++i) {
        const auto word = static_cast<std::uint16_t>(command.motors[i / 4]);
        bytes[1 + i] = static_cast<std::uint8_t>(base + (word >> (4 * (i % 4)) & 0xf));
    }
    bytes[13] = static_cast<std::uint8_t>(base + command.info);
    bytes[14] = base;
    bytes[15] = '>';
}

/// Nothing: not a message.
inline std::optional<State> decode(std::span<const std::uint8_t, message_bytes> bytes) noexcept {
    constexpr int base = 0x41;
    if (bytes[0] != '<' || bytes[15] != '>') return {};
    State state;
    for (std::size_t i = 0; i < 12; ++i) {
        const int nibble = bytes[1 + i] - base;
        if (nibble < 0 || nibble > 0xf) return {};
        state.encoders[i / 4] = static_cast<std::int16_t>(static_cast<std::uint16_t>(state.encoders[i / 4]) |
                                                          nibble << (4 * (i % 4)));
    }
    const int info = bytes[13] - base;
    if (info < 0 || info > 0x7f) return {};
    state.buttons = static_cast<std::uint8_t>(info & 0xf);
    state.homed = static_cast<std::uint8_t>(info >> 4 & 7);
    return state;
}

/// Finds messages in a stream of bytes with gaps and errors.
class Reader {
  public:
    /// Calls `found(State)` for each message completed by these bytes. Returns whether any byte was garbage.
    template <class Found>
    bool add(std::span<const std::uint8_t> bytes, Found&& found) noexcept {
        bool garbage = false;
        for (const std::uint8_t byte : bytes) {
            message_[length_++] = byte;
            if (message_[0] != '<') {
                garbage = true;
                length_ = 0;
                continue;
            }
            if (length_ < message_bytes) continue;
            if (const auto state = decode(message_)) {
                found(*state);
                length_ = 0;
            } else {
                garbage = true;
                restart();
            }
        }
        return garbage;
    }
    void clear() noexcept { length_ = 0; }

  private:
    /// The message may have begun later than assumed.
    void restart() noexcept {
        std::size_t from = 1;
        while (from < message_bytes && message_[from] != '<') ++from;
        length_ = 0;
        for (; from < message_bytes; ++from) message_[length_++] = message_[from];
    }

    std::array<std::uint8_t, message_bytes> message_ = {};
    std::size_t length_ = 0;
};

}  // namespace knurl::drivers::falcon
