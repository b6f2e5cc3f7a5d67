#pragma once

/// @file
/// The cycle of one device: everything that happens between two deadlines, in one readable function.

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

/// How a servo runs.
struct ServoOptions {
    /// Rate (Hz), 500 to 20 000.
    double rate = 1000;
    /// Limits of the supervisor.
    SupervisorLimits supervisor;
    /// Longest dt that representations see (s).
    double max_dt = 2e-3;
    /// False: claims never fall silent (offline evaluation).
    bool silence = true;
    /// True: active at once with gain 1, claims too (offline evaluation).
    bool start_active = false;
    /// False: claims do not sleep, each is evaluated in each cycle; to compare with.
    bool sleep = true;
    /// False: stiffness is not clamped, only reported (stability sweeps).
    bool clamp_stiffness = true;
    /// False: each part is clamped by itself alone, for comparison.
    bool budget = true;
    /// FadePolicy::rise_speed (m/s); infinity offline.
    double rise_speed = 0.1;
    /// Meaning of `recovery = automatic` (s); 0: automatic_fade of the measured update interval.
    double automatic_recovery = 0;
};

/// Largest stiffness k_max = b / (T/2 + tau) (N/m), device frame, or as measured; Colgate and Brown 1994 for
/// the form.
double max_stiffness(const drivers::LinkConfig& link, double rate) noexcept;

/// The frame of a claim that requested this workspace (request.workspace_radius 0: scale 1).
protocol::Frame frame_for(const drivers::LinkConfig& link, const protocol::ClaimRequest& request) noexcept;
/// The device's limits in that frame's world units.
Limits limits_for(const drivers::LinkConfig& link, double rate, const protocol::Frame& frame) noexcept;

class InputLog;
class RecordLog;
class Replay;

/// An asset of which nothing of that claim is made any more.
struct ReturnedAsset {
    /// The claim.
    const Claim* claim = nullptr;
    /// Number of the asset.
    std::uint32_t number = 0;
};

/// The cycle of one device. adopt() to record() are called by one other thread (the broker); they are
/// wait-free, and false means that the mailbox is full: try again in the next cycle.
class Servo {
  public:
    /// `segment`: memory of protocol::device_layout().total bytes. DeviceInfo is filled in by the caller;
    /// counters, table and report ring begin empty.
    Servo(drivers::Device& device, Clock& clock, std::byte* segment, const ServoOptions& options);
    ~Servo();

    /// Takes a claim over in the next cycle.
    bool adopt(Claim* claim) noexcept;
    /// The claim's force fades (50 ms), then it comes back through `released`.
    bool drop(Claim* claim) noexcept;
    /// Ramps down the device: the servo is about to end.
    bool drop_all() noexcept;
    /// A claim that came back, for the broker to free; null: none.
    Claim* released() noexcept;
    /// The claim has this asset by that number from the next cycle on, before its commands are taken. The
    /// asset outlives the claim, or its return. `digest`: of its source, for the input log. False: the
    /// mailbox is full.
    bool give(Claim* claim, std::uint32_t number, const Asset* asset,
              const protocol::AssetDigest& digest = {}) noexcept;
    /// The asset comes back through `returned` once nothing that acts, or still fades, is made of it.
    bool forget(Claim* claim, std::uint32_t number) noexcept;
    /// An asset that came back; none: no asset did.
    std::optional<ReturnedAsset> returned() noexcept;
    /// From a thread of its own, for a claim that is dropped later: its client has died, it fades from now on.
    /// False: the mailbox is full.
    bool abandon(Claim* claim) noexcept;
    /// From the next cycle on every input goes into this log, which outlives the servo; null: no more. The
    /// same log once more: a keyframe as soon as nobody holds the device.
    bool record(InputLog* input_log) noexcept;
    /// From the next cycle on this log, which outlives the servo, has what is in the scenes (scene_log.hpp); null: no
    /// more. Once more: all of it anew.
    bool show_scenes(RecordLog* scene_log) noexcept;

    /// The cycle. `deadline` is when it should have begun, `now` when it did (CLOCK_MONOTONIC or virtual,
    /// ns).
    void step(Nanoseconds deadline, Nanoseconds now) noexcept;

    /// From the servo's thread, after step: how long the cycle took (ns). Without it the servo takes any work.
    void took(Nanoseconds time) noexcept;

    /// After step: the clients that may wait for its report, for Waker::wake.
    std::span<const shm::WakeTarget> wake_targets() const noexcept;
    /// The report of the last cycle.
    const Report& last() const noexcept;
    /// From the servo's thread, before the next step. The guardian zeroed the device while this thread stood
    /// still: gain 0, then the ordinary ramp up.
    void guardian_acted() noexcept;
    /// From the servo's thread, before the next step. Nobody would zero the device in place of the servo: it
    /// ramps down, then it is in fault until it is reset; not before the guardian runs again.
    void guardian_is_still(bool still) noexcept;
    /// From the servo's thread, before the next step. The machine slept (CLOCK_BOOTTIME moved without
    /// CLOCK_MONOTONIC): a fault, latched.
    void clock_jumped() noexcept;

    /// The output stage.
    const Supervisor& supervisor() const noexcept;

  private:
    friend class Replay;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::servo
