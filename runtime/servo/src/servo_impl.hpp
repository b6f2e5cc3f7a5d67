#pragma once
// What a servo consists of, and the parts of its cycle.

#include <algorithm>
#include <array>
#include <cstdint>

#include <knurl/servo/input_log.hpp>
#include <knurl/servo/scene_log.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/counters.hpp>
#include <knurl/shm/waiter.hpp>

#include "claim_set.hpp"
#include "command_processor.hpp"
#include "load_watch.hpp"
#include "mailbox.hpp"
#include "stage_clock.hpp"
#include "tip_estimator.hpp"

namespace knurl::servo {

/// From the broker.
struct Message {
    enum class What : std::uint32_t {
        adopt,
        drop,
        drop_all,
        input_log,
        scene_log,
        asset,
        forget
    } what = What::adopt;
    Claim* claim = nullptr;
    InputLog* input_log = nullptr;
    RecordLog* scene_log = nullptr;
    const Asset* asset = nullptr;
    std::uint32_t number = 0;           // of the asset
    protocol::AssetDigest digest = {};  // of its source
};

/// How much of what claims send a cycle still takes.
class Intake {
  public:
    explicit Intake(std::size_t claims) noexcept
        : share_(std::clamp(
              protocol::intake_cells_per_cycle / static_cast<std::uint32_t>(std::max(claims, std::size_t{1})),
              protocol::least_command_cells, protocol::command_cells_per_cycle)) {}
    /// Most cells of commands of one claim.
    std::uint32_t share() const noexcept { return share_; }
    void add(std::uint32_t cells) noexcept { cells_ += cells; }
    bool is_full() const noexcept { return cells_ >= protocol::intake_cells_per_cycle; }

  private:
    std::uint32_t share_, cells_ = 0;
};

/// The parts of the cycle, in the order in which `step` calls them, and their state.
struct Servo::Impl {
    Impl(drivers::Device& the_device, Clock& the_clock, std::byte* segment, const ServoOptions& stated);

    double begin_cycle(Nanoseconds deadline, Nanoseconds now) noexcept;
    void read_device(Nanoseconds now) noexcept;
    void take_mail(Nanoseconds now) noexcept;
    void take_changes(Nanoseconds now) noexcept;
    void take_changes_of(Claim::Impl& claim, const Authority& authority, Intake& intake,
                         Nanoseconds now) noexcept;
    Wrench evaluate_claims(Nanoseconds now, double dt) noexcept;
    Supervised supervise(const Wrench& sum, double dt) noexcept;
    void notify_device() noexcept;
    void write_device(Nanoseconds now, const Supervised& out) noexcept;
    void publish(Nanoseconds deadline, const Wrench& sum, const Supervised& out) noexcept;
    void publish_counters(Nanoseconds now) noexcept;
    void publish_parts() noexcept;
    void let_go() noexcept;
    void disarm_claims() noexcept;
    void stop_for(std::uint32_t cause) noexcept;

    /// Finds the claims to process in this cycle: `claims.awake()`.
    void find_awake(Nanoseconds now, double dt) noexcept;
    /// Wakes all claims, at once.
    void wake_claims() noexcept;
    void drop(Claim* claim) noexcept;
    void drop(std::size_t place) noexcept;
    /// Puts a claim of this cycle to sleep, if it has nothing to do.
    void put_to_sleep(std::size_t place) noexcept;
    /// Evaluates the claim's scene, unless it sleeps.
    void evaluate_scene(std::size_t place, const Probe& probe, double dt) noexcept;

    // servo_load.cpp
    void watch_load() noexcept;
    /// Adds the time since `from` to what the claim costs. Returns the present time.
    Nanoseconds charge(Claim::Impl& claim, Nanoseconds from) noexcept;
    void shed_costliest() noexcept;
    void shed(std::size_t place) noexcept;

