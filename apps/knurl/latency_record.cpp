#include "latency_record.hpp"

#include <algorithm>
#include <functional>

namespace knurl::cli {

namespace {

constexpr std::size_t most_kept = 100'000;

/// Two independent durations in sequence.
std::vector<double> one_after_another(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> sums(std::min(a.size(), b.size()));
    std::transform(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(sums.size()), b.begin(), sums.begin(),
                   std::plus<>());
    return sums;
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
    all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

void LatencyRecord::add(const PathSamples& paths, const FloorSamples& floors) {
    constexpr double ns = 1e-3;  // in us
    updates_ += paths.commit_to_write.size();
    commands_ += paths.command.size();
    remote_updates_ += paths.to_use.size();
    blocks_["update.commit_to_write"].add(paths.commit_to_write, ns);
    blocks_["update.age_at_use"].add(paths.wait_for_use, ns);
    blocks_["update.age_at_use_cycles"].add(paths.wait_for_use, 1 / static_cast<double>(period_));
    blocks_["update.cycles_overlooked"].add(paths.overlooked);
    blocks_["update.report_age_at_use"].add(paths.report_age, ns);
    blocks_["report.spinning"].add(paths.spinning, ns);
    blocks_["report.blocking"].add(paths.blocking, ns);
    blocks_["report.descriptor"].add(paths.descriptor, ns);
    blocks_["report.spinning_from_deadline"].add(paths.spinning_deadline, ns);
    blocks_["report.blocking_from_deadline"].add(paths.blocking_deadline, ns);
    blocks_["report.descriptor_from_deadline"].add(paths.descriptor_deadline, ns);
    blocks_["servo.lateness"].add(paths.servo_lateness, ns);
    blocks_["floor.cache_line"].add(floors.ping_pong, ns);
    blocks_["floor.eventfd_wake"].add(floors.eventfd, ns);
    blocks_["floor.bare_loop_lateness"].add(floors.bare_loop, ns);
    blocks_["command.round_trip"].add(paths.command, ns);
    blocks_["command.less_cycle_wait"].add(paths.command_less_wait, ns);
    if (way_ == Way::shared_memory) return;
    blocks_["update.remote_to_use"].add(paths.to_use, ns);
    blocks_["update.remote_to_write"].add(paths.to_write, ns);
    blocks_["report.blocking_after_write"].add(paths.after_write, ns);
    blocks_["floor.udp_one_way"].add(floors.udp_one_way, ns);
    blocks_["floor.wake_and_udp"].add(one_after_another(floors.eventfd, floors.udp_one_way), ns);
    blocks_["floor.tcp_round_trip"].add(floors.tcp_round_trip, ns);
    blocks_["floor.wake_and_tcp"].add(one_after_another(floors.eventfd, floors.tcp_round_trip), ns);
    keep(paths, floors);
}

void LatencyRecord::keep(const PathSamples& paths, const FloorSamples& floors) {
    if (kept_paths_.to_use.size() >= most_kept) return;
    append(kept_paths_.to_use, paths.to_use);
    append(kept_paths_.to_write, paths.to_write);
    append(kept_paths_.commits, paths.commits);
    append(kept_floors_.udp_one_way, floors.udp_one_way);
    append(kept_floors_.eventfd, floors.eventfd);
}

measure::Result LatencyRecord::result(const std::string& name) const {
    const auto found = blocks_.find(name);
    return measure::summarise_blocks(
        name, name == "update.age_at_use_cycles" || name == "update.cycles_overlooked" ? "cyc" : "us",
        found == blocks_.end() ? measure::Blocks() : found->second);
}

std::vector<measure::Result> LatencyRecord::results() const {
    const bool local = way_ == Way::shared_memory;
    std::vector<measure::Result> all;
    const auto add = [&](const char* name, const char* floor = nullptr) {
        measure::Result made = result(name);
        if (floor != nullptr) measure::relate(made, result(floor));
        all.push_back(std::move(made));
    };
    const auto where = [](bool fits, const char* floor) { return fits ? floor : nullptr; };
    add("update.commit_to_write");
    add("update.age_at_use");
    add("update.age_at_use_cycles");
    add("update.cycles_overlooked");
    add("update.report_age_at_use");
    add("report.spinning", where(local, "floor.cache_line"));
    add("report.blocking", where(local, "floor.eventfd_wake"));
    add("report.descriptor", where(local, "floor.eventfd_wake"));
    add("report.spinning_from_deadline");
    add("report.blocking_from_deadline");
    add("report.descriptor_from_deadline");
    add("servo.lateness", where(way_ != Way::network, "floor.bare_loop_lateness"));
    add("floor.cache_line");
    add("floor.eventfd_wake");
    add("floor.bare_loop_lateness");
    if (local) {
        add("command.round_trip");
        add("command.less_cycle_wait", "floor.eventfd_wake");
        return all;
    }
    // Over a network a report wakes the bridge, goes one way, and wakes the reader; an answer does too.
    add("update.remote_to_use");
    add("update.remote_to_write");
    add("report.blocking_after_write", "floor.wake_and_udp");
    add("floor.udp_one_way");
    add("floor.wake_and_udp");
    add("command.round_trip", "floor.tcp_round_trip");
    add("command.less_cycle_wait", "floor.wake_and_tcp");
    add("floor.tcp_round_trip");
    add("floor.wake_and_tcp");
    return all;
}

std::optional<RemoteBound> LatencyRecord::bound(std::span<const measure::Gap> gaps) const {
    if (way_ == Way::shared_memory) return std::nullopt;
    const auto udp = result("floor.udp_one_way").p50, wake = result("floor.eventfd_wake").p50;
    if (!udp || !wake) return std::nullopt;
    return remote_bound(kept_paths_, kept_floors_.udp_one_way, kept_floors_.eventfd,
                        FloorMedians{.udp_one_way = *udp * 1e3, .wake = *wake * 1e3}, period_, gaps);
}

}  // namespace knurl::cli
