#pragma once
// A load that can be stated: what else the machine does while it is measured.

#include <atomic>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

namespace knurl::cli {

/// On each CPU that we may use one thread of ordinary priority, until this object goes. "spin": it counts.
/// "memory": it moves 32 MiB to and fro, which passes through every cache. "none": there is no thread.
class Load {
  public:
    explicit Load(const std::string& kind);
    ~Load();
    Load(const Load&) = delete;
    Load& operator=(const Load&) = delete;

    std::size_t threads() const { return threads_.size(); }
    /// How often they have gone round, all together: it is no load if this stands still.
    std::size_t rounds() const { return rounds_; }

  private:
    std::atomic<bool> done_ = false;
    std::atomic<std::size_t> rounds_ = 0;
    std::vector<std::thread> threads_;
};

}  // namespace knurl::cli
