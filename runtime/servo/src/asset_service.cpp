#include "asset_service.hpp"

#include <fcntl.h>
#include <fmt/format.h>

namespace knurl::servo {

void AssetService::offer(std::uint64_t connection, const protocol::AssetOffer& offer, int socket,
                         Tables tables) {
    const auto [place, first] = waiting_.try_emplace(connection);
    if (!first)
        throw RequestRefused(
            "asset: one connection offers one asset at a time; wait for its answer, or connect once more");
    ClaimTable* expecting = nullptr;
    try {
        if (offer.device >= tables.size())
            throw RequestRefused(fmt::format("asset: device {} of {}", offer.device, tables.size()));
        ClaimTable& table = *tables[offer.device];
        shm::UniqueFd own(::fcntl(socket, F_DUPFD_CLOEXEC, 0));
        if (!own)
            throw RequestRefused("asset: the servo has no descriptor left; see the limit of open files");
        const std::uint64_t budget = table.expect_asset(offer.key, offer.number, offer.bytes);
        expecting = &table;
        place->second = {
            .device = offer.device, .number = offer.number, .key = offer.key, .bytes = offer.bytes};
        build_queue_.start({.ticket = connection,
                            .owner = offer.key,
                            .number = offer.number,
                            .connection = std::move(own),
                            .bytes = offer.bytes,
                            .budget = budget});
    } catch (...) {  // at worst out of memory: else the number would count as "being built" for ever
        if (expecting != nullptr) expecting->expect_no_asset(offer.key, offer.number);
        waiting_.erase(place);
        throw;
    }
}

void AssetService::forget(const protocol::AssetForget& message, Tables tables) {
    if (message.device >= tables.size())
        throw RequestRefused(fmt::format("asset: device {} of {}", message.device, tables.size()));
    tables[message.device]->forget_asset(message.key, message.number);
}

bool AssetService::cancel(std::uint64_t connection, Tables tables) noexcept {
    const auto found = waiting_.find(connection);
    if (found == waiting_.end()) return false;
    build_queue_.cancel(connection);
    tables[found->second.device]->expect_no_asset(found->second.key, found->second.number);
    waiting_.erase(found);
    return true;
}

std::vector<AssetReply> AssetService::answers(Tables tables, const Recorded& recorded) {
    std::vector<AssetReply> replies;
    while (auto result = build_queue_.collect()) {
        const auto found = waiting_.find(result->ticket);
        if (found == waiting_.end()) continue;
        const Waiting waiting = found->second;
        waiting_.erase(found);
        AssetReply reply{.connection = result->ticket,
                         .refusal = result->refusal,
                         .ready = result->ready,
                         .undo = {},
                         .source = {}};
        reply.undo.device = waiting.device;
        reply.undo.number = waiting.number;
        reply.undo.key = waiting.key;
        ClaimTable& table = *tables[waiting.device];
        if (result->asset) {
            try {
                recorded(waiting.device, {.bytes = waiting.bytes, .digest = result->digest},
                         result->source.get());
                table.give_asset(waiting.key, waiting.number, std::move(result->asset),
                                 std::move(result->memory), result->digest);
            } catch (const RequestRefused& refusal) {
                reply.refusal = refusal.what();
            }
        }
        if (!reply.refusal.empty()) table.expect_no_asset(waiting.key, waiting.number);
        reply.source = std::move(result->source);
        replies.push_back(std::move(reply));
    }
    return replies;
}

}  // namespace knurl::servo
