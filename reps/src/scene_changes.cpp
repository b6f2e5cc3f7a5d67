// All changes since the last evaluate become felt together.

#include <cmath>
#include <cstring>

#include "scene_core.hpp"

namespace knurl::detail {

double SceneCore::fade_time(const Record& record) const noexcept {
    const double time = kind_ops()[record.kind].fade_time(record.params);
    return time == automatic ? policy_.automatic : time;
}

// The old record is about to be overwritten. Whatever still fades from it goes on from the force of this
// moment.
void SceneCore::release_old(std::uint32_t i) noexcept {
    Slot& slot = slots_[i];
    if (slot.old_surface_of >= 0) {
        Group& group = groups_[static_cast<std::uint32_t>(slot.old_surface_of)];
        if (group.fading) {
            group.edited = group.interrupted = true;
            sets_edited_ = true;
        }
        slot.old_surface_of = -1;
    }
    if (slot.from == Slot::From::record) {
        slot.frozen = slot.remnant;
        slot.from = Slot::From::frozen;
        slot.time -= slot.elapsed;
        slot.elapsed = 0;
    }
}

void SceneCore::change_surface(std::uint32_t i, bool was, bool is, bool same, Record& next) noexcept {
    Slot& slot = slots_[i];
    const auto note = [&](std::uint32_t probe, const Record& judged) {
        Group& group = groups_[probe];
        group.edited = true;
        if (judged.recovers) return;
        group.fades = true;
        group.fade_time = std::max(group.fade_time, fade_time(judged));
    };
    if (was) {
        release_old(i);
        old_[i] = now_[i];
        note(old_[i].use.probe, is && next.use.probe == old_[i].use.probe ? next : old_[i]);
    }
    if (is) {
        const Group& group = groups_[next.use.probe];
        if (same) {
            std::memcpy(next.state, old_[i].state, sizeof next.state);
            next.weight = old_[i].weight;
        }
        kind_ops()[next.kind].adopt(next, same ? &old_[i] : nullptr, group.probe);
        if (settle_) kind_ops()[next.kind].settle(next);
        note(next.use.probe, next);
        now_[i] = next;
    }
    if (is && !was) join(surfaces_, surfaces_size_, i);
    if (was && !is) leave(surfaces_, surfaces_size_, i);
    slot.renewed = true;
    sets_edited_ = true;
}

void SceneCore::change_effect(std::uint32_t i, bool was, bool is, bool same, Record& next) noexcept {
    Slot& slot = slots_[i];
    Record previous;
    if (was) previous = now_[i];
    if (is) {
        if (same) {
            std::memcpy(next.state, previous.state, sizeof next.state);
            next.weight = previous.weight;
        }
        const Group& group = groups_[next.use.probe];
        kind_ops()[next.kind].adopt(next, same ? &previous : nullptr, group.probe);
        if (settle_) kind_ops()[next.kind].settle(next);
        now_[i] = next;
    }
    if (is && !was) join(effects_, effects_size_, i);
    if (was && !is) leave(effects_, effects_size_, i);
    if (is != was || previous.kind != next.kind) effects_edited_ = true;

    if (same && kind_ops()[next.kind].carry(previous, next)) {
        // All that changed moves by itself. A fade in progress goes on, its old end moving along.
        if (slot.from == Slot::From::record && slot.carries) kind_ops()[next.kind].carry(old_[i], next);
        return;
    }
    const double time = settle_ ? 0 : fade_time(is ? next : previous);
    if (slot.from != Slot::From::none) {  // overtaken: on from the wrench of this moment
        slot.frozen = slot.last;
        start_effect_fade(i, Slot::From::frozen, time);
    } else if (was) {
        release_old(i);
        old_[i] = previous;
        slot.carries = same;
        start_effect_fade(i, Slot::From::record, time);
    } else {
        start_effect_fade(i, Slot::From::nothing, time);
    }
}

void SceneCore::take_slot(std::uint32_t i) noexcept {
    Slot& slot = slots_[i];
    slot.changed = false;
    const bool was = slot.felt, is = slot.present;
    const bool same = was && is && slot.felt_generation == slot.generation;
    if (!was && !is) return;

    Record next;
    if (is) {
        kind_ops()[slot.kind].prepare(&raw_[i * max_params], limits_, next);
        next.use = slot.use;
        if (same && std::memcmp(next.params, now_[i].params, kind_ops()[slot.kind].params_size) == 0) return;
    }
    const bool was_surface = was && kind_ops()[now_[i].kind].surface;
    const bool is_surface = is && kind_ops()[next.kind].surface;
    if ((was && !was_surface) && (is && is_surface)) {
        change_effect(i, true, false, false, next);
        change_surface(i, false, true, false, next);
    } else if (was_surface && is && !is_surface) {
        Record none;
        change_surface(i, true, false, false, none);
        change_effect(i, false, true, false, next);
    } else if (was_surface || is_surface) {
        change_surface(i, was, is, same, next);
    } else {
        change_effect(i, was, is, same, next);
    }
    slot.felt = is;
    slot.felt_generation = slot.generation;
}

// A probe that sits elsewhere on the hand from now on: what it felt becomes an interrupted fade.
void SceneCore::take_placements() noexcept {
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
        Group& group = groups_[p];
        if (!group.moved) continue;
        group.moved = false;
        group.placement = group.next_placement;
        group.edited = group.fades = group.interrupted = group.replaced = true;
        group.fade_time = policy_.automatic;
        sets_edited_ = true;
    }
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        Slot& slot = slots_[effects_[e]];
        if (!groups_[now_[effects_[e]].use.probe].replaced) continue;
        slot.frozen = slot.last;
        start_effect_fade(effects_[e], Slot::From::frozen, policy_.automatic);
    }
    moved_ = false;
}

void SceneCore::take_changes() noexcept {
    for (std::uint32_t c = 0; c < changed_size_; ++c) take_slot(changed_[c]);
    if (sets_edited_) rebuild_sets();
    if (effects_edited_) list_effects();
    for (std::uint32_t c = 0; c < changed_size_; ++c) slots_[changed_[c]].renewed = false;
    changed_size_ = 0;
}

}  // namespace knurl::detail
