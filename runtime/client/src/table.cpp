#include "table.hpp"

#include <algorithm>
#include <cstring>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>

namespace knurl::detail {

namespace {

std::size_t padded(std::size_t bytes) {
    return (bytes + 7) / 8 * 8;
}
std::size_t batch_share(std::size_t params) {
    return sizeof(protocol::EntryHeader) + padded(params);
}

}  // namespace

Table::Table(const protocol::ClaimCapacity& capacity) : capacity_(capacity) {
    entries_.resize(capacity.representations);
    for (std::uint32_t slot = capacity.representations; slot-- > 0;) free_.push_back(slot);
    pending_.reserve(capacity.representations);
    batch_.reserve(capacity.batch_bytes);
}

RepresentationId Table::add(Kind kind, std::span<const std::byte> params, const AddOptions& options) {
    if (free_.empty())
        throw Error(Error::Kind::bad_parameters,
                    detail::format(
                        "{}: the claim holds {} representations, all that it asked for; remove one, or claim "
                        "with ClaimOptions::representations up to {}",
                        kinds()[kind].name, entries_.size(), protocol::max_representations));
    // So that a batch that changes everything always fits.
    const std::size_t share = batch_share(params.size());
    if (bytes_ + share > capacity_.batch_bytes)
        throw Error(
            Error::Kind::bad_parameters,
            detail::format(
                "{}: its {} bytes do not fit the claim's batch of {} any more; remove a representation, "
                "or claim with a larger ClaimOptions::representations",
                kinds()[kind].name, share, capacity_.batch_bytes));
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    bytes_ += share;
    Entry& entry = entries_[slot];
    entry = Entry{.generation = entry.generation + 1,
                  .kind = kind,
                  .live = true,
                  .version = ++version_,
                  .order = ++order_,
                  .options = options,
                  .params = {params.begin(), params.end()},
                  .committed = {params.begin(), params.end()}};
    return {.slot = slot, .generation = entry.generation};
}

void Table::remove(RepresentationId id) {
    Entry* entry = find_any(id);
    if (entry == nullptr) return;
    if (entry->changed || entry->in_flight) std::erase(pending_, id.slot);
    bytes_ -= batch_share(entry->params.size());
    *entry = Entry{.generation = entry->generation};
    free_.push_back(id.slot);
}

Entry* Table::find_any(RepresentationId id) {
    if (id.slot >= entries_.size()) return nullptr;
    Entry& entry = entries_[id.slot];
    return entry.live && entry.generation == id.generation ? &entry : nullptr;
}

Entry* Table::find(RepresentationId id) {
    Entry* entry = find_any(id);
    return entry != nullptr && !entry->leaving ? entry : nullptr;
}

void Table::set(RepresentationId id, std::span<const std::byte> params) {
    Entry* entry = find(id);
    if (!entry->changed && !entry->in_flight) pending_.push_back(id.slot);
    entry->changed = true;
    entry->version = ++version_;
    const std::size_t geometry = kinds()[entry->kind].geometry_bytes;
    if (std::memcmp(entry->params.data() + geometry, params.data() + geometry, params.size() - geometry) != 0)
        entry->material_changed = true;
    entry->params.assign(params.begin(), params.end());
}

std::vector<RepresentationId> Table::live() const {
    std::vector<RepresentationId> result;
    for (std::uint32_t slot = 0; slot < entries_.size(); ++slot)
        if (entries_[slot].live) result.push_back(id_of(slot));
    return result;
}

std::vector<RepresentationId> Table::issued() const {
    std::vector<RepresentationId> result;
    for (std::uint32_t slot = 0; slot < entries_.size(); ++slot)
        if (entries_[slot].live && entries_[slot].issued) result.push_back(id_of(slot));
    std::sort(result.begin(), result.end(), [this](RepresentationId a, RepresentationId b) {
        return entries_[a.slot].order < entries_[b.slot].order;
    });
    return result;
}

bool Table::any_issued() const {
    return std::any_of(entries_.begin(), entries_.end(),
                       [](const Entry& entry) { return entry.live && entry.issued; });
}

std::span<const std::byte> Table::batch() {
    batch_.clear();
    for (const std::uint32_t slot : pending_) {
        const Entry& entry = entries_[slot];
        const bool whole = entry.material_changed || entry.material_in_flight;
        const std::size_t size = whole ? entry.params.size() : kinds()[entry.kind].geometry_bytes;
        const protocol::EntryHeader header{.id = id_of(slot),
                                           .kind = entry.kind,
                                           .bytes = static_cast<std::uint32_t>(size),
                                           .version = entry.version};
        const auto bytes = std::as_bytes(std::span(&header, 1));
        batch_.insert(batch_.end(), bytes.begin(), bytes.end());
        const auto params = std::span(entry.params).first(size);
        batch_.insert(batch_.end(), params.begin(), params.end());
        batch_.resize(padded(batch_.size()));
    }
    return batch_;
}

bool Table::changed() const {
    return std::any_of(pending_.begin(), pending_.end(),
                       [this](std::uint32_t slot) { return entries_[slot].changed; });
}

void Table::commit_changes() {
    for (const std::uint32_t slot : pending_) {
        Entry& entry = entries_[slot];
        if (!entry.changed) continue;
        entry.changed = false;
        entry.in_flight = true;
        entry.material_in_flight = entry.material_in_flight || entry.material_changed;
        entry.material_changed = false;
        entry.committed = entry.params;
    }
}

// The previous batches were taken.
void Table::landed() {
    for (const std::uint32_t slot : pending_)
        entries_[slot].in_flight = entries_[slot].material_in_flight = false;
    std::erase_if(pending_, [this](std::uint32_t slot) { return !entries_[slot].changed; });
}

void Table::published(bool previous_taken) {
    if (previous_taken) landed();
    commit_changes();
}

void Table::refused() {
    for (Entry& entry : entries_) entry.material_changed = entry.live;
}

void Table::committed_for_replay() {
    commit_changes();
    restarted();
}

void Table::restarted() {
    landed();
}

}  // namespace knurl::detail
