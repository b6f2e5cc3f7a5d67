#pragma once
// One claim: its commands, its pending changes, the servo's answers, and what a restarted servo must be told.

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <knurl/client/client.hpp>

#include "asset_source.hpp"
#include "reader.hpp"
#include "recent.hpp"
#include "table.hpp"

namespace knurl::detail {

class ClaimState final : public Reader {
  public:
    ClaimState(std::shared_ptr<ClientState> client, std::string device,
               const protocol::ClaimRequest& request);

    RepresentationId add(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
    void remove(RepresentationId id);
    void set(RepresentationId id, Kind kind, const void* params, std::size_t bytes);
    void get(RepresentationId id, Kind kind, std::span<std::byte> params);
    Followed follow(RepresentationId id, Kind kind, const SurfaceModel& model);
    void place_probe(std::uint32_t probe, const ProbePlacement& placement);
    void together(const std::function<void()>& changes);
    void begin_group();
    void end_group();
    void cancel_group();
    void keep_alive();
    /// arm, disarm, reset_fault: sends the command and waits for the answer.
    void ask(protocol::CommandType type);

    std::pair<std::uint32_t, std::unique_ptr<AssetTransfer>> begin_sending(AssetMemory source);
    /// The transfer has ended: the asset is there, or never will be. False: the servo that had it is gone.
    bool sent(std::uint32_t number, bool there) noexcept;
    void forget(std::uint32_t number);

    std::uint64_t commit();
    bool wait_applied(std::uint64_t number, std::chrono::nanoseconds timeout);
    std::optional<HandFeedback> feedback(RepresentationId id);
    std::optional<double> applied_stiffness(RepresentationId id);
    Timing timing();
    Limits limits();
    Vec3 predicted_position();

  private:
    /// A command that was not sent and has no number yet: a restart of the servo restarts the numbers.
    struct Command {
        protocol::CommandType type{};
        RepresentationId id{};          // of add, remove
        Kind kind = 0;                  // of add, remove
        std::vector<std::byte> body{};  // and parameters
        std::uint32_t parameter_bytes = 0;
    };
    struct Outstanding {
        std::uint64_t number = 0;
        protocol::CommandType type{};
        RepresentationId id;
        Kind kind = 0;
    };

    struct KeptAsset {
        AssetMemory source;
        bool there = false;
        std::uint64_t sent_to = 0;  // index of the servo among those that this claim has had
    };

    void bring(Attachment& attachment) override;
    void leave_behind(Attachment& attachment);
    void on_attach(Attachment& attachment, bool again) override;
    void on_detach() override;
    void on_read() override;

    // All of these need `mutex_`.
    Entry& entry(RepresentationId id);  // throws Error::stale_handle
    RepresentationId add_now(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
    static std::uint32_t asset_of(std::span<const std::byte> params);
    void require_asset(std::uint32_t number) const;  // throws Error
    void require_asset(Kind kind, const void* params) const;
    ClaimChannel* channel() { return attachment_ ? attachment_->channel.get() : nullptr; }
    static Command add_command(RepresentationId id, const Entry& entry, std::span<const std::byte> params);
    void issue(Command command);  // sent alone, or put into the open group; undone if it throws
    void issue(std::span<const Command> commands);
    void push(std::span<const Command> commands, ClaimChannel& channel);  // all or none
    void push_patiently(const Command& command, Attachment& attachment);
    void apply(const Command& command, bool may_be_refused);  // it was sent: updates the claim's tables
    void require_group() const;                               // throws Error: none is open
    void take_back(std::size_t from);                         // undoes the open group's commands from that
                                                              // one on
    void take_back(const Command& command);
    void wait_for_answer(std::uint64_t number, protocol::CommandType type, Lock& lock);
    void drain_replies(ClaimChannel& channel);
    void answered(const protocol::Reply& reply);
    void take_feedback(ClaimChannel& channel);
    void refresh();
    void look_for_force(std::int64_t now);  // checks whether a force could follow
    std::string about(protocol::CommandType type, Kind kind) const;
    const protocol::FeedbackEntry* feedback_entry(RepresentationId id) const;
    void note_basis(std::uint64_t cycle);
    template <class R>
    Followed follow_with(RepresentationId id, const SurfaceModel& model);
    template <class R>
    void send_faces(RepresentationId id, R params, const Faces& faces);
    template <class R>
    void park(RepresentationId side);
    void park_sides(RepresentationId id, std::uint32_t first);  // of a corner, starting at that one
    double far() const;                                         // m, out of the hand's reach
    Lateness lateness() const;
    std::chrono::nanoseconds interval() const;

    Table table_;
    std::map<std::uint32_t, ProbePlacement> probes_;
    std::map<std::uint32_t, KeptAsset> assets_;  // by number
    std::vector<std::uint32_t> brought_;         // to a restarted servo
    Limits limits_;

    std::vector<std::size_t> groups_;  // that are open, one within the other: where each begins in `group_`
    std::vector<Command> group_;

    // For the present channel.
    std::uint64_t issued_ = 0;                          // commands, numbered from 1
    std::deque<Outstanding> outstanding_;               // unanswered ones; answers come in order
    std::map<std::uint64_t, protocol::Reply> answers_;  // for commands on which a call waits
    std::uint64_t first_of_channel_ = 0;                // sequence before its first batch
    std::uint64_t measured_batch_ = 0;
    protocol::FeedbackHeader feedback_;
    std::vector<protocol::FeedbackEntry> feedback_entries_;
    std::vector<std::uint32_t> feedback_at_;  // slot -> index + 1 in feedback_entries_

    std::uint64_t sequence_ = 0;        // of batches
    std::uint64_t taken_ = 0;           // batches known to be taken, in total
    std::uint64_t refused_before_ = 0;  // by earlier servos
    std::uint64_t basis_cycle_ = 0;     // of the report that the oldest uncommitted change came from
    std::int64_t last_commit_ns_ = 0;
    Recent intervals_, ages_;  // s
    std::uint64_t undersampled_ = 0;
    std::string deferred_;  // a refusal for which no call waited

    bool arm_asked_ = false;  // for the present servo
    bool is_back_ = false;    // the servo has restarted
    Lasting unarmed_, silent_;
    std::int64_t looked_ns_ = 0;  // time of the last look_for_force
};

}  // namespace knurl::detail
