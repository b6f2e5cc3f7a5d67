// Batches of parameters: copied once, checked, then applied or refused as a whole.

#include <knurl/reps/check.hpp>

#include "command_processor.hpp"

namespace knurl::servo {

using Code = Verdict::Code;

std::uint32_t CommandProcessor::take_batch(Claim::Impl& claim, std::uint64_t cycle,
                                           Nanoseconds now) noexcept {
    shm::TripleReader& batches = claim.channels->batches;
    if (!batches.take(claim.commands_done)) {
        if (batches.corrupt()) {
            claim.fault();
            if (input_log != nullptr) input_log->put(InputType::batch_broken, {as_bytes(claim.number)});
        }
        return 0;
    }
    protocol::BatchHeader header;
    batches.copy(&header, 0, sizeof header);
    const bool fits = header.bytes % 8 == 0 && header.bytes <= claim.terms.capacity.batch_bytes &&
                      header.bytes <= entries_.size();
    if (fits) batches.copy(entries_.data(), sizeof header, header.bytes);
    const auto cells = static_cast<std::uint32_t>(fits ? header.bytes / shm::cell_bytes + 1 : 1);

    if (input_log != nullptr)
        input_log->put(InputType::batch, {as_bytes(claim.number), as_bytes(header),
                                          std::span(entries_).first(fits ? header.bytes : 0)});

    ++counts_.batches_taken;
    ++claim.batches_taken;
    claim.silence.renew(now);
    // Sequences count commits. A skipped sequence was merged into this batch.
    if (header.sequence > claim.last_sequence + 1 && claim.last_sequence != 0) {
        const std::uint64_t merged = header.sequence - claim.last_sequence - 1;
        claim.batches_merged += merged;
        counts_.batches_merged += merged;
    }
    claim.last_sequence = header.sequence;

    bad_kind_ = bad_slot_ = 0;
    const Verdict verdict =
        fits ? check_entries(claim, header)
             : Verdict{Code::wrong_size, Verdict::no_field, static_cast<double>(header.bytes)};
    if (!verdict) {
        ++counts_.batches_refused;
        claim.refused = {.count = claim.refused.count + 1,
                         .sequence = header.sequence,
                         .verdict = verdict,
                         .kind = bad_kind_,
                         .slot = bad_slot_};
        return cells;
    }
    apply_entries(claim, header);
    claim.in_force = {.sequence = header.sequence,
                      .cycle = cycle,
                      .report_cycle = header.report_cycle,
                      .commit_ns = header.commit_ns};
    claim.batch_is_new = true;
    return cells;
}

namespace {

/// Visits the entries of a batch. A first walk has checked their headers and stops at the first entry that
/// does not fit. `visit` returns false to stop.
template <class Visit>
bool each_entry(const std::byte* at, const protocol::BatchHeader& header, Visit visit) noexcept {
    const std::byte* const end = at + header.bytes;
    for (std::uint32_t i = 0; i < header.entries; ++i) {
        if (end - at < static_cast<std::ptrdiff_t>(sizeof(protocol::EntryHeader))) return false;
        const auto entry = read_as<protocol::EntryHeader>(at);
        at += sizeof entry;
        if (entry.bytes > protocol::max_parameter_bytes) return false;
        const std::ptrdiff_t padded = (static_cast<std::ptrdiff_t>(entry.bytes) + 7) / 8 * 8;
        if (end - at < padded) return false;
        if (!visit(entry, at)) return false;
        at += padded;
    }
    return at == end;
}

/// Parameters older than those in force, or of a removed representation: an entry may arrive twice, or arrive
/// after its removal was sent.
bool no_op(const Claim::Impl& claim, const protocol::EntryHeader& entry) noexcept {
    return !names_one(entry.id, claim.slots) || entry.version <= claim.slots[entry.id.slot].version;
}

}  // namespace

Verdict CommandProcessor::check_entries(Claim::Impl& claim, const protocol::BatchHeader& header) noexcept {
    if (header.entries > claim.slots.size())
        return {Code::too_many, Verdict::no_field, static_cast<double>(header.entries)};
    Verdict verdict;
    const bool whole =
        each_entry(entries_.data(), header, [&](const protocol::EntryHeader& entry, const std::byte* params) {
            if (no_op(claim, entry)) return true;
            const Verdict found = claim.scene.check_update(entry.id, entry.kind, params, entry.bytes);
            if (found) {
                claim.slots[entry.id.slot].checked = params;
                return true;
            }
            verdict = found;
            bad_kind_ = entry.kind;
            bad_slot_ = entry.id.slot;
            return false;
        });
    if (!verdict) return verdict;
    return whole ? Verdict{}
                 : Verdict{Code::wrong_size, Verdict::no_field, static_cast<double>(header.bytes)};
}

void CommandProcessor::apply_entries(Claim::Impl& claim, const protocol::BatchHeader& header) noexcept {
    each_entry(entries_.data(), header, [&](const protocol::EntryHeader& entry, const std::byte* params) {
        // The scene keeps only the result of the last check. Of two entries for one slot the last counts.
        if (no_op(claim, entry) || claim.slots[entry.id.slot].checked != params) return true;
        claim.slots[entry.id.slot].version = entry.version;
        claim.scene.update_checked(entry.id, params, entry.bytes);
        if (shows) claim.unshown.slot(entry.id.slot);
        return true;
    });
}

}  // namespace knurl::servo
