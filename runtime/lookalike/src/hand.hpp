#pragma once
// One device as a program of a vendor's library uses it: it reads where the hand is, and sets a force again and again,
// from any thread. A shared claim of a servo is behind it. Vectors are in the device's axes, positions from the centre
// of its workspace.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>

#include "wish.hpp"

namespace knurl::lookalike {

/// What became of a force.
enum class Pushed {
    /// It takes effect in the next cycle.
    taken,
    /// Likewise, and the servo shortens it to what the device can do.
    saturated,
    /// It is not felt: the device does not let itself be armed; the reason was said.
    not_armed,
};

class Hand {
  public:
    /// How long a force lasts that is not set anew, as the vendors' watchdogs have it.
    static constexpr std::chrono::milliseconds longest_lapse{100};
    /// How long it takes to fade then (s).
    static constexpr double fade = 0.05;

    /// Claims the device. Throws Error.
    explicit Hand(const Place& place);
    /// Releases it: the force fades.
    ~Hand();
    Hand(const Hand&) = delete;
    Hand& operator=(const Hand&) = delete;

    const DeviceDescription& device() const { return device_; }
    Limits limits() const { return claim_.limits(); }
    /// The newest report. None: the servo is gone.
    std::optional<HandReport> newest();
    /// Waits for a report that is newer than that of the call before, for a few cycles at most. For one thread at a
    /// time; another one that calls meanwhile returns at once.
    void pace();

    /// A force on the hand (N) and a torque about the tip (N m), finite, until the next one or until the lapse. Arms
    /// the device first where it may. Throws Error where the servo is gone.
    Pushed push(const Vec3& force, const Vec3& torque);
    /// No force from now on, over the fade.
    void let_go();
    /// False: push() does not arm, and what is armed is disarmed. Throws Error.
    void allow_force(bool allowed);
    bool force_allowed() const;
    /// Arms now, without a force. False: refused; the reason was said.
    bool arm();
    bool armed() const;
    /// At most longest_lapse; 0: longest_lapse.
    void set_lapse(std::chrono::nanoseconds lapse);

    /// How often a second push() was called, lately (Hz).
    double rate() const;

  private:
    using Clock = std::chrono::steady_clock;
    using Lock = std::unique_lock<std::mutex>;

    void set(const ConstantForce& params, const Lock& lock);
    bool arm(const Lock& lock);
    void look(const Lock& lock);
    void keep();

    Client client_;
    Claim claim_;
    const DeviceDescription device_;

    mutable std::mutex mutex_;  // for all below
    std::condition_variable changed_;
    std::optional<Handle<ConstantForce>> force_;
    bool held_ = false;  // a force is set that has not lapsed
    Clock::time_point pushed_{};
    std::chrono::nanoseconds lapse_ = longest_lapse;
    double interval_ = 0;  // between calls of push(), smoothed (s)
    bool allowed_ = true;
    bool armed_ = false;
    std::uint64_t servos_ = 0;
    Clock::time_point armed_at_{}, try_arm_{};
    bool ending_ = false;

    // Readers of their own, each for one thread at a time: a program reads while another thread of it waits.
    std::mutex reading_;
    Observer reader_;
    std::mutex pacing_;
    Observer pacer_;
    std::uint64_t paced_ = 0;  // cycle

    std::thread keeper_;  // begins last
};

}  // namespace knurl::lookalike
