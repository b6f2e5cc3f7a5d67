#pragma once

/// @file
/// A process that outlives the servo: forked before real time starts, it holds the devices and the report
/// memory.
///
/// ~~~{.unparsed}
///   servo dies (killed, crashed)  -> every device zeroed at once, flight recorder written, the guardian ends
///   servo is stopped (SIGSTOP)    -> every device zeroed within 5 ms; the servo is told: it ramps up from 0
///   servo stands still > stall    -> that device zeroed; the servo is told likewise
///   servo says goodbye            -> the guardian ends, no file
///   the guardian dies             -> the servo ramps down and ends (Broker): a motor is not run unguarded,
///                                    and a fork from a real-time process would cost its threads page faults
///   the guardian stands still     -> the servo ramps its devices down (GuardianWatch)
/// ~~~
///
/// A host that stops the whole virtual machine stops the guardian too, and somebody may stop both processes:
/// only a device's own watchdog helps there.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/drivers/device.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::servo {

/// A device as the guardian needs it.
struct GuardedDevice {
    /// The device.
    drivers::Device* device = nullptr;
    /// Its report memory (protocol::device_layout).
    const std::byte* segment = nullptr;
};

/// How a guardian runs.
struct GuardianOptions {
    /// SCHED_FIFO priority, above the servo's; 0: ordinary.
    int priority = 0;
    /// CPU that it keeps off; -1: none.
    int servo_cpu = -1;
    /// Time without a cycle after which it acts (s).
    double stall = 20e-3;
    /// Directory of flight records.
    std::string state_directory;
    /// Descriptors of the servo's that it must not hold: the listening socket.
    std::vector<int> close;
};

/// Tells a stall of the servo from one of the whole machine: time counts only as far as the guardian itself
/// ran. A servo that is late is waited for; one that the kernel calls stopped is not.
class StallWatch {
  public:
    /// `stall`: time without a beat after which to act (ns).
    explicit StallWatch(Nanoseconds stall) : stall_(stall) {}

    /// One tick of the guardian. `beat`: reports published; `enabled`: force may be on; `stopped`: by a
    /// signal or a debugger. True, once per stall: act.
    bool tick(Nanoseconds now, std::uint64_t beat, bool enabled, bool stopped = false) noexcept;

    /// Time between ticks while a device is enabled (ns).
    static constexpr Nanoseconds period = 1'000'000;
    /// A longer tick counts as this (ns).
    static constexpr Nanoseconds longest_tick = 2 * period;

  private:
    Nanoseconds stall_;
    Nanoseconds last_ = 0;
    Nanoseconds still_ = 0;  // how long the beat has stood still while we ran
    std::uint64_t beat_ = 0;
    bool acted_ = false;
};

/// Tells a guardian that stands still, for example stopped by a signal, from a machine on which nothing runs:
/// time counts only as far as the servo itself ran.
class GuardianWatch {
  public:
    /// `longest`: time without a beat after which the guardian stands still (ns).
    explicit GuardianWatch(Nanoseconds longest) : patience_(longest) {}

    /// One cycle of the servo. `beat`: the guardian's ticks. True while it stands still.
    bool still(Nanoseconds now, std::uint64_t beat) noexcept;

    /// The guardian's tick while no device is enabled, which is its longest (ns).
    static constexpr Nanoseconds idle_tick = 20'000'000;
    /// Patience with a guardian that runs in real time: its longest tick, twice (ns).
    static constexpr Nanoseconds patience = 2 * idle_tick;
    /// Patience with one that does not: on a busy machine it may wait that long for a CPU (ns).
    static constexpr Nanoseconds ordinary_patience = 250'000'000;
    /// A longer cycle counts as this (ns).
    static constexpr Nanoseconds longest_cycle = 2'000'000;

  private:
    Nanoseconds patience_;
    Nanoseconds last_ = 0;
    Nanoseconds still_for_ = 0;
    std::uint64_t beat_ = 0;
};

/// What the guardian tells a device's loop, in memory that only the guardian writes.
struct GuardianSigns {
    /// How often it has zeroed the device. It adds with release before it zeroes; Loop reads with acquire.
    const std::atomic<std::uint64_t>& acts;
    /// Its ticks: proof that it runs, which orders nothing.
    const std::atomic<std::uint64_t>& beat;
};

/// The servo's handle on its guardian process.
class Guardian {
  public:
    /// Forks, and returns when the guardian watches. Call while the process has one thread and holds nothing
    /// that the child must not. Throws std::runtime_error.
    Guardian(std::span<const GuardedDevice> devices, const GuardianOptions& options);
    /// goodbye(), if that was not said.
    ~Guardian();
    Guardian(const Guardian&) = delete;
    Guardian& operator=(const Guardian&) = delete;

    /// Process number of the guardian.
    pid_t pid() const { return pid_; }
    /// It got the priority of its options.
    bool real_time() const { return real_time_; }
    /// Becomes readable when the guardian has died.
    int pidfd() const { return pidfd_.get(); }
    /// What it tells the loop of device `i`.
    GuardianSigns signs(std::size_t i) const;
    /// The devices are at rest: the guardian ends, and its end is awaited.
    void goodbye() noexcept;

  private:
    shm::Segment board_;
    shm::UniqueFd line_;  // to the guardian; its hang-up without a goodbye is our death
    shm::UniqueFd pidfd_;
    pid_t pid_ = -1;
    bool real_time_ = false;
};

}  // namespace knurl::servo
