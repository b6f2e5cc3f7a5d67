// The command channel of a claim.

#include <cstring>
#include <utility>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/shm/spsc_ring.hpp>

#include "claim_state.hpp"
#include "client_state.hpp"
#include "sentence.hpp"
#include "validate.hpp"

namespace knurl::detail {

namespace {

using Clock = std::chrono::steady_clock;
using protocol::CommandType;

constexpr std::chrono::milliseconds longest_answer{1000};  // the servo answers in its next cycle
constexpr std::chrono::milliseconds replay_time{400};      // for all of a claim's representations

/// The fault lies in another command of the group.
bool for_its_group(const protocol::Reply& reply) {
    return static_cast<Verdict::Code>(reply.code) == Verdict::Code::refused &&
           reply.reason == static_cast<std::uint32_t>(protocol::RefusalReason::group_refused);
}

template <class Body>
std::vector<std::byte> bytes_of(const Body& body) {
    const auto bytes = std::as_bytes(std::span(&body, 1));
    return {bytes.begin(), bytes.end()};
}

bool is_asked(CommandType type) {
    return type == CommandType::arm || type == CommandType::disarm || type == CommandType::reset_fault;
}

std::size_t cells_for(std::size_t body_bytes) {
    return (sizeof(protocol::CommandHeader) + body_bytes + shm::cell_bytes - 1) / shm::cell_bytes;
}

}  // namespace

ClaimState::Command ClaimState::add_command(RepresentationId id, const Entry& entry,
                                            std::span<const std::byte> params) {
    const protocol::AddBody body{.id = id, .kind = entry.kind, .reserved = 0, .options = entry.options};
    Command command{.type = CommandType::add,
                    .id = id,
                    .kind = entry.kind,
                    .body = std::vector<std::byte>(sizeof body + params.size()),
                    .parameter_bytes = static_cast<std::uint32_t>(params.size())};
    std::memcpy(command.body.data(), &body, sizeof body);
    std::memcpy(command.body.data() + sizeof body, params.data(), params.size());
    return command;
}

RepresentationId ClaimState::add(Kind kind, const void* params, std::size_t bytes,
                                 const AddOptions& options) {
    const Lock lock = enter();
    return add_now(kind, params, bytes, options);
}

RepresentationId ClaimState::add_now(Kind kind, const void* params, std::size_t bytes,
                                     const AddOptions& options) {
    validate(kind, params, bytes, options);
    require_asset(kind, params);
    const std::span given(static_cast<const std::byte*>(params), bytes);
    const RepresentationId id = table_.add(kind, given, options);
    issue(add_command(id, *table_.find(id), given));
    return id;
}

void ClaimState::remove(RepresentationId id) {
    const Lock lock = enter();
    std::vector<RepresentationId> leaving{id};
    const std::vector<RepresentationId>& others = entry(id).sides;
    leaving.insert(leaving.end(), others.begin(), others.end());
    std::vector<Command> commands;
    for (const RepresentationId one : leaving) {
        const Entry* found = table_.find(one);
        if (found == nullptr) continue;  // a group has taken back this side
        commands.push_back({.type = CommandType::remove,
                            .id = one,
                            .kind = found->kind,
                            .body = bytes_of(protocol::RemoveBody{one})});
        table_.set_leaving(one, true);
    }
    if (groups_.empty())
        issue(commands);
    else
        for (Command& command : commands) issue(std::move(command));
}

void ClaimState::place_probe(std::uint32_t probe, const ProbePlacement& placement) {
    const Lock lock = enter();
    validate(probe, placement);
    issue(
        {.type = CommandType::place_probe,
         .body = bytes_of(protocol::PlaceProbeBody{.probe = probe, .reserved = 0, .placement = placement})});
}

void ClaimState::ask(CommandType type) {
    Lock lock = enter();
    if (channel() == nullptr) throw_disconnected();
    issue({.type = type});
    arm_asked_ = arm_asked_ || type == CommandType::arm;
    if (groups_.empty()) wait_for_answer(issued_, type, lock);
}

void ClaimState::keep_alive() {
    const Lock lock = enter();
    silent_.restart();
    ClaimChannel* const open = channel();
    if (open == nullptr) return;
    drain_replies(*open);
    // Alone, though a group may be open: this may be another thread than the one that makes the group. A full
    // channel has commands in it, which say the same.
    const Command command{.type = CommandType::alive};
    try {
        push({&command, 1}, *open);
    } catch (const Error& error) {
        if (error.kind != Error::Kind::channel_full) throw;
    }
}

void ClaimState::together(const std::function<void()>& changes) {
    begin_group();
    try {
        changes();
    } catch (...) {
        cancel_group();
        throw;
    }
    end_group();
}

void ClaimState::begin_group() {
    const Lock lock = enter();
    groups_.push_back(group_.size());
}

void ClaimState::cancel_group() {
    require_own(made_in_);
    const Lock lock(mutex_);
    require_group();
    take_back(groups_.back());
    groups_.pop_back();
}

void ClaimState::require_group() const {
    if (groups_.empty())
        throw Error(
            Error::Kind::refused,
            detail::format("device '{}': no group is open; begin_group() comes first", device_name()));
}

void ClaimState::end_group() {
    Lock lock = enter();
    require_group();
    groups_.pop_back();
    if (!groups_.empty() || group_.empty()) return;
    std::vector<Command> group;
    group.swap(group_);
    const std::uint64_t first = issued_ + 1;
    issue(group);
    for (std::size_t i = 0; i < group.size(); ++i)
        if (is_asked(group[i].type)) wait_for_answer(first + i, group[i].type, lock);
}

void ClaimState::issue(Command command) {
    if (!groups_.empty())
        group_.push_back(std::move(command));
    else
        issue(std::span<const Command>(&command, 1));
}

void ClaimState::issue(std::span<const Command> commands) {
    try {
        if (ClaimChannel* open = channel()) {
            drain_replies(*open);
            push(commands, *open);
        } else {
            // Commands are kept until the servo returns, except arming, which cannot wait.
            for (const Command& command : commands)
                if (is_asked(command.type)) throw_disconnected();
        }
    } catch (...) {
        for (const Command& command : commands) take_back(command);
        throw;
    }
    // A group may be refused for one of its other commands. So until its answer, a removed representation is
    // only marked as leaving.
    const bool may_be_refused = channel() != nullptr && commands.size() > 1;
    for (const Command& command : commands) apply(command, may_be_refused);
}

void ClaimState::push(std::span<const Command> commands, ClaimChannel& channel) {
    std::vector<std::byte> message;
    std::uint64_t number = issued_;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        const Command& command = commands[i];
        const std::size_t cells = cells_for(command.body.size());
        const protocol::CommandHeader header{
            .cells = static_cast<std::uint32_t>(cells),
            .type = command.type,
            .number = ++number,
            .flags = i + 1 < commands.size() ? protocol::command_flags::more : 0u,
            .bytes = command.parameter_bytes};
        const std::size_t start = message.size();
        message.resize(start + cells * shm::cell_bytes);
        std::memcpy(message.data() + start, &header, sizeof header);
        if (!command.body.empty())
            std::memcpy(message.data() + start + sizeof header, command.body.data(), command.body.size());
    }
    const std::size_t cells = message.size() / shm::cell_bytes;
    // The servo answers a group at once, so there must be room for all its answers.
    if (cells > channel.command_cells() || commands.size() > protocol::reply_cells)
        throw Error(
            Error::Kind::channel_full,
            detail::format("device '{}': a group of {} commands takes {} cells; the command channel has "
                           "{}, for at most {} "
                           "commands; nothing was sent; make it smaller",
                           device_name(), commands.size(), cells, channel.command_cells(),
                           protocol::reply_cells));
    if (!channel.push(message.data(), static_cast<std::uint32_t>(cells)))
        throw Error(
            Error::Kind::channel_full,
            detail::format("device '{}': the command channel is full; nothing was sent; try again after the "
                           "servo's next cycle (wait for a report)",
                           device_name()));
    issued_ = number;
    for (std::size_t i = 0; i < commands.size(); ++i)
        outstanding_.push_back({.number = number - commands.size() + 1 + i,
                                .type = commands[i].type,
                                .id = commands[i].id,
                                .kind = commands[i].kind});
}

