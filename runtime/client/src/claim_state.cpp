#include "claim_state.hpp"

#include <cmath>
#include <cstring>
#include <utility>

#include <knurl/client/error.hpp>
#include <knurl/link/clock.hpp>
#include <knurl/link/text.hpp>

#include "client_state.hpp"
#include "sentence.hpp"
#include "validate.hpp"

namespace knurl::detail {

namespace {

using std::chrono::nanoseconds;

nanoseconds from_seconds(double seconds) {
    return nanoseconds(std::llround(seconds * 1e9));
}

Lateness in_seconds(double latency, nanoseconds interval) {
    return {.latency = latency, .interval = std::chrono::duration<double>(interval).count()};
}

}  // namespace

ClaimState::ClaimState(std::shared_ptr<ClientState> client, std::string device,
                       const protocol::ClaimRequest& request)
    : Reader(std::move(client), std::move(device), request) {}

Entry& ClaimState::entry(RepresentationId id) {
    if (Entry* found = table_.find(id)) return *found;
    throw Error(
        Error::Kind::stale_handle,
        detail::format(
            "device '{}': slot {} holds no representation of generation {}; it was removed, or refused",
            device_name(), id.slot, id.generation));
}

void ClaimState::set(RepresentationId id, Kind kind, const void* params, std::size_t bytes) {
    const Lock lock = enter();
    entry(id);
    validate(kind, params, bytes);
    require_asset(kind, params);
    park_sides(id, 0);
    table_.set(id, {static_cast<const std::byte*>(params), bytes});
    if (last_) note_basis(last_->cycle);
}

void ClaimState::get(RepresentationId id, Kind kind, std::span<std::byte> params) {
    const Lock lock = enter();
    const Entry& found = entry(id);
    if (params.size() != found.params.size())
        throw Error(Error::Kind::bad_parameters,
                    detail::format("{}: room for {} bytes of parameters, which are {}", kinds()[kind].name,
                                   params.size(), found.params.size()));
    std::memcpy(params.data(), found.params.data(), params.size());
}

std::uint64_t ClaimState::commit() {
    const Lock lock = enter();
    if (!groups_.empty())
        throw Error(Error::Kind::refused,
                    "commit() inside together(): the group's commands are not sent yet; commit after it");
    const std::int64_t now = monotonic_ns();
    if (last_commit_ns_ != 0) intervals_.add(static_cast<double>(now - last_commit_ns_) * 1e-9);
    last_commit_ns_ = now;
    ++sequence_;
    silent_.restart();
    if (hints()) look_for_force(now);
    if (channel() == nullptr) {
        table_.committed_for_replay();
        basis_cycle_ = 0;
        return sequence_;
    }
    refresh();
    // An empty commit was computed from no report. Its age would make the application look faster than it is.
    if (!table_.changed())
        basis_cycle_ = 0;
    else if (basis_cycle_ == 0 && last_)
        basis_cycle_ = last_->cycle;
    const std::span<const std::byte> entries = table_.batch();
    const protocol::BatchHeader header{.sequence = sequence_,
                                       .commands_before = issued_,
                                       .report_cycle = std::exchange(basis_cycle_, 0),
                                       .commit_ns = now,
                                       .entries = table_.batch_entries(),
                                       .bytes = static_cast<std::uint32_t>(entries.size())};
    const bool previous_taken = channel()->publish(header, entries);
    table_.published(previous_taken);
    if (previous_taken && sequence_ > first_of_channel_ + 1) ++taken_;
    if (!deferred_.empty()) throw Error(Error::Kind::refused, std::exchange(deferred_, {}));
    return sequence_;
}

bool ClaimState::wait_applied(std::uint64_t number, nanoseconds timeout) {
    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::min(timeout, nanoseconds(std::chrono::hours(1)));
    Lock lock = enter();
    if (number == 0) number = sequence_;
    bool waited = false;
    for (;;) {
        if (!attachment_) return false;
        refresh();
        const nanoseconds left = deadline - Clock::now();
        const bool applied = feedback_.batch >= number;
        const bool refused = feedback_.refused_batch >= number && !deferred_.empty();
        if (applied || refused || left <= nanoseconds(0)) {
            settle(lock, waited);
            if (refused && !applied) throw Error(Error::Kind::refused, std::exchange(deferred_, {}));
            return applied;
        }
        const std::shared_ptr<ReportSource> source = attachment_->reports;
        lock.unlock();
        source->wait_cycle(std::min(left, longest_sleep));
        waited = true;
        lock = enter();
    }
}

const protocol::FeedbackEntry* ClaimState::feedback_entry(RepresentationId id) const {
    if (id.slot >= feedback_at_.size() || feedback_at_[id.slot] == 0) return nullptr;
    const protocol::FeedbackEntry& found = feedback_entries_[feedback_at_[id.slot] - 1];
    return found.id == id ? &found : nullptr;
}

std::optional<HandFeedback> ClaimState::feedback(RepresentationId id) {
    const Lock lock = enter();
    const std::vector<RepresentationId>& others = entry(id).sides;
    refresh();
    const protocol::FeedbackEntry* found = feedback_entry(id);
    if (found == nullptr) return std::nullopt;
    const HandScales scales = protocol::scales_of(feedback_);
    HandFeedback feedback{
        .force = found->force,
        .torque = found->torque,
        .contact_point = found->contact_point,
        .stiffness = found->stiffness,
        .tangential_stiffness = found->tangential_stiffness,
        .flags = found->flags,
        .cycle = feedback_.cycle,
        .share = feedback_.gain * (kinds()[entry(id).kind].surface ? scales.contacts : scales.effects),
        .damping_share = feedback_.gain * scales.damping};
    for (const RepresentationId side : others) {
        const protocol::FeedbackEntry* other = feedback_entry(side);
        if (other == nullptr || (other->flags & Feedback::touching) == 0) continue;
        if ((feedback.flags & Feedback::touching) == 0) feedback.contact_point = other->contact_point;
        feedback.force = to_plain(to_eigen(feedback.force) + to_eigen(other->force));
        feedback.torque = to_plain(to_eigen(feedback.torque) + to_eigen(other->torque));
        feedback.flags |= other->flags;
    }
    return feedback;
}

std::optional<double> ClaimState::applied_stiffness(RepresentationId id) {
    const std::optional<HandFeedback> newest = feedback(id);
    if (newest) return newest->stiffness;
    const Lock lock = enter();
    const double answered = entry(id).applied_stiffness;
    return answered < 0 ? std::nullopt : std::optional(answered);
}

Timing ClaimState::timing() {
    const Lock lock = enter();
    refresh();
    const bool last_taken = sequence_ > first_of_channel_ && feedback_.batch >= sequence_;
    return {.age_at_use = from_seconds(ages_.median()),
            .interval = interval(),
            .batches = taken_ + (last_taken ? 1 : 0),
            .refused = refused_before_ + feedback_.batches_refused,
            .undersampled = undersampled_};
}

Limits ClaimState::limits() {
    const Lock lock = enter();
    return limits_;
}

Vec3 ClaimState::predicted_position() {
    const Lock lock = enter();
    const std::optional<Report> report = peek(lock);
    if (!report) throw_disconnected();
    note_basis(report->cycle);
    return look_ahead(report->position, report->slow_velocity, lateness(), limits_.metre);
}

nanoseconds ClaimState::interval() const {
    return intervals_.empty() ? from_seconds(request().update_interval) : from_seconds(intervals_.median());
}

Lateness ClaimState::lateness() const {
    return ages_.empty() ? Lateness{} : in_seconds(ages_.median(), interval());
}

void ClaimState::note_basis(std::uint64_t cycle) {
    if (basis_cycle_ == 0 || cycle < basis_cycle_) basis_cycle_ = cycle;
}

void ClaimState::refresh() {
    if (ClaimChannel* open = channel()) {
        drain_replies(*open);
        take_feedback(*open);
    }
}

void ClaimState::on_read() {
    look_for_force(monotonic_ns());
}

void ClaimState::look_for_force(std::int64_t now) {
    constexpr std::int64_t every = 100'000'000, unarmed_for = 3'000'000'000,
                           silent_for = 1'000'000'000;  // ns
    if (now - looked_ns_ < every || (unarmed_.said() && silent_.said())) return;
    looked_ns_ = now;
    if (unarmed_.now(!arm_asked_ && table_.any_issued(), now, unarmed_for))
        hint(device_name(), detail::format("nothing of what was added is felt: arm() was not called{}",
                                           is_back_ ? " since the servo is back" : ""));
    refresh();
    if (!silent_.now(arm_asked_ && feedback_.silence > 0, now, silent_for)) return;
    hint(device_name(),
         detail::format(
             "{}, so the servo takes the program for dead and the force fades: call it once in each "
             "turn of the loop, also when nothing has changed",
             sequence_ > first_of_channel_ ? detail::format("commit() was not called for {:.1f} s",
                                                            static_cast<double>(now - last_commit_ns_) * 1e-9)
                                           : std::string("commit() was never called")));
}

void ClaimState::take_feedback(ClaimChannel& channel) {
    const std::uint64_t refused = feedback_.batches_refused;
    if (!channel.feedback(feedback_, feedback_entries_)) return;
    std::fill(feedback_at_.begin(), feedback_at_.end(), 0);
    for (std::size_t i = 0; i < feedback_entries_.size(); ++i) {
        const std::uint32_t slot = feedback_entries_[i].id.slot;
        if (slot < feedback_at_.size()) feedback_at_[slot] = static_cast<std::uint32_t>(i + 1);
    }
    if (feedback_.batch != measured_batch_ && feedback_.batch_report_cycle != 0 &&
        feedback_.batch_age_ns > 0) {
        measured_batch_ = feedback_.batch;
        ages_.add(static_cast<double>(feedback_.batch_age_ns) * 1e-9);
    }
    if (feedback_.batches_refused <= refused) return;
    table_.refused();
    deferred_ = detail::format("device '{}': {}", device_name(), refused_batch(feedback_));
}

void ClaimState::on_attach(Attachment& attachment, bool again) {
    if (!again) {
        table_ = Table(attachment.terms.capacity);
        feedback_at_.resize(attachment.terms.capacity.representations);
        feedback_entries_.reserve(attachment.terms.capacity.representations);
    }
    limits_ = attachment.terms.limits;
    issued_ = 0;
    arm_asked_ = false;
    is_back_ = again;
    unarmed_.restart();
    silent_.restart();
    for (const Outstanding& command : outstanding_)
        if (command.type == protocol::CommandType::remove) table_.remove(command.id);
    outstanding_.clear();
    answers_.clear();
    feedback_ = {};
    feedback_entries_.clear();
    std::fill(feedback_at_.begin(), feedback_at_.end(), 0);
    measured_batch_ = 0;
    basis_cycle_ = 0;
    first_of_channel_ = sequence_;
    table_.restarted();
    leave_behind(attachment);
    for (const auto& [probe, placement] : probes_) {
        const protocol::PlaceProbeBody body{.probe = probe, .reserved = 0, .placement = placement};
        const auto bytes = std::as_bytes(std::span(&body, 1));
        push_patiently({.type = protocol::CommandType::place_probe, .body = {bytes.begin(), bytes.end()}},
                       attachment);
    }
    for (const RepresentationId id : table_.issued())
        push_patiently(add_command(id, *table_.find_any(id), table_.find_any(id)->committed), attachment);
}

void ClaimState::on_detach() {
    refused_before_ += feedback_.batches_refused;
    feedback_.batches_refused = 0;
}

}  // namespace knurl::detail
