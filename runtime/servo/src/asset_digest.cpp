#include <nettle/sha2.h>

#include <knurl/servo/asset_digest.hpp>

namespace knurl::servo {

protocol::AssetDigest digest_of(std::span<const std::byte> source) noexcept {
    protocol::AssetDigest digest;
    static_assert(sizeof digest == SHA256_DIGEST_SIZE);
    sha256_ctx state;
    sha256_init(&state);
    sha256_update(&state, source.size(), reinterpret_cast<const std::uint8_t*>(source.data()));
    sha256_digest(&state, digest.size(), digest.data());
    return digest;
}

}  // namespace knurl::servo
