#pragma once
// Builds what clients offer, in processes of their own, one at a time: what is in a client's bytes can crash,
// stall or bloat no more than that process. It runs at idle priority, its allocations lock nothing of the
// servo's, and a client that has gone takes it along. What comes back is memory that its own process has
// written and sealed.
//
//   start ──> fair queue ──> spawn(program --build-asset) ══ socket ══> collect: the asset, or why not
//                             └── cancel: killed

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/shm/fd.hpp>

#include "fair_queue.hpp"

namespace knurl::servo {

class BuildQueue {
  public:
    struct Job {
        std::uint64_t ticket = 0;
        std::uint64_t owner = 0;  // owners take turns
        std::uint32_t number = 0;
        shm::UniqueFd source;
        std::uint64_t bytes = 0;   // of the source
        std::uint64_t budget = 0;  // bytes, of the result and of building it
    };
    struct Result {
        std::uint64_t ticket = 0;
        std::unique_ptr<Asset> asset;  // null: refused
        protocol::AssetReady ready;
        protocol::AssetDigest digest = {};  // of the source
        std::string refusal;
    };

    /// `program` answers `--build-asset` with build_asset_main().
    explicit BuildQueue(std::string program) : program_(std::move(program)) {}
    ~BuildQueue();

    void start(Job job);
    void cancel(std::uint64_t ticket) noexcept;
    /// Readable when collect() has something; of the process at hand. -1: none runs.
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
    void reap(bool wait) noexcept;

    std::string program_;
    FairQueue<Job> queue_;
    std::optional<Running> running_;
    std::uint64_t builds_ = 0;
    std::deque<Result> failed_;  // that could not even be started
    std::vector<pid_t> ending_;  // killed: the kernel frees their memory, which takes a while
};

/// The builder's process: the source is descriptor 0, the answer goes out through 1. Returns its exit code.
int build_asset_main(int argc, const char* const* argv);
inline constexpr const char* build_asset_option = "--build-asset";

}  // namespace knurl::servo
