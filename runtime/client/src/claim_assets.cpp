// The assets that a claim has sent, kept in the form in which they were sent, for a restarted servo.

#include <cstring>

#include <fcntl.h>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/shm/deadline.hpp>

#include "claim_state.hpp"
#include "sending_state.hpp"

namespace knurl::detail {

namespace {

/// After a restart: the time to build the asset, and to carry it over a network of 10 Mbit/s.
std::chrono::nanoseconds rebuild_time(std::uint64_t bytes) {
    return std::chrono::seconds(60) + std::chrono::microseconds(bytes);
}

SentShape told(const protocol::AssetReady& ready) {
    return {.asset = ready.number,
            .faces = ready.faces,
            .bytes = ready.bytes,
            .low = {ready.low[0], ready.low[1], ready.low[2]},
            .high = {ready.high[0], ready.high[1], ready.high[2]},
            .notes = ready.notes};
}

}  // namespace

std::pair<std::uint32_t, std::unique_ptr<AssetTransfer>> ClaimState::begin_sending(AssetMemory source) {
    const Lock lock = enter();
    if (channel() == nullptr) throw_disconnected();
    std::uint32_t number = 1;
    while (number <= max_assets && assets_.contains(number)) ++number;
    if (number > max_assets)
        throw Error(Error::Kind::bad_parameters,
                    detail::format("send: a claim has up to {} shapes; forget one first", max_assets));
    auto transfer = attachment_->assets->offer(number, source.memory, source.bytes);
    assets_[number] = {.source = std::move(source), .there = false, .sent_to = attachments()};
    return {number, std::move(transfer)};
}

bool ClaimState::sent(std::uint32_t number, bool there) noexcept {
    const Lock lock(mutex_);
    const auto found = assets_.find(number);
    if (found == assets_.end()) return false;
    found->second.there = there && found->second.sent_to == attachments();
    if (found->second.there) return true;
    assets_.erase(found);
    return false;
}

void ClaimState::forget(std::uint32_t number) {
    const Lock lock = enter();
    require_asset(number);
    for (const RepresentationId id : table_.live())
        if (const Entry& one = *table_.find_any(id);
            one.kind == kind_of<Shape> && asset_of(one.params) == number)
            throw Error(Error::Kind::refused,
                        detail::format(
                            "forget: asset {} is what the representation in slot {} is made of; remove that "
                            "first",
                            number, id.slot));
    if (attachment_) attachment_->assets->forget(number);
    assets_.erase(number);
}

std::uint32_t ClaimState::asset_of(std::span<const std::byte> params) {
    Shape shape;
    std::memcpy(&shape, params.data(), sizeof shape);
    return shape.asset;
}

void ClaimState::require_asset(std::uint32_t number) const {
    const auto found = assets_.find(number);
    if (found != assets_.end() && found->second.there) return;
    throw Error(Error::Kind::bad_parameters,
                detail::format("asset {}: this claim has sent none of that number; send() returns the number",
                               number));
}

/// A shape must refer to an asset that was sent before.
void ClaimState::require_asset(Kind kind, const void* params) const {
    if (kind != kind_of<Shape>) return;
    const std::uint32_t number = asset_of({static_cast<const std::byte*>(params), sizeof(Shape)});
    if (number != 0) require_asset(number);
}

/// Without the lock: over a network it may take minutes, during which the application's calls must work.
void ClaimState::bring(Attachment& attachment) {
    constexpr std::chrono::milliseconds look_every{50};
    struct Kept {
        std::uint32_t number;
        shm::UniqueFd memory;
        std::uint64_t bytes;
    };
    std::vector<Kept> all;
    {
        const Lock lock(mutex_);
        for (const auto& [number, asset] : assets_)
            if (asset.there)
                all.push_back({number, shm::UniqueFd(::fcntl(asset.source.memory.get(), F_DUPFD_CLOEXEC, 0)),
                               asset.source.bytes});
    }
    for (const Kept& kept : all) {
        const auto transfer = attachment.assets->offer(kept.number, kept.memory, kept.bytes);
        const auto deadline = shm::deadline_after(rebuild_time(kept.bytes));
        while (!transfer->answer(look_every)) {
            if (!is_leaving() && std::chrono::steady_clock::now() < deadline) continue;
            throw Error(Error::Kind::refused,
                        detail::format("device '{}': the servo is back, but does not take shape {} again",
                                       device_name(), kept.number));
        }
    }
    brought_.clear();
    for (const Kept& kept : all) brought_.push_back(kept.number);
}

/// Forgets what the application has forgotten during the transfer.
void ClaimState::leave_behind(Attachment& attachment) {
    for (const std::uint32_t number : brought_)
        if (!assets_.contains(number)) attachment.assets->forget(number);
    brought_.clear();
}

SendingState::SendingState(std::shared_ptr<ClaimState> claim, std::uint32_t number,
                           std::unique_ptr<AssetTransfer> transfer)
    : claim_(std::move(claim)), number_(number), transfer_(std::move(transfer)) {}

SendingState::~SendingState() {
    if (!over_) claim_->sent(number_, false);
}

std::optional<SentShape> SendingState::done(std::chrono::nanoseconds wait) {
    if (over_) return sent_;
    try {
        const std::optional<protocol::AssetReady> ready = transfer_->answer(wait);
        if (!ready) return std::nullopt;
        sent_ = told(*ready);
    } catch (const Error&) {
        over_ = true;
        claim_->sent(number_, false);
        throw;
    }
    over_ = true;
    if (!claim_->sent(number_, true)) {
        sent_.reset();
        throw Error(Error::Kind::disconnected,
                    "send: the servo that had taken it has gone before this was asked; send it again");
    }
    return sent_;
}

}  // namespace knurl::detail
