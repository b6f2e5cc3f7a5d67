#include "seal.hpp"

#include <nettle/chacha-poly1305.h>
#include <nettle/memops.h>

// Uses Nettle, not OpenSSL's EVP, which seals TLS records. A datagram is sealed once a millisecond by a
// thread that has slept meanwhile. So the cost is how much code and how many tables have left the caches.

namespace knurl::bridge {

namespace {

static_assert(key_bytes == CHACHA_POLY1305_KEY_SIZE && tag_bytes == CHACHA_POLY1305_DIGEST_SIZE);

std::uint8_t* bytes_of(std::byte* p) noexcept {
    return reinterpret_cast<std::uint8_t*>(p);
}

/// The key is set once; each message sets only its nonce.
chacha_poly1305_ctx make_cipher(const std::array<std::byte, key_bytes>& key) noexcept {
    chacha_poly1305_ctx cipher;
    chacha_poly1305_set_key(&cipher, reinterpret_cast<const std::uint8_t*>(key.data()));
    return cipher;
}

/// Sets the nonce, then the associated data. RFC 8439, 2.8: 96 bits, here 32 zeros and the counter, which is
/// used once per key.
void begin(chacha_poly1305_ctx& cipher, std::uint64_t counter, std::byte* header,
           std::size_t bytes) noexcept {
    std::array<std::uint8_t, CHACHA_POLY1305_NONCE_SIZE> nonce{};
    for (std::size_t i = 0; i < 8; ++i) nonce[4 + i] = static_cast<std::uint8_t>(counter >> (8 * i));
    chacha_poly1305_set_nonce(&cipher, nonce.data());
    chacha_poly1305_update(&cipher, bytes, bytes_of(header));
}

constexpr std::size_t max_datagram = 65536;

}  // namespace

struct Sealer::Impl {
    chacha_poly1305_ctx cipher;
    std::uint64_t last = 0;
};

Sealer::Sealer(const std::array<std::byte, key_bytes>& key)
    : impl_(std::make_unique<Impl>(Impl{.cipher = make_cipher(key)})) {}
Sealer::~Sealer() = default;
Sealer::Sealer(Sealer&&) noexcept = default;
Sealer& Sealer::operator=(Sealer&&) noexcept = default;

std::size_t Sealer::seal(std::uint64_t counter, std::span<std::byte> room, std::size_t header,
                         std::size_t bytes) noexcept {
    if (counter <= impl_->last || header > bytes || bytes > max_datagram || room.size() < bytes + tag_bytes)
        return 0;
    impl_->last = counter;
    std::uint8_t* const text = bytes_of(room.data() + header);
    begin(impl_->cipher, counter, room.data(), header);
    chacha_poly1305_encrypt(&impl_->cipher, bytes - header, text, text);
    chacha_poly1305_digest(&impl_->cipher, tag_bytes, bytes_of(room.data() + bytes));
    return bytes + tag_bytes;
}

struct Opener::Impl {
    chacha_poly1305_ctx cipher;
};

Opener::Opener(const std::array<std::byte, key_bytes>& key)
    : impl_(std::make_unique<Impl>(Impl{.cipher = make_cipher(key)})) {}
Opener::~Opener() = default;
Opener::Opener(Opener&&) noexcept = default;
Opener& Opener::operator=(Opener&&) noexcept = default;

bool Opener::open(std::uint64_t counter, std::span<std::byte> datagram, std::size_t header) noexcept {
    if (datagram.size() > max_datagram + tag_bytes || datagram.size() < tag_bytes ||
        header > datagram.size() - tag_bytes)
        return false;
    const std::size_t end = datagram.size() - tag_bytes;
    std::uint8_t* const text = bytes_of(datagram.data() + header);
    std::array<std::uint8_t, tag_bytes> tag{};
    begin(impl_->cipher, counter, datagram.data(), header);
    chacha_poly1305_decrypt(&impl_->cipher, end - header, text, text);
    chacha_poly1305_digest(&impl_->cipher, tag_bytes, tag.data());
    return memeql_sec(tag.data(), datagram.data() + end, tag_bytes) != 0;
}

}  // namespace knurl::bridge