    // servo_input_log.cpp
    void put_keyframe() noexcept;
    void put_cycle(Nanoseconds deadline, Nanoseconds now) noexcept;
    void put_claim(InputType type, std::uint64_t number) noexcept;
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(first, last_now, budget, enabled, guardian, unplugged, ending, late, report.cycle,
              report.buttons, report.flags, report.presses, report.touches, claims_seen, tip, supervisor,
              stopping, first_taken);
    }

    // servo_scene_log.cpp
    void watch_scenes(RecordLog* log) noexcept;
    /// Writes some of what watchers have not been shown yet.
    void show_scenes() noexcept;
    void show_changes() noexcept;
    void show_contacts() noexcept;
    void show_changes_of(Claim::Impl& claim, std::uint32_t& records, std::uint32_t& slots) noexcept;
    /// True: it wrote a record.
    bool show_felt(Claim::Impl& claim) noexcept;
    template <class... Part>
    void put_scene(SceneRecord type, const Part&... parts) noexcept;

    void adopt(Claim* claim, Nanoseconds now) noexcept;
    void take_asset(const Message& message) noexcept;
    void return_assets(Claim& claim) noexcept;
    FadePolicy fade_for(const Claim::Impl& claim) const noexcept;
    void keep_within_budget(const Probe& probe, double dt) noexcept;
    double nominal(Nanoseconds gap) const noexcept;

    drivers::Device& device;
    Clock& clock;
    std::byte* segment;  // the device's report memory
    ServoOptions options;
    Nanoseconds period;

    StageClock stages;
    LoadWatch load;
    std::uint32_t stopping = 0;  // faults for which the device ramps down
    TipEstimator tip;
    Supervisor supervisor;
    CommandProcessor command_processor;
    shm::BroadcastWriter reports;
    shm::Counters counters;

    ClaimSet claims;
    // The hand in the last cycle whose scenes were evaluated; a scene that wakes gets it.
    Probe passed_hand;
    std::size_t first_taken = 0;  // place among those awake of who has the first turn to be taken from
    bool hand_usable = false;     // time passes, and the hand's position is known
    Mailbox<Message, mailbox_slots> inbox;     // broker -> servo
    Mailbox<Claim*, mailbox_slots> abandoned;  // death watch -> servo
    Mailbox<Claim*, mailbox_slots> outbox;     // servo -> broker
    Mailbox<ReturnedAsset, mailbox_slots> asset_outbox;
    bool ending = false;  // drop_all

    bool first = true;
    Nanoseconds last_now = 0, read_ns = 0, write_ns = 0;
    HandBudget budget;            // of all claims together
    double own_damping = 0;       // N s/m: the device's damping in the bound max_stiffness
    bool settles = false;         // in this cycle: changes from before the start act at once
    bool enabled = false;         // as last sent to the device
    bool guardian = false;        // the guardian zeroed the device before this cycle
    bool guardian_still = false;  // it does not run
    bool unplugged = false;       // this cycle's read, or the last write, found the device unplugged
    std::uint32_t trouble = 0;    // faults that this cycle's sample raises
    bool jumped = false;          // the clock jumped before this cycle: for the input log
    bool written = false;         // in this cycle: the device took the write
    const Claim::Impl* in_contact = nullptr;
    Report report;
    // of the last reports, to compute the age of a batch
    std::array<Nanoseconds, protocol::report_slots> read_times = {};
    std::uint64_t longest_step = 0;  // ns
    std::uint64_t late = 0, overruns = 0, claims_shed = 0, stalls = 0, guardian_zeroings = 0, evaluated = 0,
                  present = 0;

    InputLog* input_log = nullptr;    // null: nobody records
    RecordLog* scene_log = nullptr;   // null: nobody watches
    std::size_t next_shown = 0;       // place of the claim whose changes are shown next
    std::size_t next_felt = 0;        // place of the claim whose contacts are shown next
    std::size_t felt_left = 0;        // claims that are left in this round
    std::uint64_t next_keyframe = 0;  // the first cycle in which a keyframe is due
    std::uint64_t claims_seen = 0;    // claims adopted so far, without observers
    std::size_t held = 0;             // those of them that are still here
};

}  // namespace knurl::servo
