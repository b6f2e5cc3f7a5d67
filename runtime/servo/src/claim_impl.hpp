#pragma once
// The servo's side of one claim. One thread owns it at a time: the servo's from adoption to release, else the
// broker's.

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include <knurl/servo/claim.hpp>
#include <knurl/servo/supervisor.hpp>

#include "silence.hpp"
#include "unshown.hpp"

namespace knurl::servo {

/// What the servo knows of a slot of the claim's scene. It is enough to check a whole group of commands
/// before the first is executed.
struct ClaimSlot {
    std::uint32_t generation = 0;
    Kind kind = 0;
    bool present = false;
    std::uint64_t version = 0;           // of the parameters in force
    const std::byte* checked = nullptr;  // the last parameters of this slot in the present batch
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

/// The rings; an observer has none.
struct Channels {
    Channels(std::byte* memory, const protocol::ClaimLayout& layout);

    shm::SpscConsumer commands;
    shm::TripleReader batches;
    shm::SpscProducer replies;
    shm::TripleWriter feedback;
};

/// The feedback of a claim's representations. For a thousand unchanged ones a cycle writes nothing, neither
/// here nor in the three slots of the channel. For each slot of the channel, bits name the entries that have
/// changed since it was written. All its other entries are equal to those here.
class FeedbackEntries {
  public:
    explicit FeedbackEntries(std::size_t most);
    /// True: a surface is touched.
    bool take(Scene& scene) noexcept;
    /// Replaces take() when it would find the same as before.
    void keep() noexcept { news_ = false; }
    /// The last take() has found an entry to write.
    bool news() const noexcept { return news_; }
    void write(shm::TripleWriter& to) noexcept;
    /// After take() has returned true: calls visit(const Feedback&) for what is touched.
    template <class Visit>
    void each_touched(Visit visit) const noexcept {
        for (std::size_t w = 0; w < written_.wholly.size(); ++w) {
            for (std::uint64_t rest = written_.wholly[w]; rest != 0; rest &= rest - 1) {
                const Feedback& entry = entries_[64 * w + static_cast<std::size_t>(std::countr_zero(rest))];
                if ((entry.flags & Feedback::touching) != 0) visit(entry);
            }
        }
    }
    std::size_t size() const noexcept { return size_; }

  private:
    std::vector<Feedback> entries_;
    std::size_t size_ = 0;
    bool news_ = false;
    /// One bit per entry: the whole entry, or only its flags.
    struct Marks {
        std::vector<std::uint64_t> wholly, flags;
    };
    Marks written_;               // in this cycle
    std::array<Marks, 3> stale_;  // by slot of the channel
};

struct Claim::Impl {
    Impl(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row);

    // claim.cpp
    void watch_silence(Nanoseconds now) noexcept;
    /// The claim is empty and its last force has faded: it costs nothing.
    bool quiet() const noexcept { return empty_for > 0.25; }
    /// World wrench of this cycle, before gain and sharing.
    void evaluate(const Probe& device_hand, double dt) noexcept;
    Probe in_world(const Probe& device_hand) const noexcept;
    void advance_gain(double step) noexcept;
    /// The wrench at the device, with frame, gain and sharing applied.
    Wrench device_wrench() const noexcept;
    /// m, of probe 0.
    Eigen::Vector3d device_contact_point() const noexcept;
    /// N/m, device frame, weighted by the gain.
    bool wants_force() const noexcept { return armed && !faulted && !dropping; }
    /// After publish(): the next cycle would change nothing in it, unless its application has sent something.
    bool nothing_to_do() const noexcept;
    void publish(std::uint64_t cycle) noexcept;  // feedback and the row in the device's table
    void publish_missed() noexcept;              // counts what its application says that it missed
    void fault() noexcept { faulted = true; }

    ClaimTerms terms;
    protocol::ClaimLayout layout;
    std::optional<Channels> channels;  // none: the claim is an observer
    shm::WakeTarget wake_target;
    protocol::ClientRow* row;  // null: not shown in a table
    Scene scene;

    std::uint64_t number = 0;  // in order of adoption; names the claim in an input log
    bool armed = false;
    bool joined = false;          // armed while another claim keeps the device on; does not keep it on itself
    bool dropping = false;        // fades out, then goes back to the broker
    bool faulted = false;         // it sent malformed bytes: it fades out and is ignored from now on
    bool shed = false;            // the cycle has no time for it: its scene rests until it arms again
    std::uint32_t shed_with = 0;  // representations
    bool announced = false;       // the device counts it as active
    bool from_the_start = false;  // offline: changes before the first cycle act in full at once
    double gain = 0;
    double gain_lost = 0;       // loss of gain in this cycle
    double empty_for = 0;       // s, without a representation or a force
    HandScales scales;          // of the hand's budget
    Wrench wrench;              // world, of this cycle
    bool touching = false;      // in this cycle, as far as feedback is requested
    bool scene_sleeps = false;  // its scene is out of the hand's reach: see SleepingScene
    SilenceWatch silence;
    double silent_for = 0;  // s
    // Share of the period that it takes, while the servo looks (LoadWatch): in this cycle, and smooth.
    double charged = 0, cost = 0;

    // What CommandProcessor (command_processor.cpp) keeps of this claim.
    std::uint64_t commands_done = 0;
    bool commands_left = false;  // commands wait in the ring for the next cycle
    std::vector<ClaimSlot> slots;
    BatchInForce in_force;
    bool batch_is_new = false;  // taken in this cycle
    RefusedBatch refused;
    std::uint64_t batches_taken = 0, batches_merged = 0;
    std::uint64_t last_sequence = 0;

    std::array<const Asset*, max_assets> assets = {};  // by asset number minus one
    std::uint64_t forgotten = 0;                       // bits: assets on their way back
    static_assert(max_assets <= 64);

    // Feedback's memory.
    FeedbackEntries feedback;
    protocol::FeedbackHeader published;  // the header as last published

    bool counts_changed = true;  // representations were added or removed

    Unshown unshown;  // what the scene log has not of it yet
    // As written there last.
    bool shown_touching = false, shown_asleep = false;
    std::uint32_t shown_probes = 0;  // bit mask
};

}  // namespace knurl::servo
