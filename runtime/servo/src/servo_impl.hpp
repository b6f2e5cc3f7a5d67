#pragma once
// What a servo consists of, and the parts of its cycle.

#include <array>
#include <cstdint>

#include <knurl/servo/input_log.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/counters.hpp>
#include <knurl/shm/waiter.hpp>

#include "claim_set.hpp"
#include "command_processor.hpp"
#include "mailbox.hpp"
#include "stage_clock.hpp"
#include "tip_estimator.hpp"

namespace knurl::servo {

/// From the broker.
struct Message {
    enum class What : std::uint32_t { adopt, drop, drop_all, input_log, asset, forget } what = What::adopt;
    Claim* claim = nullptr;
    InputLog* input_log = nullptr;
    const Asset* asset = nullptr;
    std::uint32_t number = 0;           // of the asset
    protocol::AssetDigest digest = {};  // of its source
};

/// The parts of the cycle, in the order in which `step` calls them, and what they remember.
struct Servo::Impl {
    Impl(drivers::Device& the_device, Clock& the_clock, std::byte* segment, const ServoOptions& stated);

    double begin_cycle(Nanoseconds deadline, Nanoseconds now) noexcept;
    void read_device(Nanoseconds now) noexcept;
    void take_mail(Nanoseconds now) noexcept;
    void take_changes(Nanoseconds now) noexcept;
    Wrench evaluate_claims(Nanoseconds now, double dt) noexcept;
    Supervised supervise(const Wrench& sum, double dt) noexcept;
    void notify_device() noexcept;
    void write_device(Nanoseconds now, const Supervised& out) noexcept;
    void publish(Nanoseconds deadline, const Wrench& sum, const Supervised& out) noexcept;
    void publish_counters(Nanoseconds now) noexcept;
    void publish_parts() noexcept;
    void let_go() noexcept;
    void disarm_claims() noexcept;

    /// Who is looked at in this cycle: `claims.awake()`.
    void find_awake(Nanoseconds now, double dt) noexcept;
    /// All of them are, from here on.
    void wake_claims() noexcept;
    void drop(std::size_t place) noexcept;
    /// One that was looked at in this cycle, if it has nothing to do.
    void put_to_sleep(std::size_t place) noexcept;
    /// The claim's scene, unless that sleeps.
    void evaluate_scene(std::size_t place, const Probe& probe, double dt) noexcept;

    // servo_input_log.cpp
    void put_keyframe() noexcept;
    void put_cycle(Nanoseconds deadline, Nanoseconds now) noexcept;
    void put_claim(InputType type, std::uint64_t number) noexcept;
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(first, last_now, budget, enabled, guardian, unplugged, ending, late, report.cycle,
              report.buttons, report.flags, report.presses, report.touches, claims_seen, tip, supervisor);
    }

    void adopt(Claim* claim, Nanoseconds now) noexcept;
    void take_asset(const Message& message) noexcept;
    void return_assets(Claim& claim) noexcept;
    FadePolicy fade_for(const Claim::Impl& claim) const noexcept;
    void keep_within_budget(const Probe& probe, double dt) noexcept;
    double nominal(Nanoseconds gap) const noexcept;

    drivers::Device& device;
    Clock& clock;
    ServoOptions options;
    Nanoseconds period;

    StageClock stages;
    TipEstimator tip;
    Supervisor supervisor;
    CommandProcessor command_processor;
    shm::BroadcastWriter reports;
    shm::Counters counters;

    ClaimSet claims;
    // Of the last cycle whose scenes were evaluated: what a scene that wakes is given.
    Probe passed_hand;
    bool hand_usable = false;               // time passes, and the hand is somewhere
    Mailbox<Message, mailbox_slots> inbox;  // broker -> servo
    Mailbox<Claim*, mailbox_slots> outbox;  // servo -> broker
    Mailbox<ReturnedAsset, mailbox_slots> asset_outbox;
    bool ending = false;  // drop_all

    bool first = true;
    Nanoseconds last_now = 0, read_ns = 0, write_ns = 0;
    HandBudget budget;          // of all claims together
    double own_damping = 0;     // N s/m: that by which max_stiffness was found
    bool settles = false;       // in this cycle: what was there from the start
    bool enabled = false;       // as the device was last told
    bool guardian = false;      // it zeroed the device before this cycle
    bool unplugged = false;     // this cycle's read, or the last write, found no device
    std::uint32_t trouble = 0;  // faults that this cycle's sample raises
    bool jumped = false;        // the clock, before this cycle: for the input log
    bool written = false;       // in this cycle: the device was there to take it
    const Claim::Impl* in_contact = nullptr;
    Report report;
    // of the last reports, for the age of a batch
    std::array<Nanoseconds, protocol::report_slots> read_times = {};
    std::uint64_t late = 0, overruns = 0, stalls = 0, guardian_zeroings = 0, evaluated = 0, present = 0;

    InputLog* input_log = nullptr;    // null: nobody records
    std::uint64_t next_keyframe = 0;  // the cycle from which on there is to be one
    std::uint64_t claims_seen = 0;    // adopted so far, observers left out
    std::size_t held = 0;             // of them, those that are still here
};

}  // namespace knurl::servo
