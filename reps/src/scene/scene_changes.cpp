// All changes since the last evaluation act together.

#include <cstring>

#include "scene/scene_core.hpp"

namespace knurl::detail {

void copy(const Record& from, Record& to) noexcept {
    const KindOps& ops = kind_ops()[from.kind];
    static_cast<RecordHead&>(to) = from;
    std::memcpy(to.state, from.state, ops.state_size);
    std::memcpy(to.params, from.params, ops.params_size);
}

void SceneCore::take_changes() noexcept {
    model_.take_changed([this](std::uint32_t i) {
        ++state_.work.changes;
        const SceneModel::ModelSlot& slot = model_[i];
        if (!(state_.slots[i].twins && slot.geometry_alone && slot.present && reshape(i))) take_slot(i);
        return state_.slots[i].renewed;
    });
    for_each_bit(candidates_.probes(), [this](std::uint32_t p) {
        if (!candidates_.expired(p)) return;
        const bool others = candidates_.collect(p, state_, sets_[p].deepest());
        if (others || sets_[p].old_may_be_near()) sets_.edit();
    });
    sets_.update(model_.taken());
    effects_.update();
    for (const std::uint32_t i : model_.taken()) state_.slots[i].renewed = false;
    model_.forget_taken();
}

// A probe that moves to another place on the hand: its present force becomes an interrupted fade.
void SceneCore::take_placements() noexcept {
    std::uint32_t placed = 0;  // bit mask
    model_.take_placements([&](std::uint32_t p, const ProbePlacement& placement) {
        state_.probes[p].placement = placement;
        candidates_.expire(p);  // its radius may be larger
        sets_.replace_probe(p);
        placed |= 1u << p;
    });
    effects_.replace_probes(placed);
}

void SceneCore::take_slot(std::uint32_t i) noexcept {
    const SceneModel::ModelSlot& slot = model_[i];
    SlotState& state = state_.slots[i];
    const bool was = state.active, is = slot.present;
    if (!was && !is) return;
    state_.feedback_edited = true;
    const bool same = was && is && state.generation == slot.generation;
    const Records& records = state_.records;
    // A slot without a change keeps its twin records. But its recovery may have changed, in one record only.
    if (change(i, was, is, same)) {
        state.twins = same && slot.geometry_alone && records.current(i).stands && records.old(i).stands &&
                      !records.current(i).has_tangential;
    } else {
        state.twins = state.twins && slot.geometry_alone;
    }
    if (!is) return;
    Record& current = state_.records.current(i);
    current.clamped = kind_ops()[slot.kind].requested_stiffness(model_.params(i)) > current.stiffness;
}

bool SceneCore::change(std::uint32_t i, bool was, bool is, bool same) noexcept {
    const Kind kind = model_[i].kind;
    const KindOps& ops = kind_ops()[kind];
    if (is) ops.prepare(model_.params(i), state_.limits, prepared_.data());
    if (same && ops.unchanged(prepared_.data(), state_.records.current(i))) return false;

    const bool was_surface = was && kind_ops()[state_.records.current(i).kind].surface;
    const bool is_surface = is && ops.surface;
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
    state_.slots[i].active = is;
    state_.slots[i].generation = model_[i].generation;
    return true;
}

// The path for a moving hand's planes, a thousand in one batch: it touches only the first cache lines of each
// record. False: the plane does not stand any more.
bool SceneCore::reshape(std::uint32_t i) noexcept {
    const Record& now = state_.records.current(i);
    Record& next = state_.records.old(i);
    const Reshaped done = kind_ops()[now.kind].reshape(model_.params(i), now, next);
    if (done == Reshaped::elsewhere) {
        state_.records.swap_roles(i);
        sets_.reshape(i, fade_time(next, state_.policy));
    }
    return done != Reshaped::moves;
}

void SceneCore::cross_fade(const Record& judged) noexcept {
    sets_.change_of(judged.probe).fade_over(fade_time(judged, state_.policy));
}

// The current record becomes the one that fades out. If its successor is the same surface, it continues with
// its state.
void SceneCore::swap_records(std::uint32_t i, bool same) noexcept {
    Records& records = state_.records;
    records.swap_roles(i);
    if (!same) return;
    const Record& from = records.old(i);
    Record& to = records.current(i);
    static_cast<RecordHead&>(to) = from;
    std::memcpy(to.state, from.state, kind_ops()[from.kind].state_size);
    if (from.has_tangential)
        records.tangential(records.owner(i, false)) = records.tangential(records.owner(i, true));
}

// Makes the new record of a slot from prepared_, in place of the present one. The caller has saved that where
// it is needed.
void SceneCore::renew(std::uint32_t i, const Record* previous) noexcept {
    const SceneModel::ModelSlot& slot = model_[i];
    Records& records = state_.records;
    Record& now = records.current(i);
    TangentialRecord& tangential = records.tangential(records.owner(i, false));
    const Clock& clock = state_.clock;
    const KindOps& ops = kind_ops()[slot.kind];
    ops.install(prepared_.data(), state_.limits, now, tangential);
    now.options = slot.options;
    now.probe = static_cast<std::uint8_t>(slot.options.probe);
    now.reported = slot.options.feedback != 0;
    if (!previous) {
        now.weight = 1;
        records.gap(records.owner(i, false)) = {};
        now.evaluated_cycle = clock.last_timed;  // a new record has nothing to catch up with
    }
    if (now.has_tangential && !(previous && previous->has_tangential)) tangential.shift.setZero();
    ops.adopt(now, previous, state_.probes[now.probe].probe, state_.assets);
    // It stands still until the end of the next cycle that takes time: of this one, or of the next, which
    // lasts a period.
    if (ops.turns && ops.motion(now)->placed != 0) {
        const bool holds = now.options.on_silence == OnSilence::hold;
        now.moved =
            clock.now.of(holds) + (clock.step > 0 && !state_.silence.holds(now) ? 0 : state_.limits.period);
    }
    if (state_.settles) ops.settle(now);
}

// What it was so far is what fades out.
inline void SceneCore::retire_surface(std::uint32_t i, bool same, bool listed) noexcept {
    Record& current = state_.records.current(i);
    // It may be sent to the other side of the probe: then it must know where that was.
    if (same && !current.stands && current.evaluated_cycle < state_.clock.last_timed)
        catch_up(current, state_, sets_[current.probe].now.held);
    sets_.release_old(i);
    effects_.release_old(i);
    if (!listed) candidates_.forget(i, current);
    if (!same) candidates_.lose_sight(i);
    swap_records(i, same);
}

inline void SceneCore::install_surface(std::uint32_t i, const Record& now, bool same, bool listed) noexcept {
    renew(i, same ? &state_.records.old(i) : nullptr);
    state_.any_follows = state_.any_follows || kind_ops()[now.kind].follows;
    sets_.change_of(now.probe).edited = true;
    if (!now.recovers) cross_fade(now);
    if (listed) {
        candidates_.place_again(i, state_);
    } else {
        candidates_.place(i, state_);
    }
}

// After a change, of which `is` says whether the slot is a surface still: its old record fades out, or is not needed.
inline void SceneCore::fade_retired(std::uint32_t i, const Record& now, bool is) noexcept {
    const Record& old = state_.records.old(i);
    // One that brings its own changes in does so in place of the cross-fade; but it cannot bring in its
    // absence.
    const bool stays = is && now.probe == old.probe;
    if (!stays) {
        cross_fade(old);
    } else if (old.recovers && !now.recovers) {
        cross_fade(now);
    }
    sets_.change_of(old.probe).edited = true;
    if (!(stays && now.recovers)) sets_.keep_old(i);
}

void SceneCore::change_surface(std::uint32_t i, bool was, bool is, bool same) noexcept {
    const bool listed = same && !candidates_.bounded(i);  // among those that are always candidates
    if (was) retire_surface(i, same, listed);
    const Record& now = state_.records.current(i);
    if (is) install_surface(i, now, same, listed);
    if (was) fade_retired(i, now, is);
    if (is && !was) sets_.add(i);
    if (was && !is) sets_.remove(i);
    state_.slots[i].renewed = true;
    sets_.edit();
}

void SceneCore::change_effect(std::uint32_t i, bool was, bool is, bool same) noexcept {
    Record previous;
    if (was) {
        copy(state_.records.current(i), previous);
        effects_.forget(i);
    }
    if (is) renew(i, same ? &previous : nullptr);
    if (effects_.change(i, was ? &previous : nullptr, is, same)) sets_.release_old(i);
}

}  // namespace knurl::detail
