#pragma once
// The broker's part in assets: who may offer which asset, who waits for an answer, and the results of the
// build queue.

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
    protocol::AssetForget undo;  // for the case that the answer reaches nobody
    shm::UniqueFd source;        // of a client, so who has the reply decides where it is closed
};

class AssetService {
  public:
    using Tables = std::span<const std::unique_ptr<ClaimTable>>;
    explicit AssetService(std::string builder) : build_queue_(std::move(builder)) {}

    /// `socket`: the connection's, in which the message still is, for the builder to take. Throws
    /// RequestRefused; then nothing has begun. One offer per connection at a time.
    void offer(std::uint64_t connection, const protocol::AssetOffer& offer, int socket, Tables tables);
    /// The connection has closed: its asset is not built. False: it waited for none.
    bool cancel(std::uint64_t connection, Tables tables) noexcept;
    /// Nothing more is built.
    void end() noexcept { build_queue_.end(); }
    /// Throws RequestRefused.
    void forget(const protocol::AssetForget& message, Tables tables);
    /// Readable when answers() has something; -1: nothing is being built.
    int event() const noexcept { return build_queue_.event(); }
    std::uint64_t builds() const noexcept {
        return build_queue_.builds();
    }  // begun so far; each has its own event
    /// `recorded`: receives what a device's claim gets, before the claim gets it.
    using Recorded =
        std::function<void(std::uint32_t device, const protocol::RecordedAsset& message, int source)>;
    std::vector<AssetReply> answers(Tables tables, const Recorded& recorded);

  private:
    struct Waiting {
        std::uint32_t device = 0, number = 0;
        std::uint64_t key = 0;  // of the claim, which may be gone when the asset is ready
        std::uint64_t bytes = 0;
    };
    BuildQueue build_queue_;
    std::unordered_map<std::uint64_t, Waiting> waiting_;  // by connection
};

}  // namespace knurl::servo
