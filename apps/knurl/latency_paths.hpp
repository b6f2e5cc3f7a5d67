#pragma once
// The two paths of a haptics server as an application sees them: its update to the motors, and the hand's
// report to it.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>

#include "latency_floors.hpp"

namespace knurl::cli {

/// CLOCK_MONOTONIC, ns.
struct Span {
    Nanoseconds begin = 0, end = 0;
};

/// Samples in ns.
struct PathSamples {
    // intended time of an update -> write of the first force computed from it
    std::vector<double> commit_to_write;
    std::vector<double> wait_for_use;  // commit has returned -> read of the cycle that used it
    std::vector<double> report_age;    // read of the report an update was computed from -> that write
    std::vector<double> spinning, blocking, descriptor;  // read of the device -> the client has the report
    // from the cycle's deadline
    std::vector<double> spinning_deadline, blocking_deadline, descriptor_deadline;
    std::vector<double> servo_lateness;  // deadline -> the device has been read; skipped cycles included
    // per update, the cycles that began after its commit and did not use it: expected 0
    std::vector<double> overlooked;
    // blocking: write to the motors (then it publishes) -> the client has it
    std::vector<double> after_write;
    std::vector<double> command;            // sent -> answered
    std::vector<double> command_less_wait;  // the same, minus the wait for the servo's next cycle
    // With an application that sleeps between its updates and its reports:
    // commit is called -> the cycle that uses it begins; -> has written
    std::vector<double> to_use, to_write;
    std::vector<Span> commits;  // of each of these, by the local clock
    std::uint64_t merged = 0;   // updates replaced by a later one before the servo looked
    std::uint64_t lost = 0;     // updates without a visible force
};

/// An application whose updates are identified by their force: a constant force of a few millinewtons,
/// different for each update.
class LatencyPaths {
  public:
    /// Arms the claim and waits until its force arrives in full. Throws knurl::Error or std::runtime_error.
    LatencyPaths(Claim& hand, std::uint64_t seed);

    // Blocks of about that length.
    /// Spins for reports and commits updates at random phase: uniform over a cycle, drawn beforehand.
    void updates_and_spinning_block(Nanoseconds length) { updates_block(length, true); }
    /// The same, sleeping until the next event: a report or the next update's time.
    void updates_and_blocking_block(Nanoseconds length) { updates_block(length, false); }
    void blocking_block(Nanoseconds length);
    void descriptor_block(Nanoseconds length);
    /// Commands that change nothing (an `arm` of an armed claim), at random phase, one at a time. `beside`
    /// runs after each, also at random phase; false: earlier samples are still left out.
    void commands_block(Nanoseconds length, const std::function<void(bool counts)>& beside);

    const PathSamples& samples() const { return samples_; }
    /// The caller has taken the samples; the counters continue.
    void forget();
    Nanoseconds period() const { return period_; }
    /// To the bridge and back, by the clock estimate; 0 on one host.
    Nanoseconds round_trip() const { return hand_.network().round_trip.count(); }
    /// The newest known deadline of the servo, by the local clock.
    Nanoseconds deadline() const { return newest_ ? ours(newest_->deadline_ns) : 0; }

  private:
    struct Update {
        double force;  // N
        Nanoseconds intended, begun, committed;
        Nanoseconds basis_read;  // of the report it was computed from
    };

    void updates_block(Nanoseconds length, bool spinning);
    void wait_until_felt();
    void command(bool counts);
    void commit_update(Nanoseconds intended);
    void used(const Update& update, const HandReport& report);
    void used_by_sleeper(const Update& update, const HandReport& report);
    void catch_up();
    void see(const HandReport& report);
    /// A time stamp of the servo, converted to the local clock.
    Nanoseconds ours(Nanoseconds servos) const { return servos - clock_offset_; }
    void note(const HandReport& report, Nanoseconds had, std::vector<double>& from_read,
              std::vector<double>& from_deadline);
    double random() { return std::uniform_real_distribution<double>(0, 1)(generator_); }

    Claim& hand_;
    std::optional<Handle<ConstantForce>> force_;
    std::mt19937_64 generator_;
    Nanoseconds period_;
    std::uint64_t updates_ = 0;
    std::deque<Update> pending_;
    std::optional<HandReport> newest_;
    std::deque<Nanoseconds> reads_;  // times of the newest cycles' device reads
    Nanoseconds clock_offset_ = 0;   // of the servo's host to this one, as estimated
    std::size_t cold_ = 0;           // reports of this block still to be left out
    PathSamples samples_;
};

}  // namespace knurl::cli
