#pragma once
// Datagrams sealed with ChaCha20-Poly1305 (RFC 8439). The nonce is the datagram's counter; the header is
// associated data (readable, not changeable). Nothing here allocates after construction.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <knurl/bridge/keys.hpp>

namespace knurl::bridge {

inline constexpr std::size_t tag_bytes = 16;

class Sealer {
  public:
    explicit Sealer(const std::array<std::byte, key_bytes>& key);
    ~Sealer();
    Sealer(Sealer&&) noexcept;
    Sealer& operator=(Sealer&&) noexcept;

    /// room[0, header) stays readable, room[header, bytes) is encrypted in place, and the tag is appended.
    /// Returns the length with the tag; 0: no room for the tag, or `counter` is not above the last one (a
    /// nonce is never used twice).
    std::size_t seal(std::uint64_t counter, std::span<std::byte> room, std::size_t header,
                     std::size_t bytes) noexcept;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

class Opener {
  public:
    explicit Opener(const std::array<std::byte, key_bytes>& key);
    ~Opener();
    Opener(Opener&&) noexcept;
    Opener& operator=(Opener&&) noexcept;

    /// Decrypts datagram[header, size - tag) in place. True: every bit is the peer's; its length is now
    /// datagram.size() - tag_bytes. False: forged, damaged or too short, and its content must not be used.
    bool open(std::uint64_t counter, std::span<std::byte> datagram, std::size_t header) noexcept;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::bridge
