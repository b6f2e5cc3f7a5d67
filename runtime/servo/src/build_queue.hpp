#pragma once
// Builds what clients offer, in separate processes, one at a time. A client's bytes can crash, stall or bloat
// only that process. It runs at idle priority, its allocations lock none of the servo's memory, and it ends
// when its client leaves. The result is memory that its own process has written and sealed.
//
//   start ──> fair queue ──> spawn(program --build-asset) ══ socket ══> collect: the asset, or the refusal
//                             └── cancel: killed

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/servo/claim_table.hpp>
#include <knurl/shm/fd.hpp>

#include "fair_queue.hpp"

namespace knurl::servo {

class BuildQueue {
  public:
    struct Job {
        std::uint64_t ticket = 0;
        std::uint64_t owner = 0;  // owners take turns
        std::uint32_t number = 0;
        shm::UniqueFd connection;  // its next message brings the source
        std::uint64_t bytes = 0;   // of the source
        std::uint64_t budget = 0;  // bytes, of the result and of its build
    };
    struct Result {
        std::uint64_t ticket = 0;
        std::unique_ptr<Asset> asset;  // null: refused
        AssetMemory memory;            // in which it lies
        protocol::AssetReady ready;
        protocol::AssetDigest digest = {};  // of the source
        shm::UniqueFd source;               // sealed memory, with an asset
        std::string refusal;
    };

    /// `program` answers `--build-asset` with build_asset_main().
    explicit BuildQueue(std::string program) : program_(std::move(program)) {}
    ~BuildQueue();

    void start(Job job);
    void cancel(std::uint64_t ticket) noexcept;
    /// Cancels all.
    void end() noexcept;
    /// Readable when collect() has a result; belongs to the running process. -1: none runs.
    int event() const noexcept { return running_ ? running_->socket.get() : -1; }
    std::optional<Result> collect();
    std::uint64_t builds() const noexcept { return builds_; }  // processes begun so far

  private:
    struct Running {
        std::uint64_t ticket = 0;
        std::uint32_t number = 0;
        pid_t pid = 0;
        shm::UniqueFd socket;
    };
    void next();
    void end_process() noexcept;
    void reap() noexcept;

    std::string program_;
    FairQueue<Job> queue_;
    std::optional<Running> running_;
    std::uint64_t builds_ = 0;
    std::deque<Result> failed_;  // jobs whose process could not be started
    std::vector<pid_t> ending_;  // killed: the kernel frees their memory, which takes a while
};

/// The main function of the builder's process: receives the source from the client's connection, descriptor
/// 0, and answers through descriptor 1. Returns its exit code.
int build_asset_main(int argc, const char* const* argv);
inline constexpr const char* build_asset_option = "--build-asset";

}  // namespace knurl::servo
