#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <knurl/servo/offline.hpp>
#include <knurl/shm/counters.hpp>

namespace knurl::servo {

using protocol::CommandHeader;
using protocol::CommandType;

OfflineMemory::OfflineMemory(std::size_t bytes)
    : memory_(static_cast<std::byte*>(::operator new (bytes, std::align_val_t{4096}))), size_(bytes) {
    std::memset(memory_.get(), 0, bytes);
}

// ---------------------------------------------------------------------------------------------- the claim

OfflineClaim::OfflineClaim(const ClaimTerms& terms) : OfflineClaim(terms, nullptr, nullptr) {}

OfflineClaim::OfflineClaim(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row)
    : layout_(protocol::claim_layout(terms.capacity)),
      own_(memory == nullptr ? layout_.total : 0),
      memory_(memory == nullptr ? own_.data() : memory),
      servo_side_(terms, memory_, row),
      commands_(memory_ + layout_.commands, layout_.command_cells),
      batches_(memory_ + layout_.batches, layout_.batch_slot_bytes),
      replies_(memory_ + layout_.replies, protocol::reply_cells),
      feedback_(memory_ + layout_.feedback, layout_.feedback_slot_bytes),
      sent_(reinterpret_cast<shm::WaiterFlag*>(memory_ + layout_.waiter)) {}

namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
    return std::as_bytes(std::span<const T, 1>(&value, 1));
}

}  // namespace

void OfflineClaim::push(CommandType type, std::span<const std::byte> body,
                        std::span<const std::byte> params) {
    const std::size_t bytes = sizeof(CommandHeader) + body.size() + params.size();
    const std::size_t cells = (bytes + shm::cell_bytes - 1) / shm::cell_bytes;
    const CommandHeader header{.cells = static_cast<std::uint32_t>(cells),
                               .type = type,
                               .number = ++issued_,
                               .flags = protocol::command_flags::more,
                               .bytes = static_cast<std::uint32_t>(params.size())};
    last_message_ = group_.size();
    group_.resize(group_.size() + cells * shm::cell_bytes);
    std::byte* to = group_.data() + last_message_;
    std::memcpy(to, &header, sizeof header);
    std::copy(body.begin(), body.end(), to + sizeof header);
    std::copy(params.begin(), params.end(), to + sizeof header + body.size());
    if (!in_group_) flush();
}

void OfflineClaim::flush() {
    if (group_.empty()) return;
    const std::uint32_t last = 0;
    std::memcpy(group_.data() + last_message_ + offsetof(CommandHeader, flags), &last, sizeof last);
    const bool fits = commands_.try_push(group_.data(), group_.size() / shm::cell_bytes);
    sent_.add();
    group_.clear();
    if (!fits) throw std::runtime_error("the command ring is full: let the servo take some first (step)");
}

void OfflineClaim::end_group() {
    in_group_ = false;
    flush();
}

void OfflineClaim::add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                       const AddOptions& options) {
    const protocol::AddBody body{.id = id, .kind = kind, .reserved = 0, .options = options};
    const std::span given(static_cast<const std::byte*>(params), bytes);
    push(CommandType::add, bytes_of(body), given);
    if (id.slot >= protocol::max_representations) return;  // the servo refuses it
    if (id.slot >= added_.size()) added_.resize(id.slot + 1);
    added_[id.slot].assign(given.begin(), given.end());
}

void OfflineClaim::remove(RepresentationId id) {
    std::erase_if(pending_, [id](const Pending& p) { return p.id == id; });
    push(CommandType::remove, bytes_of(protocol::RemoveBody{id}), {});
}

void OfflineClaim::place_probe(std::uint32_t probe, const ProbePlacement& placement) {
    push(CommandType::place_probe,
         bytes_of(protocol::PlaceProbeBody{.probe = probe, .reserved = 0, .placement = placement}), {});
}

void OfflineClaim::update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) {
    std::erase_if(pending_, [id](const Pending& p) { return p.id == id; });
    const auto* from = static_cast<const std::byte*>(params);
    const std::size_t geometry = kind < kinds().size() ? kinds()[kind].geometry_bytes : bytes;
    if (id.slot < added_.size() && added_[id.slot].size() == bytes && bytes > geometry) {
        if (std::memcmp(added_[id.slot].data() + geometry, from + geometry, bytes - geometry) == 0)
            bytes = geometry;
        else
            added_[id.slot].clear();
    }
    pending_.push_back({.id = id, .kind = kind, .version = ++version_, .params = {from, from + bytes}});
}

