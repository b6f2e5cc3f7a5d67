// All changes since the last evaluate become felt together.

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

// Makes the new record of a slot in place of the present one, which the caller has saved where it is needed.
void SceneCore::renew(std::uint32_t i, const Record* previous) noexcept {
    const Slot& slot = slots_[i];
    Record& now = now_[i];
    const KindOps& ops = kind_ops()[slot.kind];
    now.stiffness = 0;
    now.stands = now.recovers = false;
    ops.prepare(&raw_[i * max_params], limits_, now);
    now.use = slot.use;
    if (!previous) now.weight = 1;
    ops.adopt(now, previous, groups_[now.use.probe].probe);
    if (settle_) ops.settle(now);
}

void SceneCore::change_surface(std::uint32_t i, bool was, bool is, bool same) noexcept {
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
    }
    if (is) {
        renew(i, same ? &old_[i] : nullptr);
        note(now_[i].use.probe, now_[i]);
    }
    if (was) note(old_[i].use.probe, is && now_[i].use.probe == old_[i].use.probe ? now_[i] : old_[i]);
    if (is && !was) join(surfaces_, surfaces_size_, i);
    if (was && !is) leave(surfaces_, surfaces_size_, i);
    slots_[i].renewed = true;
    sets_edited_ = true;
}

void SceneCore::change_effect(std::uint32_t i, bool was, bool is, bool same) noexcept {
    Slot& slot = slots_[i];
    const Record previous = now_[i];
    if (is) renew(i, same ? &previous : nullptr);
    if (is && !was) join(effects_, effects_size_, i);
    if (was && !is) leave(effects_, effects_size_, i);
    if (is != was || previous.kind != now_[i].kind) effects_edited_ = true;

    Record fading = previous;
    if (same && kind_ops()[slot.kind].carry(fading, now_[i])) {
        // All that changed moves by itself. A fade in progress goes on, its old end moving along.
        if (slot.from == Slot::From::record && slot.carries) kind_ops()[slot.kind].carry(old_[i], now_[i]);
        return;
    }
    const double time = settle_ ? 0 : fade_time(is ? now_[i] : previous);
    if (slot.from != Slot::From::none) {  // overtaken: on from the wrench of this moment
        slot.frozen = slot.last;
        start_effect_fade(i, Slot::From::frozen, time);
    } else if (was) {
        release_old(i);
        old_[i] = fading;
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
    if (!was && !is) return;
    const bool same = was && is && slot.felt_generation == slot.generation;
    if (same && kind_ops()[slot.kind].unchanged(&raw_[i * max_params], limits_, now_[i])) return;

    const bool was_surface = was && kind_ops()[now_[i].kind].surface;
    const bool is_surface = is && kind_ops()[slot.kind].surface;
    if (was_surface && is && !is_surface) {
        change_surface(i, true, false, false);
        change_effect(i, false, true, false);
    } else if (was && !was_surface && is_surface) {
        change_effect(i, true, false, false);
        change_surface(i, false, true, false);
    } else if (was_surface || is_surface) {
        change_surface(i, was, is, same);
    } else {
        change_effect(i, was, is, same);
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
        group.replaced = true;
        if (group.now.count == 0 && !group.fading) continue;  // nothing was felt there
        group.edited = group.fades = group.interrupted = true;
        group.fade_time = policy_.automatic;
        sets_edited_ = true;
    }
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        Slot& slot = slots_[effects_[e]];
        if (!groups_[now_[effects_[e]].use.probe].replaced) continue;
        slot.frozen = slot.last;
        start_effect_fade(effects_[e], Slot::From::frozen, policy_.automatic);
    }
    for (Group& group : groups_) group.replaced = group.replaced && group.edited;
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
