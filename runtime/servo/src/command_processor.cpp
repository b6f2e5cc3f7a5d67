// Commands: copied once, checked as a group, then executed or refused as a whole.

#include "command_processor.hpp"

#include <algorithm>
#include <cstring>

#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>

#include "load_watch.hpp"

namespace knurl::servo {

using protocol::CommandHeader;
using protocol::CommandType;
using protocol::Reply;
using Code = Verdict::Code;

namespace {

// A claim that was shed comes back with at most half of its representations: else it would be shed again.
bool may_come_back(const Claim::Impl& claim) noexcept {
    return !claim.shed || 2 * claim.scene.size() <= claim.shed_with;
}

Verdict no_time(const Claim::Impl& claim, double load) noexcept {
    return {.code = Code::refused,
            .field = Verdict::no_field,
            .value = load,
            .against = claim.shed ? 0 : LoadWatch::room};
}

constexpr std::size_t no_such_command = ~std::size_t{0};

constexpr std::size_t body_bytes(CommandType type) noexcept {
    switch (type) {
        case CommandType::add:
            return sizeof(protocol::AddBody);
        case CommandType::remove:
            return sizeof(protocol::RemoveBody);
        case CommandType::place_probe:
            return sizeof(protocol::PlaceProbeBody);
        case CommandType::arm:
        case CommandType::disarm:
        case CommandType::reset_fault:
        case CommandType::alive:
            return 0;
    }
    return no_such_command;
}

template <class R>
double stiffness_of(const void* params, const Limits& limits) noexcept {
    if constexpr (requires(const R& r) { r.stiffness; }) {
        R copy;
        std::memcpy(&copy, params, sizeof copy);
        return prepared(copy, limits).stiffness;
    }
    return 0;
}

/// N/m that the servo applies for these (valid) parameters; 0 for kinds without stiffness.
template <class... R>
double applied_stiffness(TypeList<R...>, Kind kind, const void* params, const Limits& limits) noexcept {
    double stiffness = 0;
    ((kind == kind_of<R> ? void(stiffness = stiffness_of<R>(params, limits)) : void()), ...);
    return stiffness;
}

}  // namespace

CommandProcessor::CommandProcessor()
    : cells_(std::size_t{protocol::max_command_cells} * shm::cell_bytes),
      group_(protocol::reply_cells),
      replies_(protocol::reply_cells),
      entries_(protocol::max_batch_bytes) {
    undo_.reserve(protocol::reply_cells);
}

// --------------------------------------------------------------------------------------------- commands

std::uint32_t CommandProcessor::take_commands(Claim::Impl& claim, const Authority& authority,
                                              std::uint32_t most, Nanoseconds now) noexcept {
    shm::SpscConsumer& commands = claim.channels->commands;
    available_ = commands.available();
    copied_ = 0;
    if (commands.corrupt()) {
        claim.fault();
        if (input_log != nullptr) input_log->put(InputType::commands_broken, {as_bytes(claim.number)});
    }
    claim.commands_left = available_ > 0;
    if (available_ == 0) return 0;

    const std::uint32_t budget = claim.from_the_start ? protocol::max_command_cells : most;
    std::uint32_t done = 0;
    bool nonsense = false;
    while (done < available_ && done < budget) {
        // A full ring means that the application does not read its replies. Its commands wait, and none is
        // dropped.
        const std::uint32_t room = claim.channels->replies.free_cells();
        if (room == 0) break;
        const Parsed group = parse_group(claim, done);
        if (group.malformed) {
            nonsense = true;
            malformed(claim, claim.commands_done + group.commands + 1);
            break;
        }
        if (room < group.commands) break;

        const bool accepted = check_group(claim, group.commands, authority);
        for (std::size_t i = 0; accepted && i < group.commands; ++i)
            do_command(claim, group_[i], authority, replies_[i]);
        (accepted ? counts_.commands_done : counts_.commands_refused) += group.commands;
        claim.commands_done += group.commands;
        claim.channels->replies.try_push(replies_.data(), group.commands);
        done += group.cells;
    }
    // The input log gets what this cycle has taken; of malformed commands, all that was read.
    if (const std::uint32_t cells = nonsense ? copied_ : done; input_log != nullptr && cells > 0)
        input_log->put(InputType::commands, {as_bytes(claim.number),
                                             std::span(cells_).first(std::size_t{cells} * shm::cell_bytes)});
    // Commands that wait behind unread replies are no sign of life: their sender may hang.
    if (done > 0) claim.silence.sign_of_life(now);
    commands.pop(done);
    claim.commands_left = done < available_;
    return done;
}

/// Copies the first `cells` cells of the ring into private memory. Each cell is copied once, since its owner
/// may write at any time.
bool CommandProcessor::copied_to(Claim::Impl& claim, std::size_t cells) noexcept {
    if (cells <= copied_) return true;
    if (cells > available_) return false;
    constexpr std::uint32_t chunk = 64;
    const std::uint32_t to =
        std::min(available_, std::max(static_cast<std::uint32_t>(cells), copied_ + chunk));
    claim.channels->commands.peek(copied_, cells_.data() + std::size_t{copied_} * shm::cell_bytes,
                                  to - copied_);
    copied_ = to;
    return true;
}

CommandProcessor::Parsed CommandProcessor::parse_group(Claim::Impl& claim, std::uint32_t from) noexcept {
    Parsed parsed;
    parsed.malformed = true;
    // A group is pushed at once, so all of it is here. A group that continues past the end is malformed, and
    // so is one with more commands than replies can answer.
    for (std::uint32_t at = from;
         parsed.commands < protocol::reply_cells && copied_to(claim, at + std::size_t{1});) {
        const std::byte* message = cells_.data() + std::size_t{at} * shm::cell_bytes;
        const auto header = read_as<CommandHeader>(message);
        const std::size_t body = body_bytes(header.type);
        if (body == no_such_command || header.number != claim.commands_done + 1 + parsed.commands) break;
        if (header.bytes > (header.type == CommandType::add ? protocol::max_parameter_bytes : 0)) break;
        const std::size_t bytes = sizeof(CommandHeader) + body + header.bytes;
        if (header.cells != (bytes + shm::cell_bytes - 1) / shm::cell_bytes ||
            (header.flags & ~protocol::command_flags::all) != 0)
            break;
        if (!copied_to(claim, at + std::size_t{header.cells})) break;
        group_[parsed.commands++] = {.header = header,
                                     .body = message + sizeof(CommandHeader),
                                     .params = message + sizeof(CommandHeader) + body};
        at += header.cells;
        if ((header.flags & protocol::command_flags::more) != 0) continue;
        parsed.cells = at - from;
        parsed.malformed = false;
        break;
    }
    return parsed;
}

void CommandProcessor::malformed(Claim::Impl& claim, std::uint64_t number) noexcept {
    const Reply reply{.command = number,
                      .code = static_cast<std::uint32_t>(Code::refused),
                      .field = Verdict::no_field,
                      .reason = static_cast<std::uint32_t>(protocol::RefusalReason::malformed)};
    claim.channels->replies.try_push(&reply, 1);
    ++counts_.commands_refused;
    claim.fault();
}

/// Checks the commands in order, each as if those before it were executed: on a trial copy of the claim's
/// slots. If one is refused the slots are restored, and none is executed.
bool CommandProcessor::check_group(Claim::Impl& claim, std::size_t commands,
                                   const Authority& authority) noexcept {
    undo_.clear();
    bool reset = false;  // an earlier command of the group resets the fault
    Answer answer;
    std::size_t bad = 0;
    for (; bad < commands; ++bad)
        if (answer = check(claim, group_[bad], authority, reset); !answer) break;

    for (std::size_t i = 0; i < commands; ++i) {
        replies_[i] = Reply{.command = group_[i].header.number, .field = Verdict::no_field};
        if (group_[i].header.type == CommandType::add)
            replies_[i].kind = read_as<protocol::AddBody>(group_[i].body).kind;
        if (bad == commands) continue;
        const Answer whole{{Code::refused}, protocol::RefusalReason::group_refused};
        const Answer& mine = i == bad ? answer : whole;
        replies_[i].code = static_cast<std::uint32_t>(mine.verdict.code);
        replies_[i].field = mine.verdict.field;
        replies_[i].value = mine.verdict.value;
        replies_[i].against = mine.verdict.against;
        replies_[i].reason = mine.verdict.code == Code::contradiction
                                 ? mine.verdict.reason
                                 : static_cast<std::uint32_t>(mine.reason);
    }
    if (bad == commands) return true;
    for (; !undo_.empty(); undo_.pop_back()) claim.slots[undo_.back().first] = undo_.back().second;
    return false;
}

void CommandProcessor::remember(Claim::Impl& claim, std::uint32_t slot) noexcept {
    undo_.emplace_back(slot, claim.slots[slot]);  // at most one per command, so the reserved memory suffices
}

CommandProcessor::Answer CommandProcessor::check(Claim::Impl& claim, const Command& command,
                                                 const Authority& authority, bool& reset) noexcept {
    const auto state = [&](protocol::RefusalReason refusal) -> Answer {
        if (refusal == protocol::RefusalReason::none) return {};
        double value = 0;
        if (refusal == protocol::RefusalReason::in_fault) value = authority.supervisor.faults();
        if (refusal == protocol::RefusalReason::hand_too_fast) value = authority.speed;
        if (refusal == protocol::RefusalReason::cause_persists) value = authority.trouble;
        return {{Code::refused, Verdict::no_field, value}, refusal};
    };
    if (claim.terms.resets && command.header.type != CommandType::reset_fault)
        return state(protocol::RefusalReason::forbidden);
    if ((command.header.flags & protocol::command_flags::restricted) != 0) {
        const DeviceState device = authority.supervisor.state();
        const bool on = device == DeviceState::ramp_up || device == DeviceState::active;
        if (command.header.type == CommandType::reset_fault ||
            (command.header.type == CommandType::arm && !on))
            return state(protocol::RefusalReason::forbidden);
    }
    switch (command.header.type) {
        case CommandType::add:
            return check_add(claim, command, authority.load);
        case CommandType::remove:
            return check_remove(claim, command);
        case CommandType::place_probe: {
            const auto body = read_as<protocol::PlaceProbeBody>(command.body);
            return {check_placement(body.probe, body.placement)};
        }
        case CommandType::arm:
            if (authority.ending) return state(protocol::RefusalReason::disconnected);
            if (!may_come_back(claim))
                return {no_time(claim, authority.load), protocol::RefusalReason::cycle_full};
            return state(authority.supervisor.may_arm(authority.calibrated, authority.speed, reset));
        case CommandType::disarm:
        case CommandType::alive:
            return {};
        case CommandType::reset_fault:
            if (reset) return state(protocol::RefusalReason::not_in_fault);
            reset = true;
            return state(authority.supervisor.may_reset_fault(authority.speed, authority.trouble));
    }
    return state(protocol::RefusalReason::malformed);
}

CommandProcessor::Answer CommandProcessor::check_add(Claim::Impl& claim, const Command& command,
                                                     double load) noexcept {
    const auto body = read_as<protocol::AddBody>(command.body);
    const std::uint32_t slot = body.id.slot;
    // Checks against the slots as this group leaves them: the scene still has what an earlier command
    // removes.
    Verdict verdict = check_vacant(body.id, claim.slots);
    if (verdict) verdict = check_added(body.kind, command.params, command.header.bytes, body.options);
    if (!verdict) return {verdict};
    if (claim.shed || load > LoadWatch::room)
        return {no_time(claim, load), protocol::RefusalReason::cycle_full};
    remember(claim, slot);
    claim.slots[slot] = {.generation = body.id.generation, .kind = body.kind, .present = true};
    return {};
}

CommandProcessor::Answer CommandProcessor::check_remove(Claim::Impl& claim, const Command& command) noexcept {
    const RepresentationId id = read_as<protocol::RemoveBody>(command.body).id;
    if (const Verdict verdict = check_named(id, claim.slots); !verdict) return {verdict};
    remember(claim, id.slot);
    claim.slots[id.slot].present = false;
    return {};
}

void CommandProcessor::do_command(Claim::Impl& claim, const Command& command, const Authority& authority,
                                  Reply& reply) noexcept {
    Answer answer;
    switch (command.header.type) {
        case CommandType::add: {
            const auto body = read_as<protocol::AddBody>(command.body);
            answer.verdict =
                claim.scene.add(body.id, body.kind, command.params, command.header.bytes, body.options);
            reply.applied_stiffness =
                applied_stiffness(Representations{}, body.kind, command.params, claim.terms.limits);
            if (shows) claim.unshown.slot(body.id.slot);
            claim.counts_changed = true;
            break;
        }
        case CommandType::remove: {
            const RepresentationId id = read_as<protocol::RemoveBody>(command.body).id;
            answer.verdict = claim.scene.remove(id);
            if (shows) claim.unshown.slot(id.slot);
            claim.counts_changed = true;
            break;
        }
        case CommandType::place_probe: {
            const auto body = read_as<protocol::PlaceProbeBody>(command.body);
            answer.verdict = claim.scene.place_probe(body.probe, body.placement);
            if (shows) claim.unshown.probe(body.probe);
            break;
        }
        case CommandType::arm:
            answer.reason = authority.supervisor.arm(authority.calibrated, authority.speed);
            claim.armed = answer.reason == protocol::RefusalReason::none;
            if (claim.armed) claim.shed = false;
            claim.joined = (command.header.flags & protocol::command_flags::restricted) != 0;
            break;
        case CommandType::disarm:
            claim.armed = false;
            break;
        case CommandType::reset_fault:
            answer.reason = authority.supervisor.reset_fault(authority.speed, authority.trouble);
            break;
        case CommandType::alive:  // as every command is: take_commands
            break;
    }
    // All commands were checked, so they succeed. If the scene refuses one nevertheless, its owner learns it.
    if (answer.reason != protocol::RefusalReason::none) answer.verdict.code = Code::refused;
    reply.code = static_cast<std::uint32_t>(answer.verdict.code);
    reply.reason = static_cast<std::uint32_t>(answer.reason);
}

}  // namespace knurl::servo
