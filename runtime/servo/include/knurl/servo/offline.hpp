#pragma once

/// @file
/// A servo in this process, on a virtual clock: evaluation of scenes, tests, benchmarks. Changes travel
/// through the very same rings as an application's; only the memory is not shared.
///
///     Offline servo(device);                      // active at once, gain 1, no silence
///     OfflineClaim& hand = servo.claim();
///     RepresentationId floor = hand.add(Plane{.stiffness = 800});
///     hand.commit();
///     const Report& report = servo.step();        // what was sent is in force in this cycle

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include <knurl/drivers/device.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/servo/claim.hpp>
#include <knurl/servo/servo.hpp>

namespace knurl::servo {

/// Zeroed heap memory aligned as a segment is.
class OfflineMemory {
  public:
    /// `bytes` zero bytes.
    explicit OfflineMemory(std::size_t bytes);
    /// The memory.
    std::byte* data() const noexcept { return memory_.get(); }
    /// Its size (bytes).
    std::size_t size() const noexcept { return size_; }

  private:
    struct Free {
        void operator()(std::byte* memory) const noexcept {
            ::operator delete (memory, std::align_val_t{4096});
        }
    };
    std::unique_ptr<std::byte, Free> memory_;
    std::size_t size_;
};

/// The client's end of one claim: writes commands and batches, reads replies and feedback.
class OfflineClaim {
  public:
    /// In memory of its own.
    explicit OfflineClaim(const ClaimTerms& terms);
    /// In memory of the caller, a segment or other zero bytes as long as protocol::claim_layout says. `row`
    /// of the device's table may be null.
    OfflineClaim(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row);

    /// Adds a representation. Each command is pushed at once, as a group of its own, unless begin_group was
    /// called; then end_group pushes them together. Throws std::runtime_error when the ring is full.
    void add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
             const AddOptions& options = {});
    /// Removes a representation. Throws as add does.
    void remove(RepresentationId id);
    /// Places a probe. Throws as add does.
    void place_probe(std::uint32_t probe, const ProbePlacement& placement);
    /// Allows force. Throws as add does.
    void arm() { state_command(protocol::CommandType::arm); }
    /// Takes this claim's force away. Throws as add does.
    void disarm() { state_command(protocol::CommandType::disarm); }
    /// Leaves a fault. Throws as add does.
    void reset_fault() { state_command(protocol::CommandType::reset_fault); }
    /// Renews the claim without a commit. Throws as add does.
    void keep_alive() { state_command(protocol::CommandType::alive); }
    /// The following commands are one group.
    void begin_group() { in_group_ = true; }
    /// Pushes the group. Throws std::runtime_error when the ring is full.
    void end_group();
    /// Number of the last command issued.
    std::uint64_t issued() const noexcept { return issued_; }

    /// New parameters, merged until commit, and on until the servo has taken them. Of a surface whose
    /// geometry alone has changed since it was added, that alone is sent, as the application's client does.
    void update(RepresentationId id, Kind kind, const void* params, std::size_t bytes);
    /// Sends the parameters as one batch; returns its sequence. `report_cycle`: the report from which it was
    /// computed. Throws std::runtime_error if the batch is larger than the claim's room.
    std::uint64_t commit(std::uint64_t report_cycle = 0, std::int64_t commit_ns = 0);

    /// Adds a representation in the lowest slot that was never used, with its next generation.
    template <Described R>
    RepresentationId add(const R& params, const AddOptions& options = {}) {
        const RepresentationId id{next_slot_++, 1};
        add(id, kind_number<R>(), &params, sizeof params, options);
        return id;
    }
    /// New parameters.
    template <Described R>
    void update(RepresentationId id, const R& params) {
        update(id, kind_number<R>(), &params, sizeof params);
    }

    /// Replies that came since the last call, in order of their commands.
    std::vector<protocol::Reply> replies();
    /// Feedback of one cycle.
    struct FeedbackSet {
        /// Of the claim.
        protocol::FeedbackHeader header;
        /// Of each representation.
        std::vector<protocol::FeedbackEntry> entries;
    };
    /// The newest feedback.
    const FeedbackSet& feedback();

    /// The claim's segment.
    std::byte* memory() const noexcept { return memory_; }
    /// Its layout.
    const protocol::ClaimLayout& layout() const noexcept { return layout_; }
    /// The servo's end, for Servo::adopt.
    Claim& servo_side() noexcept { return servo_side_; }

  private:
    struct Pending {
        RepresentationId id;
        Kind kind = 0;
        std::uint64_t version = 0;
        std::vector<std::byte> params;
        bool since_last_commit = true;
    };

    void push(protocol::CommandType type, std::span<const std::byte> body, std::span<const std::byte> params);
    void state_command(protocol::CommandType type) { push(type, {}, {}); }
    void flush();

    protocol::ClaimLayout layout_;
    OfflineMemory own_;  // empty: the caller's
    std::byte* memory_;
    // The two sides may be two threads': no line is of both.
    alignas(128) Claim servo_side_;
    alignas(128) shm::SpscProducer commands_;
    shm::TripleWriter batches_;
    shm::SpscConsumer replies_;
    shm::TripleReader feedback_;
    shm::SentCount sent_;
    std::uint64_t issued_ = 0, sequence_ = 0, version_ = 0;
    std::uint32_t next_slot_ = 0;
    bool in_group_ = false;
    std::vector<std::byte> group_;  // whole cells
    std::size_t last_message_ = 0;  // where the group's last message begins
    std::vector<Pending> pending_;
    // by slot: the parameters that the servo has the rest of; none: all are sent
    std::vector<std::vector<std::byte>> added_;
    FeedbackSet feedback_set_;
};

/// Options that evaluation without a device assumes: active at once with gain 1, no silence, no limits.
ServoOptions offline_options(double rate = 1000);

/// A servo in this process, on a virtual clock. The head of this file has an example.
class Offline {
  public:
    /// A servo of this device, which must live as long.
    explicit Offline(drivers::Device& device, const ServoOptions& options = offline_options());
    ~Offline();

    /// One more claim, taken over in the next step. The frame is the device's own; there are no limits with
    /// `options.supervisor.off`, else the device's.
    OfflineClaim& claim(const protocol::ClaimCapacity& capacity = {});
    /// One more claim with these terms.
    OfflineClaim& claim(ClaimTerms terms);

    /// One cycle, one period after the last; the first is at 0.
    const Report& step();
    /// One cycle that begins `late` after its deadline, `gap` after the last one's.
    const Report& step_after(Nanoseconds gap, Nanoseconds late = 0);

    /// A counter of the device.
    std::uint64_t count(protocol::Count which) const noexcept;
    /// The servo.
    Servo& servo() noexcept { return servo_; }
    /// Its clock.
    VirtualClock& clock() noexcept { return clock_; }
    /// The device's segment.
    std::byte* segment() const noexcept { return segment_.data(); }
    /// The device.
    const drivers::Device& device() const noexcept { return device_; }
    /// The servo's options.
    const ServoOptions& options() const noexcept { return options_; }

  private:
    drivers::Device& device_;
    ServoOptions options_;
    OfflineMemory segment_;
    VirtualClock clock_;
    Servo servo_;
    std::vector<std::unique_ptr<OfflineClaim>> claims_;
    std::uint64_t steps_ = 0;
    Nanoseconds extra_ = 0;  // of gaps other than a period
};

}  // namespace knurl::servo
