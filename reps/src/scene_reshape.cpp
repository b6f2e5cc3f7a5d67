// Planes that stand and are put elsewhere, a thousand at a time: their sets keep their members. What was felt
// is copied whole, and the new places are written over it:
//
//   now, edited in place ──copy──> old, in room of its own        (overtaken: the bridge alone is in old)

#include <algorithm>

#include "scene_core.hpp"

namespace knurl::detail {

// As much as the new set takes, where there is less at the end of the arena: false if that is full.
bool SceneCore::make_room_for_old(Group& group) noexcept {
    Arena& a = arenas_[arena_];
    const ContactSet& now = group.now;
    ContactSet& old = group.old;
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

void SceneCore::copy_to_old(Group& group) noexcept {
    Arena& a = arenas_[arena_];
    const ContactSet& now = group.now;
    ContactSet& old = group.old;
    const auto copy = [&](auto& array) {
        std::copy_n(array.begin() + now.begin, now.count + now.summed, array.begin() + old.begin);
    };
    for (const std::span<double>* array : {&a.nx, &a.ny, &a.nz, &a.c, &a.s, &a.b}) copy(*array);
    copy(a.owner);
    for (std::uint32_t m = 0; m < now.moving_count; ++m) {
        Moving& moving = a.moving[old.moving_begin + m] = a.moving[now.moving_begin + m];
        moving.member += old.begin - now.begin;
        a.balls->copy(now.moving_begin + m, old.moving_begin + m);
    }
    old.inside = now.inside;
    old.count = now.count;
    old.standing = now.standing;
    old.summed = now.summed;
    old.moving_count = now.moving_count;
    old.layers = now.layers;
    old.rough = now.rough;
    old.curved = now.curved;
    old.scale = now.scale;
    for (std::uint32_t j = 0; j < now.layers; ++j) old.layer[j] = now.layer[j];
}

// By the bridge, or nothing.
void SceneCore::replace_old(Group& group, std::uint32_t probe) noexcept {
    Arena& a = arenas_[arena_];
    ContactSet& old = group.old;
    const std::uint32_t used = a.used, moving_used = a.moving_used;
    const std::uint32_t room = old.room, moving_room = old.moving_room;
    a.used = old.begin;
    a.moving_used = old.moving_begin;
    build(old, group, a, std::span<const Owner>(scratch_.data(), list_old(group, probe)));
    old.room = room;
    old.moving_room = moving_room;
    a.used = used;
    a.moving_used = moving_used;
}

// False: there is no room, and nothing has been done.
bool SceneCore::reshape_sets() noexcept {
    Arena& a = arenas_[arena_];
    for (Group& group : groups_) {
        if (group.edited && !make_room_for_old(group)) return false;
    }
    contacts_used_ = 0;
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
        Group& group = groups_[p];
        if (!(probes_used_ >> p & 1)) continue;
        if (group.edited) {
            begin_fade(group, p);
            if (group.fading && !group.bridged) {
                copy_to_old(group);
            } else {
                replace_old(group, p);
            }
        }
        const CurvedStarts starts = starts_of(group.now, group);
        forget_solution(group.now, group);
        forget_solution(group.old, group);
        if (!group.edited) take_starts(group.now, a, starts);  // what is new is felt for what it is
        take_starts(group.old, a, starts);
        built(group, p);
    }
    for (std::uint32_t k = 0; k < reshaped_size_; ++k) {
        const std::uint32_t i = reshaped_[k], at = slots_[i].member;
        if (at == gone) continue;  // without stiffness
        const Owner now = owner(i, false);
        const Record& r = record(now);
        const Group& group = groups_[r.probe];
        a.owner[at] = now;
        a.nx[at] = r.plane.normal.x();
        a.ny[at] = r.plane.normal.y();
        a.nz[at] = r.plane.normal.z();
        a.c[at] = r.plane.offset + group.probe.radius;
        a.b[at] = r.plane.damping * (group.now.scale == 1 ? r.weight : 1);
    }
    return true;
}

}  // namespace knurl::detail