void ClaimState::push_patiently(const Command& command, Attachment& attachment) {
    const auto deadline = Clock::now() + replay_time;
    for (;;) {
        try {
            drain_replies(*attachment.channel);
            push({&command, 1}, *attachment.channel);
            return;
        } catch (const Error&) {
            if (Clock::now() > deadline) throw;
        }
        attachment.reports->wait_cycle(longest_sleep);
    }
}

void ClaimState::apply(const Command& command, bool may_be_refused) {
    switch (command.type) {
        case CommandType::add:
            if (Entry* added = table_.find_any(command.id)) added->issued = true;
            break;
        case CommandType::remove:
            if (!may_be_refused) table_.remove(command.id);
            break;
        case CommandType::place_probe: {
            protocol::PlaceProbeBody body;
            std::memcpy(&body, command.body.data(), sizeof body);
            probes_[body.probe] = body.placement;
            break;
        }
        case CommandType::arm:
        case CommandType::disarm:
        case CommandType::reset_fault:
        case CommandType::alive:
            break;
    }
}

void ClaimState::take_back(const Command& command) {
    if (command.type == CommandType::add) table_.remove(command.id);
    if (command.type == CommandType::remove) table_.set_leaving(command.id, false);
}

void ClaimState::take_back(std::size_t from) {
    // In reverse order, so that a representation that was added and removed in one group is restored before
    // it is forgotten.
    while (group_.size() > from) {
        take_back(group_.back());
        group_.pop_back();
    }
}

