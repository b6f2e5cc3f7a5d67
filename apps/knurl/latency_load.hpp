#pragma once
// A reproducible load: what else the machine does during the measurement.

#include <atomic>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

namespace knurl::cli {

/// One thread of ordinary priority on each allowed CPU, until this object ends. "spin": it counts. "memory":
/// it moves 32 MiB to and fro, through all caches. "none": no thread.
class Load {
  public:
    explicit Load(const std::string& kind);
    ~Load();
    Load(const Load&) = delete;
    Load& operator=(const Load&) = delete;

    std::size_t threads() const { return threads_.size(); }
    /// Total number of rounds; if it stands still there is no load.
    std::size_t rounds() const { return rounds_; }

  private:
    std::atomic<bool> done_ = false;
    std::atomic<std::size_t> rounds_ = 0;
    std::vector<std::thread> threads_;
};

}  // namespace knurl::cli
