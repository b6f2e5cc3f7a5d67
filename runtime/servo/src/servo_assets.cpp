// Assets that claims receive and return.

#include <bit>

#include "servo_impl.hpp"

namespace knurl::servo {

// By address, as in all messages: the claim may be on its way back already, and then frees the asset.
void Servo::Impl::take_asset(const Message& message) noexcept {
    const std::size_t place = claims.find(message.claim);
    if (place == claims.size()) return;
    Claim::Impl& c = claims[place];
    claims.wake(place);
    if (message.what == Message::What::forget) {
        c.forgotten |= std::uint64_t{1} << (message.number - 1);
        if (input_log != nullptr)
            input_log->put(InputType::asset_forgotten,
                           {as_bytes(c.number), as_bytes(std::uint64_t{message.number})});
        return;
    }
    c.assets[message.number - 1] = message.asset;
    c.scene.set_asset(message.number, message.asset);
    if (scene_log != nullptr) c.unshown.claim();
    if (input_log != nullptr)
        input_log->put(InputType::asset, {as_bytes(c.number), as_bytes(std::uint64_t{message.number}),
                                          as_bytes(message.digest)});
}

/// Returns assets that no shape uses any more.
void Servo::Impl::return_assets(Claim& claim) noexcept {
    Claim::Impl& c = *claim.impl;
    for (std::uint64_t rest = c.forgotten; rest != 0; rest &= rest - 1) {
        const auto index = static_cast<std::uint32_t>(std::countr_zero(rest));
        const Asset* asset = c.assets[index];
        if (asset != nullptr && c.scene.refers_to(*asset)) continue;
        if (!asset_outbox.post({.claim = &claim, .number = index + 1})) continue;
        c.scene.set_asset(index + 1, nullptr);
        c.assets[index] = nullptr;
        if (scene_log != nullptr) c.unshown.claim();
        c.forgotten &= ~(std::uint64_t{1} << index);
    }
}

bool Servo::give(Claim* claim, std::uint32_t number, const Asset* asset,
                 const protocol::AssetDigest& digest) noexcept {
    return impl_->inbox.post(
        {.what = Message::What::asset, .claim = claim, .asset = asset, .number = number, .digest = digest});
}
bool Servo::forget(Claim* claim, std::uint32_t number) noexcept {
    return impl_->inbox.post({.what = Message::What::forget, .claim = claim, .number = number});
}
std::optional<ReturnedAsset> Servo::returned() noexcept {
    ReturnedAsset asset;
    return impl_->asset_outbox.take(asset) ? std::optional(asset) : std::nullopt;
}
}  // namespace knurl::servo
