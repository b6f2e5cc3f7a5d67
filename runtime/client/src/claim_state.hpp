#pragma once
// One claim: its commands, its pending changes, what the servo answers, and what to tell a servo that has
// restarted.

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
    void get(RepresentationId id, void* params, std::size_t bytes);
    Followed follow(RepresentationId id, Kind kind, const SurfaceModel& model);
    void place_probe(std::uint32_t probe, const ProbePlacement& placement);
    void together(const std::function<void()>& changes);
    /// arm, disarm, reset_fault: sends it and waits for the answer.
    void ask(protocol::CommandType type);

    std::pair<std::uint32_t, std::unique_ptr<AssetTransfer>> begin_sending(AssetMemory source);
    /// It is there, or never will be. False: it was, in a servo that has gone.
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
    /// A command that was not sent, hence not numbered yet: a restart of the servo starts the numbers again.
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
        std::uint64_t sent_to = 0;  // which of the servos that this claim has had
    };

    void bring(Attachment& attachment) override;
    void leave_behind(Attachment& attachment);
    void on_attach(Attachment& attachment, bool again) override;
    void on_detach() override;
    void on_read() override;

    // All of these with `mutex_` held.
    Entry& entry(RepresentationId id);  // throws Error::stale_handle
    RepresentationId add_now(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
    static std::uint32_t asset_of(std::span<const std::byte> params);
    void require_asset(std::uint32_t number) const;  // throws Error
    void require_asset(Kind kind, const void* params) const;
    ClaimChannel* channel() { return attachment_ ? attachment_->channel.get() : nullptr; }
    static Command add_command(RepresentationId id, const Entry& entry, std::span<const std::byte> params);
    void issue(Command command);  // alone, or into the open group; taken back if it throws
    void issue(std::span<const Command> commands);
    void push(std::span<const Command> commands, ClaimChannel& channel);  // all or none
    void push_patiently(const Command& command, Attachment& attachment);
    void apply(const Command& command, bool may_be_refused);  // it is on its way: the claim's own books
    void take_back(std::size_t from);                         // the open group's commands from that one on
    void take_back(const Command& command);
    void wait_for_answer(std::uint64_t number, protocol::CommandType type, Lock& lock);
    void drain_replies(ClaimChannel& channel);
    void answered(const protocol::Reply& reply);
    void take_feedback(ClaimChannel& channel);
    void refresh();
    void look_for_force(std::int64_t now);  // whether it could follow
    std::string about(protocol::CommandType type, Kind kind) const;
    const protocol::FeedbackEntry* feedback_entry(RepresentationId id) const;
    void note_basis(std::uint64_t cycle);
    template <class R>
    Followed follow_with(RepresentationId id, const SurfaceModel& model);
    template <class R>
    void send_faces(RepresentationId id, R params, const Faces& faces);
    template <class R>
    void park(RepresentationId side);
    void park_sides(RepresentationId id, std::uint32_t first);  // of a corner, from that one on
    double far() const;                                         // m, out of the hand's reach
    Lateness lateness() const;
    std::chrono::nanoseconds interval() const;

    Table table_;
    std::map<std::uint32_t, ProbePlacement> probes_;
    std::map<std::uint32_t, KeptAsset> assets_;  // by number
    std::vector<std::uint32_t> brought_;         // to a servo that is back
    Limits limits_;

    int depth_ = 0;  // of together()
    std::vector<Command> group_;

    // Of the present channel.
    std::uint64_t issued_ = 0;                          // commands, numbered from 1
    std::deque<Outstanding> outstanding_;               // not answered yet; answers come in order
    std::map<std::uint64_t, protocol::Reply> answers_;  // of those that somebody waits for
    std::uint64_t first_of_channel_ = 0;                // sequence before its first batch
    std::uint64_t measured_batch_ = 0;
    protocol::FeedbackHeader feedback_;
    std::vector<protocol::FeedbackEntry> feedback_entries_;
    std::vector<std::uint32_t> feedback_at_;  // slot -> index + 1 in feedback_entries_

    std::uint64_t sequence_ = 0;        // of batches
    std::uint64_t taken_ = 0;           // batches that are known to have been taken, in all
    std::uint64_t refused_before_ = 0;  // by earlier servos
    std::uint64_t basis_cycle_ = 0;     // of the report that the oldest uncommitted change came from
    std::int64_t last_commit_ns_ = 0;
    Recent intervals_, ages_;  // s
    std::uint64_t undersampled_ = 0;
    std::string deferred_;  // a refusal that nobody waited for

    bool arm_asked_ = false;  // of the present servo
    bool is_back_ = false;    // it is not the first
    Lasting unarmed_, silent_;
    std::int64_t looked_ns_ = 0;  // for that
};

}  // namespace knurl::detail
