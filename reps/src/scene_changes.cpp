// All changes since the last evaluate become felt together.

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
        if (group.fading && !group.bridged && group.fade == slot.old_in_fade) {
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

// Makes the new record of a slot, from prepared_, in place of the present one, which the caller has saved
// where it is needed.
void SceneCore::renew(std::uint32_t i, const Record* previous) noexcept {
    const Slot& slot = slots_[i];
    Record& now = felt(i);
    const KindOps& ops = kind_ops()[slot.kind];
    ops.install(prepared_.data(), limits_, now, rough(owner(i, false)));
    now.use = slot.use;
    now.probe = static_cast<std::uint8_t>(slot.use.probe);
    now.reported = slot.use.feedback != 0;
    if (!previous) {
        now.weight = 1;
        now.asked = last_timed_;  // there is nothing before that to catch up with
    }
    if (now.rough && !(previous && previous->rough)) rough(owner(i, false)).shift.setZero();
    ops.adopt(now, previous, groups_[now.probe].probe, assets_);
    // It stands until the end of a cycle that takes time: if this one does not, of the next, a period long.
    if (ops.turns && ops.motion(now)->placed != 0) {
        const bool holds = now.use.on_silence == OnSilence::hold, stands = holds && silence_ > 0;
        now.moved = now_.of(holds) + (step_ > 0 && !stands ? 0 : limits_.period);
    }
    if (settle_) ops.settle(now);
}

void copy(const Record& from, Record& to) noexcept {
    const KindOps& ops = kind_ops()[from.kind];
    static_cast<RecordHead&>(to) = from;
    std::memcpy(to.state, from.state, ops.state_size);
    std::memcpy(to.params, from.params, ops.params_size);
}

// What is felt becomes what fades out; its successor, if it is the same surface, goes on from its state.
void SceneCore::turn(std::uint32_t i, bool same) noexcept {
    slots_[i].current ^= 1;
    if (!same) return;
    const Record& from = faded(i);
    Record& to = felt(i);
    static_cast<RecordHead&>(to) = from;
    std::memcpy(to.state, from.state, kind_ops()[from.kind].state_size);
    if (from.rough) rough(owner(i, false)) = rough(owner(i, true));
}

// A change that is cross-faded.
void SceneCore::note_change(const Record& judged) noexcept {
    Group& group = groups_[judged.probe];
    group.edited = group.fades = true;
    group.fade_time = std::max(group.fade_time, fade_time(judged));
}

// What a moving hand's planes are updated in, a thousand at a time: of the records no more than their first
// lines is touched.
void SceneCore::reshape(std::uint32_t i) noexcept {
    Slot& slot = slots_[i];
    slot.changed = false;
    const Record& now = felt(i);
    Record& next = faded(i);
    const bool clamped = now.clamped;
    double recovery = 0;
    if (!kind_ops()[slot.kind].reshape(&raw_[i * max_parameter_bytes], limits_, felt(i), next, recovery)) {
        told_.edited = told_.edited || now.clamped != clamped;
        return;
    }
    slot.current ^= 1;
    Group& group = groups_[next.probe];
    // What still fades from `next` goes on as the bridge: the group is edited, and that interrupts its fade.
    group.edited = group.fades = true;
    group.fade_time = std::max(group.fade_time, recovery == automatic ? policy_.automatic : recovery);
    keep_old(i);
    slot.new_in_fade = slot.old_in_fade = next_fade(group);
    sets_edited_ = sets_edited_ || next.stiffness != now.stiffness;
    told_.edited = told_.edited || sets_edited_ || next.clamped != clamped;
    reshaped_[reshaped_size_++] = i;
}

void SceneCore::change_surface(std::uint32_t i, bool was, bool is, bool same) noexcept {
    const bool listed = same && !slots_[i].bounded;  // among those that are always asked
    if (was) {
        // It may be sent to the other side of the probe: then it must know where that was.
        if (same && !felt(i).stands && felt(i).asked < last_timed_) prime(felt(i), groups_[felt(i).probe]);
        release_old(i);
        if (!listed) forget_surface(i);
        slots_[i].near = slots_[i].near && same;
        turn(i, same);
    }
    if (is) {
        renew(i, same ? &faded(i) : nullptr);
        groups_[felt(i).probe].edited = true;
        if (!felt(i).recovers) note_change(felt(i));
        if (!listed || may_be_far(felt(i))) {
            if (listed) leave(always_, always_size_, i, &Slot::always_place);
            place_surface(i);
        }
    }
    if (was) {
        // One that brings its own changes in does so in place of the cross-fade; but it cannot bring in its
        // absence.
        const bool stays = is && felt(i).probe == faded(i).probe;
        if (!stays) {
            note_change(faded(i));
        } else if (faded(i).recovers && !felt(i).recovers) {
            note_change(felt(i));
        }
        groups_[faded(i).probe].edited = true;
        if (!(stays && felt(i).recovers)) keep_old(i);
    }
    if (is && !was) join(surfaces_, surfaces_size_, i);
    if (was && !is) leave(surfaces_, surfaces_size_, i);
    slots_[i].renewed = true;
    sets_edited_ = true;
}

void SceneCore::change_effect(std::uint32_t i, bool was, bool is, bool same) noexcept {
    Slot& slot = slots_[i];
    effects_bound_stale_ = true;
    Record previous;
    if (was) copy(felt(i), previous);
    if (was) forget_effect(i);
    if (is) renew(i, same ? &previous : nullptr);
    if (is) place_effect(i);
    if (is && !was) join(effects_, effects_size_, i);
    if (was && !is) leave(effects_, effects_size_, i);
    if (is != was || previous.kind != felt(i).kind || felt(i).kind == kind_of<Spring>) effects_edited_ = true;

    Record& fading = previous;
    if (same && kind_ops()[slot.kind].carry(fading, felt(i))) {
        // All that changed moves by itself. A fade in progress goes on, its old end moving along.
        if (slot.from == Slot::From::record && slot.carries) kind_ops()[slot.kind].carry(faded(i), felt(i));
        return;
    }
    const double time = settle_ ? 0 : fade_time(is ? felt(i) : previous);
    if (slot.from != Slot::From::none) {  // overtaken: on from the wrench of this moment
        slot.frozen = slot.last;
        start_effect_fade(i, Slot::From::frozen, time);
    } else if (was) {
        release_old(i);
        copy(fading, faded(i));
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
    told_.edited = true;
    const bool same = was && is && slot.felt_generation == slot.generation;
    const bool shape_alone = same && slot.shape_alone;
    slot.shape_alone = true;
    // Records that stay as they are stay twins, or strangers.
    if (change(i, was, is, same))
        slot.twins = shape_alone && felt(i).stands && faded(i).stands && !felt(i).rough;
    if (is)
        felt(i).clamped =
            kind_ops()[slot.kind].asked_stiffness(&raw_[i * max_parameter_bytes]) > felt(i).stiffness;
}

bool SceneCore::change(std::uint32_t i, bool was, bool is, bool same) noexcept {
    Slot& slot = slots_[i];
    if (is) kind_ops()[slot.kind].prepare(&raw_[i * max_parameter_bytes], limits_, prepared_.data());
    if (same && kind_ops()[slot.kind].unchanged(prepared_.data(), felt(i))) return false;

    const bool was_surface = was && kind_ops()[felt(i).kind].surface;
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
    if (is && !is_surface && slot.asked != to_be_asked(i)) effects_edited_ = true;
    return true;
}

// A probe that sits elsewhere on the hand from now on: what it felt becomes an interrupted fade.
void SceneCore::take_placements() noexcept {
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
        Group& group = groups_[p];
        if (!group.moved) continue;
        group.moved = false;
        group.placement = group.next_placement;
        group.replaced = true;
        group.near.margin = -1;  // it may be larger
        group.near_effects.margin = -1;
        // Nothing was felt there, and there is nothing that a larger probe might reach.
        if (group.now.count == 0 && !group.fading && group.bounded == 0) continue;
        group.edited = group.fades = group.interrupted = true;
        group.fade_time = policy_.automatic;
        sets_edited_ = true;
    }
    effects_bound_stale_ = effects_bound_stale_ || effects_size_ > 0;
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        Slot& slot = slots_[effects_[e]];
        const Group& group = groups_[felt(effects_[e]).probe];
        if (!group.replaced) continue;
        if (!slot.asked) effects_edited_ = true;
        if (slot.collapsed) {
            Record& r = felt(effects_[e]);
            slot.last = at_hand(kind_ops()[r.kind].evaluate(r, group.probe, 0), group);
            effects_edited_ = true;
        }
        slot.frozen = slot.last;
        start_effect_fade(effects_[e], Slot::From::frozen, policy_.automatic);
    }
    for (Group& group : groups_) group.replaced = group.replaced && group.edited;
    moved_ = false;
}

void SceneCore::take_changes() noexcept {
    std::uint32_t others = 0;
    for (std::uint32_t c = 0; c < changed_size_; ++c) {
        const std::uint32_t i = changed_[c];
        const Slot& slot = slots_[i];
        if (slot.twins && slot.shape_alone && slot.present) {
            reshape(i);
        } else {
            take_slot(i);
            changed_[others++] = i;
        }
    }
    changed_size_ = others;
    for (std::uint32_t rest = bounded_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        if (groups_[p].near.margin < 0) collect_near(groups_[p], p);
    }
    if (!sets_edited_ && reshaped_size_ > 0) sets_edited_ = !reshape_sets();
    if (sets_edited_) rebuild_sets();
    reshaped_size_ = 0;
    for (std::uint32_t rest = bounded_effects_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        if (groups_[p].near_effects.margin < 0) collect_effects(groups_[p], p);
    }
    if (effects_edited_) {
        list_effects();
        effects_bound_stale_ = true;
    }
    if (effects_bound_stale_) bound_effects();
    for (std::uint32_t c = 0; c < changed_size_; ++c) slots_[changed_[c]].renewed = false;
    changed_size_ = 0;
}

}  // namespace knurl::detail
