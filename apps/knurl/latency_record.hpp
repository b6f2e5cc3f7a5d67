#pragma once
// All results of `knurl latency`, in bounded memory for any duration.

#include <map>
#include <string>
#include <vector>

#include <knurl/measure/measure.hpp>

#include "latency_bound.hpp"
#include "latency_paths.hpp"

namespace knurl::cli {

struct FloorSamples {
    std::vector<double> ping_pong, eventfd, bare_loop, udp_one_way, tcp_round_trip;  // ns
};

/// The origin of reports: a floor measured here says nothing about another host.
enum class Way { shared_memory, loopback, network };

class LatencyRecord {
  public:
    LatencyRecord(Nanoseconds period, Way way) : period_(period), way_(way) {}

    /// Adds a round of blocks. A block of each result covers the same rounds.
    void add(const PathSamples& paths, const FloorSamples& floors);
    std::size_t updates() const { return updates_; }
    std::size_t commands() const { return commands_; }
    std::size_t remote_updates() const { return remote_updates_; }

    /// The table, each result beside its floor.
    std::vector<measure::Result> results() const;
    /// From the first 100 000 remote updates, all of which are kept. None: see remote_bound().
    std::optional<RemoteBound> bound(std::span<const measure::Gap> gaps) const;

  private:
    measure::Result result(const std::string& name) const;
    void keep(const PathSamples& paths, const FloorSamples& floors);

    Nanoseconds period_;
    Way way_;
    std::size_t updates_ = 0, commands_ = 0, remote_updates_ = 0;
    std::map<std::string, measure::Blocks> blocks_;  // us
    PathSamples kept_paths_;                         // for the bound
    FloorSamples kept_floors_;
};

}  // namespace knurl::cli
