#include "seal.hpp"

#include <new>
#include <stdexcept>

#include <openssl/evp.h>

namespace knurl::bridge {

namespace {

struct FreeCipher {
    void operator()(EVP_CIPHER_CTX* context) const noexcept { EVP_CIPHER_CTX_free(context); }
};
using Cipher = std::unique_ptr<EVP_CIPHER_CTX, FreeCipher>;

unsigned char* bytes_of(std::byte* p) noexcept {
    return reinterpret_cast<unsigned char*>(p);
}

/// The key is set once; a message sets its nonce only.
Cipher make_cipher(const std::array<std::byte, key_bytes>& key, bool encrypt) {
    Cipher cipher(EVP_CIPHER_CTX_new());
    if (!cipher) throw std::bad_alloc();
    if (EVP_CipherInit_ex(cipher.get(), EVP_chacha20_poly1305(), nullptr,
                          reinterpret_cast<const unsigned char*>(key.data()), nullptr, encrypt ? 1 : 0) != 1)
        throw std::runtime_error("this OpenSSL has no ChaCha20-Poly1305, which the bridge's datagrams need");
    return cipher;
}

/// RFC 8439, 2.8: 96 bits; ours are 32 zeros and the counter, which a key sees once.
std::array<unsigned char, 12> nonce_of(std::uint64_t counter) noexcept {
    std::array<unsigned char, 12> nonce{};
    for (std::size_t i = 0; i < 8; ++i) nonce[4 + i] = static_cast<unsigned char>(counter >> (8 * i));
    return nonce;
}

/// Nonce, associated data, then text[0, bytes) in place.
bool run(EVP_CIPHER_CTX* cipher, std::uint64_t counter, std::byte* datagram, std::size_t header,
         std::size_t text) noexcept {
    int length = 0;
    return EVP_CipherInit_ex(cipher, nullptr, nullptr, nullptr, nonce_of(counter).data(), -1) == 1 &&
           EVP_CipherUpdate(cipher, nullptr, &length, bytes_of(datagram), static_cast<int>(header)) == 1 &&
           (text == 0 || EVP_CipherUpdate(cipher, bytes_of(datagram + header), &length,
                                          bytes_of(datagram + header), static_cast<int>(text)) == 1);
}

constexpr std::size_t max_datagram = 65536;

}  // namespace

struct Sealer::Impl {
    Cipher cipher;
    std::uint64_t last = 0;
};

Sealer::Sealer(const std::array<std::byte, key_bytes>& key)
    : impl_(std::make_unique<Impl>(Impl{.cipher = make_cipher(key, true)})) {}
Sealer::~Sealer() = default;
Sealer::Sealer(Sealer&&) noexcept = default;
Sealer& Sealer::operator=(Sealer&&) noexcept = default;

std::size_t Sealer::seal(std::uint64_t counter, std::span<std::byte> room, std::size_t header,
                         std::size_t bytes) noexcept {
    if (counter <= impl_->last || header > bytes || bytes > max_datagram || room.size() < bytes + tag_bytes)
        return 0;
    impl_->last = counter;
    EVP_CIPHER_CTX* cipher = impl_->cipher.get();
    int length = 0;
    std::byte* end = room.data() + bytes;
    if (!run(cipher, counter, room.data(), header, bytes - header) ||
        EVP_CipherFinal_ex(cipher, bytes_of(end), &length) != 1 ||
        EVP_CIPHER_CTX_ctrl(cipher, EVP_CTRL_AEAD_GET_TAG, tag_bytes, end) != 1)
        return 0;
    return bytes + tag_bytes;
}

struct Opener::Impl {
    Cipher cipher;
};

Opener::Opener(const std::array<std::byte, key_bytes>& key)
    : impl_(std::make_unique<Impl>(Impl{.cipher = make_cipher(key, false)})) {}
Opener::~Opener() = default;
Opener::Opener(Opener&&) noexcept = default;
Opener& Opener::operator=(Opener&&) noexcept = default;

bool Opener::open(std::uint64_t counter, std::span<std::byte> datagram, std::size_t header) noexcept {
    if (datagram.size() > max_datagram + tag_bytes || datagram.size() < tag_bytes ||
        header > datagram.size() - tag_bytes)
        return false;
    const std::size_t end = datagram.size() - tag_bytes;
    EVP_CIPHER_CTX* cipher = impl_->cipher.get();
    unsigned char nothing[tag_bytes];
    int length = 0;
    return run(cipher, counter, datagram.data(), header, end - header) &&
           EVP_CIPHER_CTX_ctrl(cipher, EVP_CTRL_AEAD_SET_TAG, tag_bytes, datagram.data() + end) == 1 &&
           EVP_CipherFinal_ex(cipher, nothing, &length) == 1;
}

}  // namespace knurl::bridge
