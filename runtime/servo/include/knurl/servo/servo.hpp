#pragma once
// The cycle of one device: everything that happens between two deadlines, in one readable function.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <knurl/drivers/device.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/claim.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/servo/supervisor.hpp>

namespace knurl::servo {

struct ServoOptions {
    double rate = 1000;  // Hz, 500-20 000
    SupervisorLimits supervisor;
    double max_dt = 2e-3;           // s: representations never see a longer gap
    bool silence = true;            // false: offline evaluation
    bool start_active = false;      // active at once with gain 1, claims too: offline evaluation
    bool sleep = true;              // false: each claim is looked at in each cycle; to compare with
    bool clamp_stiffness = true;    // false only warns: stability sweeps
    bool budget = true;             // false: each part is clamped by itself alone, for comparison
    double rise_speed = 0.1;        // m/s, FadePolicy::rise_speed; infinity offline
    double automatic_recovery = 0;  // s; 0: automatic_fade of the measured update interval
};

/// k_max = b/(T/2 + tau), or as measured (Colgate & Brown 1994 for the form), device frame.
double max_stiffness(const drivers::LinkConfig& link, double rate) noexcept;

/// The frame of a claim that asked for this workspace (request.workspace_radius 0: scale 1).
protocol::Frame frame_for(const drivers::LinkConfig& link, const protocol::ClaimRequest& request) noexcept;
/// The device's limits in that frame's world units.
Limits limits_for(const drivers::LinkConfig& link, double rate, const protocol::Frame& frame) noexcept;

class InputLog;
class Replay;

/// What nothing of that claim is made of any more.
struct ReturnedAsset {
    const Claim* claim = nullptr;
    std::uint32_t number = 0;
};

class Servo {
  public:
    /// `segment`: memory of protocol::device_layout().total bytes. DeviceInfo is filled in by the caller;
    /// counters, table and report ring begin empty.
    Servo(drivers::Device& device, Clock& clock, std::byte* segment, const ServoOptions& options);
    ~Servo();

    // From one other thread (the broker), wait-free; false: the mailbox is full, try again next cycle.
    bool adopt(Claim* claim) noexcept;  // taken over in the next cycle
    bool drop(Claim* claim) noexcept;   // its force fades (50 ms), then it comes back through `released`
    bool drop_all() noexcept;           // ramp down the device: the servo is about to end
    Claim* released() noexcept;         // null: none; the broker frees it
    /// The claim's asset of that number from the next cycle on, before its commands are looked at. It
    /// outlives the claim, or its return. `digest`: of what it was made of, for the input log. False: the
    /// mailbox is full.
    bool give(Claim* claim, std::uint32_t number, const Asset* asset,
              const protocol::AssetDigest& digest = {}) noexcept;
    /// It comes back through `returned` once nothing that is felt, or still fades, is made of it.
    bool forget(Claim* claim, std::uint32_t number) noexcept;
    std::optional<ReturnedAsset> returned() noexcept;
    /// From the next cycle on every input goes into this log, which outlives the servo; null: no more. The
    /// same log once more: a keyframe as soon as nobody holds the device.
    bool record(InputLog* input_log) noexcept;

    /// The cycle. `deadline` is when it should have begun, `now` when it did (CLOCK_MONOTONIC or virtual,
    /// ns).
    void step(Nanoseconds deadline, Nanoseconds now) noexcept;

    /// After step: those who may wait for its report, for Waker::wake.
    std::span<const shm::WakeTarget> wake_targets() const noexcept;
    /// The report of the last cycle.
    const Report& last() const noexcept;
    // From the servo's thread, before the next step:
    /// The guardian zeroed the device while this thread stood still: gain 0, then the ordinary ramp up.
    void guardian_acted() noexcept;
    /// The machine slept (CLOCK_BOOTTIME moved without CLOCK_MONOTONIC): a fault, latched.
    void clock_jumped() noexcept;

    /// The output stage, for looking at.
    const Supervisor& supervisor() const noexcept;

  private:
    friend class Replay;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::servo
