// The assets of claims, by number, from the offer until the servo returns them.

#include <algorithm>

#include <fmt/format.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/servo/claim_table.hpp>

namespace knurl::servo {

std::uint64_t ClaimTable::asset_bytes(const Row& row) noexcept {
    std::uint64_t bytes = 0;
    for (const RowAsset& one : row.assets)
        if (one.held) bytes += one.held->asset->bytes();
    return bytes;
}

ClaimTable::Row* ClaimTable::row_of_key(std::uint64_t key) noexcept {
    const auto found = std::find_if(rows_.begin(), rows_.end(), [key](const Row& row) {
        return row.stage == Stage::held && !row.observer && row.key == key;
    });
    return found == rows_.end() ? nullptr : &*found;
}

std::uint64_t ClaimTable::expect_asset(std::uint64_t key, std::uint32_t number, std::uint64_t bytes) {
    take_back_assets();
    Row* row = row_of_key(key);
    if (row == nullptr)
        throw RequestRefused(fmt::format("asset: no claim of device \"{}\" has that key", device_.name));
    if (number < 1 || number > max_assets)
        throw RequestRefused(fmt::format("asset: number {}; give 1 to {}", number, max_assets));
    if (row->assets.empty()) row->assets.resize(max_assets);
    const RowAsset& place = row->assets[number - 1];
    if (place.stage == RowAsset::Stage::building)
        throw RequestRefused(
            fmt::format("asset: number {} is being built; wait for it, or give another number", number));
    if (place.stage != RowAsset::Stage::none)
        throw RequestRefused(
            fmt::format("asset: number {} is taken; forget it first, or give another number", number));
    const std::uint64_t held = asset_bytes(*row);
    if (bytes == 0 || bytes > protocol::max_asset_bytes || held >= protocol::max_asset_bytes)
        throw RequestRefused(
            fmt::format("asset: {} bytes, besides {} that the claim holds; a claim may hold {}", bytes, held,
                        protocol::max_asset_bytes));
    const std::uint64_t left = require_memory("asset: its source", bytes);
    row->assets[number - 1].stage = RowAsset::Stage::building;
    return std::min(protocol::max_asset_bytes - held, left);
}

void ClaimTable::expect_no_asset(std::uint64_t key, std::uint32_t number) noexcept {
    Row* row = row_of_key(key);
    // There is a place: it is expected.
    if (row != nullptr && row->assets[number - 1].stage == RowAsset::Stage::building)
        row->assets[number - 1] = {};
}

void ClaimTable::give_asset(std::uint64_t key, std::uint32_t number, std::unique_ptr<Asset> asset,
                            AssetMemory memory, const protocol::AssetDigest& digest) {
    Row* row = row_of_key(key);
    if (row == nullptr) throw RequestRefused("asset: its claim has gone");
    RowAsset& place = row->assets[number - 1];
    // Several assets that were under way at once may each have been promised the same free memory.
    const std::uint64_t held = asset_bytes(*row);
    if (held + asset->bytes() > protocol::max_asset_bytes)
        throw RequestRefused(
            fmt::format("asset: {} bytes, besides {} that the claim holds by now; a claim may hold {}",
                        asset->bytes(), held, protocol::max_asset_bytes));
    require_memory("asset: it", asset->bytes());
    auto kept = std::make_unique<HeldAsset>(HeldAsset{
        .memory = {memory_, asset->bytes()}, .block = std::move(memory), .shown = false, .asset = nullptr});
    if (!device_.servo.give(row->claim.get(), number, asset.get(), digest))
        throw RequestRefused(fmt::format("asset: the servo of \"{}\" is busy; send it again", device_.name));
    kept->asset = std::move(asset);
    place = {.stage = RowAsset::Stage::there, .held = std::move(kept)};
}

std::size_t ClaimTable::shown_assets() const noexcept {
    std::size_t shown = 0;
    for (const Row& row : rows_)
        for (const RowAsset& asset : row.assets) shown += asset.held && asset.held->shown;
    return shown;
}

const shm::Segment& ClaimTable::asset_memory(std::uint32_t index, std::uint32_t number, bool room) {
    const bool there = index < rows_.size() && rows_[index].stage == Stage::held && number >= 1 &&
                       number <= rows_[index].assets.size() &&
                       rows_[index].assets[number - 1].stage == RowAsset::Stage::there;
    if (!there)
        throw RequestRefused(
            fmt::format("asset: device \"{}\" has no asset {} of a client in row {}; it may have left",
                        device_.name, number, index));
    HeldAsset& asset = *rows_[index].assets[number - 1].held;
    if (!asset.shown && !room)
        throw RequestRefused("asset: the servo shows as many assets as it can; end a client that has many");
    try {
        // Whoever maps it, if only for reading, must not have the kernel move it under the servo.
        if (!asset.shown) asset.block->hold_pages();
        asset.shown = true;
    } catch (const std::exception& error) {
        throw RequestRefused(fmt::format("asset: it cannot be shown ({})", error.what()));
    }
    return *asset.block;
}

void ClaimTable::forget_asset(std::uint64_t key, std::uint32_t number) {
    Row* row = row_of_key(key);
    if (row == nullptr)
        throw RequestRefused(fmt::format("asset: no claim of device \"{}\" has that key", device_.name));
    if (number < 1 || number > row->assets.size() || row->assets[number - 1].stage != RowAsset::Stage::there)
        throw RequestRefused(fmt::format("asset: the claim has none of number {}", number));
    if (!device_.servo.forget(row->claim.get(), number))
        throw RequestRefused(fmt::format("asset: the servo of \"{}\" is busy; try again", device_.name));
    row->assets[number - 1].stage = RowAsset::Stage::leaving;
}

void ClaimTable::take_back_assets() noexcept {
    while (const std::optional<ReturnedAsset> back = device_.servo.returned()) {
        for (Row& row : rows_)
            if (row.claim.get() == back->claim) row.assets[back->number - 1] = {};
    }
}

}  // namespace knurl::servo
