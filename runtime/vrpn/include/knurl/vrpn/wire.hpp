#pragma once

/// @file
/// VRPN 07 on the wire: how messages lie in a stream or a datagram. Pure functions: they know no socket and no clock, and
/// believe nothing that a peer says of its own lengths.
///
/// A message is a header of six big-endian 32-bit words (length, seconds, microseconds, sender, type, sequence), then the
/// payload, then zeros up to a multiple of 8. `length` counts header and payload without the zeros.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace knurl::vrpn {

/// Bytes of a message's header.
inline constexpr std::size_t header_bytes = 24;
/// Most bytes of a payload.
inline constexpr std::size_t most_payload = 64000;
/// Most bytes of a datagram.
inline constexpr std::size_t most_datagram = 1472;
/// Most bytes of a sender's or type's name, without the zero.
inline constexpr std::size_t most_name = 100;
/// Ids are 0 to one less than this.
inline constexpr std::int32_t most_ids = 2000;
/// Bytes of the cookie with which a connection begins, at both ends.
inline constexpr std::size_t cookie_bytes = 24;

/// Types of messages about the connection itself.
namespace system_type {
/// A sender's name.
inline constexpr std::int32_t sender = -1;
/// A type's name.
inline constexpr std::int32_t type = -2;
/// The port to which datagrams may be sent.
inline constexpr std::int32_t udp = -3;
/// A request to write a log file.
inline constexpr std::int32_t log = -4;
/// Stands in log files alone.
inline constexpr std::int32_t disconnect = -5;
}  // namespace system_type

/// What stands before each payload.
struct Header {
    /// Wall clock of the sender: whole seconds.
    std::int32_t seconds = 0;
    /// Wall clock of the sender: microseconds.
    std::int32_t microseconds = 0;
    /// Id of the sender, in the table of who sends.
    std::int32_t sender = 0;
    /// Id of the type, in the table of who sends; negative: see system_type.
    std::int32_t type = 0;
    /// Counts per connection and transport.
    std::uint32_t sequence = 0;
};

/// A message. The payload lies in the bytes that were split.
struct Message {
    /// The header.
    Header header;
    /// Its payload, without the zeros after it.
    std::span<const std::byte> payload;
};

/// What split() found.
enum class Split {
    /// A message, and it is taken from the bytes.
    whole,
    /// The bytes end before the message does.
    more,
    /// No end can be found: the length is impossible.
    bad,
};
/// Takes the first message from `bytes`. It never reads beyond them, and each `whole` takes 24 bytes or more.
Split split(std::span<const std::byte>& bytes, Message& message) noexcept;

/// Appends a message: header, payload, zeros.
void append(std::vector<std::byte>& bytes, const Header& header, std::span<const std::byte> payload);

/// What a cookie says.
struct Cookie {
    /// It is none of VRPN's, or of another version: why, in one line.
    std::string refused;
};
/// The cookie that this end sends.
std::array<std::byte, cookie_bytes> cookie() noexcept;
/// Looks at the peer's.
Cookie read_cookie(std::span<const std::byte, cookie_bytes> bytes);

/// Where a client listens that asks to be connected to: the port of "127.0.0.1 55311". The address in it is not believed.
/// None: it is no such request.
std::optional<std::uint16_t> requested_port(std::span<const std::byte> datagram) noexcept;

/// The bytes of a number, the most significant one first.
template <class Bits>
std::array<std::byte, sizeof(Bits)> big_endian(Bits bits) noexcept {
    std::array<std::byte, sizeof(Bits)> bytes;
    for (std::size_t i = 0; i < sizeof(Bits); ++i)
        bytes[i] = static_cast<std::byte>(bits >> (8 * (sizeof(Bits) - 1 - i)) & 0xff);
    return bytes;
}

/// Reads the numbers of a payload. Once one is missing, `ok` is false, and everything is 0.
class Payload {
  public:
    /// Reads `bytes`, which must outlive it.
    explicit Payload(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}
    /// The next number: of 16, 32 or 64 bits, integer or floating point.
    template <class T>
    T take() noexcept {
        using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t,
                                        std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint16_t>>;
        static_assert(sizeof(Bits) == sizeof(T));
        if (rest_.size() < sizeof(T)) {
            ok_ = false;
            rest_ = {};
            return T{};
        }
        Bits bits = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i)
            bits = static_cast<Bits>(bits << 8 | std::to_integer<Bits>(rest_[i]));
        rest_ = rest_.subspan(sizeof(T));
        return std::bit_cast<T>(bits);
    }
    /// Nothing was missing so far.
    bool ok() const noexcept { return ok_; }
    /// Nothing was missing, and nothing is left.
    bool complete() const noexcept { return ok_ && rest_.empty(); }
    /// What is left.
    std::span<const std::byte> rest() const noexcept { return rest_; }

  private:
    std::span<const std::byte> rest_;
    bool ok_ = true;
};

/// Writes the numbers of a payload.
class PayloadWriter {
  public:
    /// Appends a number.
    template <class T>
    PayloadWriter& put(T value) {
        using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t,
                                        std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint16_t>>;
        const Bits bits = std::bit_cast<Bits>(value);
        std::array<std::byte, sizeof(T)> big;
        for (std::size_t i = 0; i < sizeof(T); ++i)
            big[sizeof(T) - 1 - i] = static_cast<std::byte>(bits >> (8 * i) & 0xff);
        bytes_.insert(bytes_.end(), big.begin(), big.end());
        return *this;
    }
    /// Appends a text in a field of `room` bytes: cut to fit, and always with a zero after it.
    PayloadWriter& put_text(std::string_view text, std::size_t room);
    /// Forgets what was written, and keeps the memory.
    void clear() noexcept { bytes_.clear(); }
    /// What was written.
    std::span<const std::byte> bytes() const noexcept { return bytes_; }

  private:
    std::vector<std::byte> bytes_;
};

/// A name in a message of type system_type::sender or system_type::type. None: it is longer than the payload or
/// than most_name, or it is not text.
std::optional<std::string> described_name(std::span<const std::byte> payload);
/// The payload that describes a name.
void put_name(PayloadWriter& payload, std::string_view name);

}  // namespace knurl::vrpn
