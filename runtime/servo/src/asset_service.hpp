#pragma once
// The broker's part in assets: who may offer what, who waits for an answer, what the build queue has done.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <knurl/servo/claim_table.hpp>
#include <knurl/shm/fd.hpp>

#include "build_queue.hpp"

namespace knurl::servo {

/// An answer to the connection that offered.
struct AssetReply {
    std::uint64_t connection = 0;
    std::string refusal;  // empty: ready
    protocol::AssetReady ready;
    protocol::AssetForget undo;  // should nobody hear of it
};

class AssetService {
  public:
    using Tables = std::span<const std::unique_ptr<ClaimTable>>;
    explicit AssetService(std::string builder) : build_queue_(std::move(builder)) {}

    /// Throws RequestRefused; then nothing has begun. One offer a connection.
    void offer(std::uint64_t connection, const protocol::AssetOffer& offer, shm::UniqueFd source,
               Tables tables);
    /// That connection has gone: what it waits for is not built. False: nothing.
    bool cancel(std::uint64_t connection, Tables tables) noexcept;
    /// Throws RequestRefused.
    void forget(const protocol::AssetForget& message, Tables tables);
    /// Readable when answers() has something; -1: nothing is being built.
    int event() const noexcept { return build_queue_.event(); }
    std::uint64_t builds() const noexcept {
        return build_queue_.builds();
    }  // begun so far: each has its own event
    /// `recorded`: what a device's claim gets, before it does.
    using Recorded =
        std::function<void(std::uint32_t device, const protocol::RecordedAsset& message, int source)>;
    std::vector<AssetReply> answers(Tables tables, const Recorded& recorded);

  private:
    struct Waiting {
        std::uint32_t device = 0, number = 0;
        std::uint64_t key = 0;  // of the claim: it may be gone when the asset is done
        std::uint64_t bytes = 0;
        shm::UniqueFd source;  // for whoever records
    };
    BuildQueue build_queue_;
    std::unordered_map<std::uint64_t, Waiting> waiting_;  // by connection
};

}  // namespace knurl::servo
