#pragma once
// The servo's side of one claim. One thread at a time: the broker's until it is adopted and after it was
// released, the servo's between.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <knurl/servo/claim.hpp>
#include <knurl/servo/supervisor.hpp>

#include "silence.hpp"

namespace knurl::servo {

/// What the servo knows of a slot of the claim's scene: enough to check a group of commands before any is
/// done.
struct ClaimSlot {
    std::uint32_t generation = 0;
    Kind kind = 0;
    bool present = false;
    std::uint64_t version = 0;           // of the parameters in force
    const std::byte* checked = nullptr;  // in the batch at hand: its last parameters for this slot
};

/// The newest batch in force, for feedback.
struct BatchInForce {
    std::uint64_t sequence = 0, cycle = 0, report_cycle = 0;
    std::int64_t commit_ns = 0, write_ns = 0, age_ns = 0;
};

/// The last batch that was refused.
struct RefusedBatch {
    std::uint64_t count = 0, sequence = 0;
    Verdict verdict;
    std::uint32_t kind = 0, slot = 0;
};

/// The rings, if it is no observer.
struct Channels {
    Channels(std::byte* memory, const protocol::ClaimLayout& layout);

    shm::SpscConsumer commands;
    shm::TripleReader batches;
    shm::SpscProducer replies;
    shm::TripleWriter feedback;
};

/// What the application learns of its representations, kept up to date: of a thousand that do not change
/// nothing is written in a cycle, neither here nor in the three slots of the channel. Of each slot it is
/// remembered which entries have changed since it was written; the others stand in it as they stand here.
class FeedbackEntries {
  public:
    explicit FeedbackEntries(std::size_t most);
    /// True: something is touched.
    bool take(Scene& scene) noexcept;
    /// In place of take(): it would find what it found before.
    void keep() noexcept { news_ = false; }
    /// The last take() found something that is written.
    bool news() const noexcept { return news_; }
    void write(shm::TripleWriter& to) noexcept;
    std::size_t size() const noexcept { return size_; }

  private:
    std::vector<Feedback> entries_;
    std::size_t size_ = 0;
    bool news_ = false;
    /// An entry a bit: all of it, or its flags alone.
    struct Marks {
        std::vector<std::uint64_t> wholly, flags;
    };
    Marks written_;               // in this cycle
    std::array<Marks, 3> stale_;  // by slot
};

struct Claim::Impl {
    Impl(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row);

    // claim.cpp
    void watch_silence(Nanoseconds now) noexcept;
    /// Nothing is there, and what was there has faded: it costs nothing.
    bool quiet() const noexcept { return empty_for > 0.25; }
    /// World wrench of this cycle, before gain and sharing.
    void evaluate(const Probe& device_hand, double dt) noexcept;
    Probe in_world(const Probe& device_hand) const noexcept;
    void advance_gain(double step) noexcept;
    /// The wrench as the device feels it: frame, gain and sharing applied.
    Wrench device_wrench() const noexcept;
    /// m, of probe 0.
    Eigen::Vector3d device_contact_point() const noexcept;
    /// N/m, device frame, weighted by the gain.
    bool wants_force() const noexcept { return armed && !faulted && !dropping; }
    /// After publish(): the next cycle would change nothing of it, unless its application has sent something.
    bool nothing_to_do() const noexcept;
    void publish(std::uint64_t cycle) noexcept;  // feedback and the row in the device's table
    void publish_missed() noexcept;              // what its application says that it missed
    void fault() noexcept { faulted = true; }

    ClaimTerms terms;
    protocol::ClaimLayout layout;
    std::optional<Channels> channels;  // none: an observer
    shm::WakeTarget wake_target;
    protocol::ClientRow* row;  // may be null: nobody looks
    Scene scene;

    std::uint64_t number = 0;  // in the order of adoption: its name in an input log
    bool armed = false;
    bool joined = false;          // armed by leave of whoever has the device on: does not keep it on
    bool dropping = false;        // fades, then goes back to the broker
    bool faulted = false;         // its bytes made no sense: ignored from then on, fades
    bool announced = false;       // the device knows that it is active
    bool from_the_start = false;  // offline: what the first cycle finds is in full force at once
    double gain = 0;
    double gain_lost = 0;       // in this cycle
    double empty_for = 0;       // s, without a representation or a force
    HandScales scales;          // of the hand's budget
    Wrench wrench;              // world, of this cycle
    bool touching = false;      // of this cycle, as far as feedback is asked for
    bool scene_sleeps = false;  // its scene is out of the hand's reach: see SleepingScene
    SilenceWatch silence;
    double silent_for = 0;  // s

    // What CommandProcessor (command_processor.cpp) keeps of this claim.
    std::uint64_t commands_done = 0;
    bool commands_left = false;  // in the ring, for the next cycle
    std::vector<ClaimSlot> slots;
    BatchInForce in_force;
    bool batch_is_new = false;  // taken in this cycle
    RefusedBatch refused;
    std::uint64_t batches_taken = 0, batches_merged = 0;
    std::uint64_t last_sequence = 0;

    std::array<const Asset*, max_assets> assets = {};  // by number less one
    std::uint64_t forgotten = 0;                       // bits: of these, on their way back
    static_assert(max_assets <= 64);

    // Feedback's memory.
    FeedbackEntries feedback;
    protocol::FeedbackHeader published;  // as of the last one

    bool counts_changed = true;  // representations came or went
};

}  // namespace knurl::servo