std::uint64_t OfflineClaim::commit(std::uint64_t report_cycle, std::int64_t commit_ns) {
    std::vector<std::byte> entries;
    for (const Pending& p : pending_) {
        const protocol::EntryHeader entry{.id = p.id,
                                          .kind = p.kind,
                                          .bytes = static_cast<std::uint32_t>(p.params.size()),
                                          .version = p.version};
        const auto head = bytes_of(entry);
        entries.insert(entries.end(), head.begin(), head.end());
        entries.insert(entries.end(), p.params.begin(), p.params.end());
        entries.resize((entries.size() + 7) / 8 * 8);
    }
    if (sizeof(protocol::BatchHeader) + entries.size() > layout_.batch_slot_bytes)
        throw std::runtime_error(
            "the batch is larger than the claim's room: give its ClaimTerms a larger capacity");
    const protocol::BatchHeader header{.sequence = ++sequence_,
                                       .commands_before = issued_,
                                       .report_cycle = report_cycle,
                                       .commit_ns = commit_ns,
                                       .entries = static_cast<std::uint32_t>(pending_.size()),
                                       .bytes = static_cast<std::uint32_t>(entries.size())};
    const std::span<const std::byte> parts[] = {bytes_of(header), entries};
    // If the last batch was taken, its content was too. Otherwise this batch replaces it and contains its
    // content.
    if (batches_.publish(issued_, parts))
        std::erase_if(pending_, [](const Pending& p) { return !p.since_last_commit; });
    sent_.add();
    for (Pending& p : pending_) p.since_last_commit = false;
    return sequence_;
}

std::vector<protocol::Reply> OfflineClaim::replies() {
    std::vector<protocol::Reply> all(replies_.available());
    for (protocol::Reply& reply : all) {
        replies_.peek(0, &reply, 1);
        replies_.pop(1);
    }
    return all;
}

const OfflineClaim::FeedbackSet& OfflineClaim::feedback() {
    if (!feedback_.take()) return feedback_set_;
    feedback_.copy(&feedback_set_.header, 0, sizeof feedback_set_.header);
    feedback_set_.entries.resize(feedback_set_.header.entries);
    feedback_.copy(feedback_set_.entries.data(), sizeof feedback_set_.header,
                   feedback_set_.entries.size() * sizeof(protocol::FeedbackEntry));
    return feedback_set_;
}

// ---------------------------------------------------------------------------------------------- the servo

ServoOptions offline_options(double rate) {
    ServoOptions options;
    options.rate = rate;
    options.silence = false;
    options.start_active = true;
    options.rise_speed = std::numeric_limits<double>::infinity();
    options.automatic_recovery = 0.01;
    options.supervisor.off = true;
    return options;
}

Offline::Offline(drivers::Device& device, const ServoOptions& options)
    : device_(device),
      options_(options),
      segment_(protocol::device_layout().total),
      servo_(device, clock_, segment_.data(), options) {}

Offline::~Offline() = default;

OfflineClaim& Offline::claim(const protocol::ClaimCapacity& capacity) {
    ClaimTerms terms;
    terms.capacity = capacity;
    if (options_.supervisor.off)
        terms.limits.period = 1 / options_.rate;
    else
        terms.limits = limits_for(device_.link(), options_.rate, terms.frame);
    return claim(terms);
}

OfflineClaim& Offline::claim(ClaimTerms terms) {
    claims_.push_back(std::make_unique<OfflineClaim>(terms));
    if (!servo_.adopt(&claims_.back()->servo_side()))
        throw std::runtime_error("the servo's mailbox is full: step once in between");
    return *claims_.back();
}

const Report& Offline::step() {
    // t = i/rate, each rounded separately: 3000 cycles at 3 kHz are one second.
    clock_.time = extra_ + std::llround(static_cast<double>(steps_++) * 1e9 / options_.rate);
    servo_.step(clock_.time, clock_.time);
    return servo_.last();
}

const Report& Offline::step_after(Nanoseconds gap, Nanoseconds late) {
    const Nanoseconds at = clock_.time + gap;
    extra_ += at - (extra_ + std::llround(static_cast<double>(steps_++) * 1e9 / options_.rate));
    clock_.time = at;
    servo_.step(at - late, at);
    return servo_.last();
}

std::uint64_t Offline::count(protocol::Count which) const noexcept {
    const shm::CountersReader counters(segment_.data() + protocol::device_layout().counters,
                                       protocol::count_names);
    return counters.read(static_cast<std::size_t>(which));
}

}  // namespace knurl::servo