void ClaimState::wait_for_answer(std::uint64_t number, CommandType type, Lock& lock) {
    const auto deadline = Clock::now() + longest_answer;
    const ClaimChannel* const asked = channel();
    bool waited = false;
    for (;;) {
        if (channel() == nullptr || channel() != asked) throw_disconnected();
        drain_replies(*channel());
        if (const auto found = answers_.find(number); found != answers_.end()) {
            const protocol::Reply reply = found->second;
            answers_.erase(found);
            settle(lock, waited);
            if (static_cast<Verdict::Code>(reply.code) == Verdict::Code::ok) return;
            // The answer to the faulty member says more than "the group was refused".
            if (for_its_group(reply) && !deferred_.empty())
                throw Error(Error::Kind::refused, std::exchange(deferred_, {}));
            throw Error(Error::Kind::refused, refused_command(reply, about(type, 0)));
        }
        if (Clock::now() > deadline) {
            settle(lock, waited);
            throw Error(
                Error::Kind::refused,
                detail::format(
                    "device '{}': the servo has not answered for {} ms; is it stopped? `knurl ls` shows "
                    "its process",
                    device_name(), longest_answer.count()));
        }
        const std::shared_ptr<ReportSource> source = attachment_->reports;
        lock.unlock();
        source->wait_cycle(longest_sleep);
        waited = true;
        lock = enter();
    }
}

void ClaimState::drain_replies(ClaimChannel& channel) {
    protocol::Reply reply;
    for (std::uint32_t n = 0; n < protocol::reply_cells && channel.reply(reply); ++n) answered(reply);
}

void ClaimState::answered(const protocol::Reply& reply) {
    while (!outstanding_.empty() && outstanding_.front().number < reply.command) outstanding_.pop_front();
    if (outstanding_.empty() || outstanding_.front().number != reply.command) return;
    const Outstanding command = outstanding_.front();
    outstanding_.pop_front();
    const bool accepted = static_cast<Verdict::Code>(reply.code) == Verdict::Code::ok;
    if (command.type == CommandType::add) {
        if (!accepted)
            table_.remove(command.id);  // the servo does not have it: the handle is stale
        else if (Entry* added = table_.find_any(command.id))
            added->applied_stiffness = reply.applied_stiffness;
    }
    if (command.type == CommandType::remove && table_.find_any(command.id) != nullptr) {
        if (accepted)
            table_.remove(command.id);
        else
            table_.set_leaving(command.id, false);  // the servo still has it
    }
    if (is_asked(command.type)) {
        answers_[command.number] = reply;
        return;
    }
    // The faulty member of the group has its own answer.
    if (!accepted && !for_its_group(reply))
        deferred_ = refused_command(reply, about(command.type, command.kind));
}

std::string ClaimState::about(CommandType type, Kind kind) const {
    const std::string_view what = kind < kinds().size() ? kinds()[kind].name : "representation";
    switch (type) {
        case CommandType::add:
            return detail::format("device '{}': adding a {}", device_name(), what);
        case CommandType::remove:
            return detail::format("device '{}': removing a {}", device_name(), what);
        case CommandType::place_probe:
            return detail::format("device '{}': placing a probe", device_name());
        case CommandType::arm:
            return detail::format("cannot arm device '{}'", device_name());
        case CommandType::disarm:
            return detail::format("cannot disarm device '{}'", device_name());
        case CommandType::reset_fault:
            return detail::format("cannot reset device '{}'", device_name());
        case CommandType::alive:
            return detail::format("device '{}': keeping the claim alive", device_name());
    }
    return detail::format("device '{}'", device_name());
}

}  // namespace knurl::detail
