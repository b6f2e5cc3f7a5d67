#pragma once
// What a claim has added, and which of its parameters the servo may not have yet: the client's side of the
// coalescing triple buffer. For each representation the newest parameters are pending until a batch with them
// is known to be taken. A batch contains all that is pending. So any batch that the servo takes contains all
// skipped ones.
//
//   set:        changed
//   published:  was the previous one taken?  yes: pending is what this batch changed
//                                            no: also all that was pending before
//
// A removed slot is no longer pending; entries under way for it carry an old generation, which the servo
// counts and ignores. Has no lock of its own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <knurl/client/predict.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/reps/scene.hpp>

#include "recent.hpp"

namespace knurl::detail {

struct Entry {
    std::uint32_t generation = 0;  // of the latest user of this slot; handles begin at 1
    Kind kind = 0;
    bool live = false;
    bool leaving = false;    // removed in a group that was not sent yet: find() skips it
    bool issued = false;     // its `add` was sent; false in an open group
    bool changed = false;    // since the last batch
    bool in_flight = false;  // in a batch that may not have been taken
    // The same for the parameters behind the geometry. If neither is set, the servo has them, and the
    // geometry is sent alone.
    bool material_changed = false;
    bool material_in_flight = false;
    std::uint64_t version = 0;
    std::uint64_t order = 0;        // of addition; a replay uses this order
    double applied_stiffness = -1;  // N/m, from the servo's answer; below 0: unanswered
    AddOptions options{};
    std::vector<std::byte> params{};     // newest
    std::vector<std::byte> committed{};  // as of the last batch; a new servo gets these
    FollowMemory followed{};
    Recent follow_intervals{};  // s, between calls of follow
    std::int64_t last_follow_ns = 0;
    std::vector<RepresentationId> sides{};  // of a concave corner, added by follow
    std::uint32_t sides_used = 0;           // the others are parked
};

class Table {
  public:
    Table() = default;
    explicit Table(const protocol::ClaimCapacity& capacity);

    /// Throws Error::bad_parameters if the claim's capacity is exhausted, naming which.
    RepresentationId add(Kind kind, std::span<const std::byte> params, const AddOptions& options);
    void remove(RepresentationId id);
    /// Null: removed, or never this claim's.
    Entry* find(RepresentationId id);
    Entry* find_any(RepresentationId id);  // includes one that is leaving
    /// Inside a group: the application no longer sees it, but it stays until the group is sent.
    void set_leaving(RepresentationId id, bool leaving) { entries_[id.slot].leaving = leaving; }
    void set(RepresentationId id, std::span<const std::byte> params);

    std::vector<RepresentationId> live() const;
    /// Live entries whose `add` was sent, in order of addition.
    std::vector<RepresentationId> issued() const;
    bool any_issued() const;
    RepresentationId id_of(std::uint32_t slot) const {
        return {.slot = slot, .generation = entries_[slot].generation};
    }

    /// All that is pending, as the entries of a batch; valid until the next call.
    std::span<const std::byte> batch();
    bool changed() const;  // anything since the last batch
    std::uint32_t batch_entries() const { return static_cast<std::uint32_t>(pending_.size()); }
    /// batch() was published. `previous_taken`: was the one before it taken?
    void published(bool previous_taken);
    /// Like published(), but without a servo: a new one gets everything by replay.
    void committed_for_replay();
    /// A batch was refused: all of it, except geometries, is sent again with the next change.
    void refused();
    /// A new servo has what was committed, and nothing is under way.
    void restarted();

  private:
    void commit_changes();
    void landed();

    protocol::ClaimCapacity capacity_{.representations = 0, .batch_bytes = 0};
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> free_;
    std::vector<std::uint32_t> pending_;  // slots changed or in flight
    std::vector<std::byte> batch_;        // reserved once
    std::size_t bytes_ = 0;               // of all live entries in a batch
    std::uint64_t version_ = 0;
    std::uint64_t order_ = 0;
};

}  // namespace knurl::detail
