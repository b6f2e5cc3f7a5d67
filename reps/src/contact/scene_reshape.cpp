// Moves planes that stand still, a thousand in one batch: their sets keep their members. The present set is
// copied whole, and the new places are written over it:
//
//   now, edited in place ──copy──> old, in room of its own     (interrupted fade: old is the frozen plane)

#include <algorithm>

#include "contact/contact_sets.hpp"

namespace knurl::detail {

void ContactSets::reshape(std::uint32_t i, double fade_time) noexcept {
    const Record& next = state_.records.current(i);
    ContactState& contact = states_[next.probe];
    // The frozen plane stands for the part of `next` that still fades: the edit of the set interrupts its
    // fade.
    contact.change.fade_over(fade_time);
    keep_old(i);
    SetSlot& slot = slots_[i];
    slot.new_in_fade = slot.old_in_fade = contact.fade.next_number();
    state_.feedback_edited = state_.feedback_edited || edited_;
    reshaped_.push_back(i);
}

// Makes as much room as the new set takes, at the end of the arena if needed. False: the arena is full.
bool ContactSets::make_room_for_old(ContactState& contact) noexcept {
    Arena& a = arena();
    const ContactSet& now = contact.now;
    ContactSet& old = contact.old;
    if (old.room < now.room || old.room == 0) {
        const std::uint32_t room = std::max(now.room, 4u);
        if (a.used + room > a.owner.size()) return false;
        old.begin = a.used;
        old.room = room;
        a.used += room;
    }
    if (old.moving_room < now.moving_room) {
        if (a.moving_used + now.moving_room > a.moving.size()) return false;
        old.moving_begin = a.moving_used;
        old.moving_room = now.moving_room;
        a.moving_used += now.moving_room;
    }
    return true;
}

void ContactSets::copy_to_old(ContactState& contact) noexcept {
    Arena& a = arena();
    const ContactSet& now = contact.now;
    ContactSet& old = contact.old;
    const auto copy = [&](auto& array) {
        std::copy_n(array.begin() + now.begin, now.count + now.summed, array.begin() + old.begin);
    };
    for (const std::span<double>* array : {&a.nx, &a.ny, &a.nz, &a.c, &a.s, &a.b}) copy(*array);
    copy(a.owner);
    for (std::uint32_t m = 0; m < now.moving_count; ++m) {
        Moving& moving = a.moving[old.moving_begin + m] = a.moving[now.moving_begin + m];
        moving.member += old.begin - now.begin;
        a.bounding_spheres->copy(now.moving_begin + m, old.moving_begin + m);
    }
    old.inside = now.inside;
    old.count = now.count;
    old.standing = now.standing;
    old.summed = now.summed;
    old.moving_count = now.moving_count;
    old.layers = now.layers;
    old.has_tangential = now.has_tangential;
    old.curved = now.curved;
    old.follows = now.follows;
    old.gaps = now.gaps;
    old.scale = now.scale;
    for (std::uint32_t j = 0; j < now.layers; ++j) old.layer[j] = now.layer[j];
}

// Replaces the old set by the frozen plane, or by nothing.
void ContactSets::replace_old(std::uint32_t p) noexcept {
    Arena& a = arena();
    ContactSet& old = states_[p].old;
    const std::uint32_t used = a.used, moving_used = a.moving_used;
    const std::uint32_t room = old.room, moving_room = old.moving_room;
    a.used = old.begin;
    a.moving_used = old.moving_begin;
    build(old, p, a, list_old(p));
    old.room = room;
    old.moving_room = moving_room;
    a.used = used;
    a.moving_used = moving_used;
}

// False: there is no room, and nothing has changed.
bool ContactSets::reshape_sets(std::span<const std::uint32_t> renewed) noexcept {
    for (ContactState& contact : states_) {
        if (contact.change.edited && !make_room_for_old(contact)) return false;
    }
    Arena& a = arena();
    used_ = 0;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) {
        ContactState& contact = states_[p];
        const Starts starts = starts_of_probe(p);
        if (contact.change.edited) {
            begin_fade(p, renewed);
            if (contact.fade.under_way && !contact.fade.frozen) {
                copy_to_old(contact);
            } else {
                replace_old(p);
            }
        }
        const Eigen::Vector3d& at = state_.probes[p].probe.position;
        forget_solution(contact.now, at);
        forget_solution(contact.old, at);
        take_starts_of_probe(p, a, starts);
        built(p);
    });
    for (const std::uint32_t i : reshaped_) {
        const std::uint32_t at = slots_[i].member;
        if (at == in_no_set) continue;  // without stiffness
        const Owner now = state_.records.owner(i, false);
        const std::uint32_t probe = state_.records[now].probe;
        put_plane(states_[probe].now, probe, a, now, at);
    }
    return true;
}

}  // namespace knurl::detail
