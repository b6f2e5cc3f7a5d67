#include <algorithm>
#include <new>

#include "effects/effect_stage.hpp"

namespace knurl::detail {

EffectStage::EffectStage(SceneState& state)
    : state_(state),
      candidates_(state.slots.size(), state.probes.size()),
      effects_state_(state.slots.size()),
      effects_(empty_list(state.slots.size())),
      fading_(empty_list(state.slots.size())),
      springs_(state.probes.size()),
      by_kind_(empty_list(state.slots.size())) {
    active_kinds_.reserve(Representations::size);
}

void EffectStage::reset() noexcept {
    std::fill(effects_state_.begin(), effects_state_.end(), EffectState{});
    for (CollapsedSprings& springs : springs_) springs.clear();
    candidates_.reset();
    effects_.clear();
    fading_.clear();
    by_kind_.clear();
    active_kinds_.clear();
    kind_begin_ = {};
    collapsed_ = 0;
    bound_ = {};
    bound_stale_ = false;
    edited_ = true;
}

bool EffectStage::change(std::uint32_t i, Record* previous, bool is, bool same) noexcept {
    const bool keeps_old = fade_in(i, previous, is, same);
    if (is && effects_state_[i].evaluated != is_needed(i)) edited_ = true;
    return keeps_old;
}

bool EffectStage::fade_in(std::uint32_t i, Record* previous, bool is, bool same) noexcept {
    EffectState& effect = effects_state_[i];
    const Record& now = state_.records.current(i);
    const KindOps& ops = kind_ops()[now.kind];
    bound_stale_ = true;
    if (is) candidates_.place(i, now);
    if (is && !previous) join(effects_, i, effect.place);
    if (previous && !is)
        leave(effects_, i,
              [this](std::uint32_t slot) -> std::uint32_t& { return effects_state_[slot].place; });
    if (is != (previous != nullptr) || previous->kind != now.kind || now.kind == kind_of<Spring>)
        edited_ = true;

    if (same && ops.carry(*previous, now)) {
        // The only change is of values that move gradually by themselves. A fade in progress continues, and
        // its old end moves along.
        if (effect.from == FadeFrom::record && effect.carries) ops.carry(state_.records.old(i), now);
        return false;
    }
    const double time = state_.settles ? 0 : fade_time(is ? now : *previous, state_.policy);
    if (effect.from != FadeFrom::none) {  // an interrupted fade continues from the present wrench
        effect.frozen = effect.last;
        start_fade(i, FadeFrom::frozen, time);
    } else if (previous) {
        copy(*previous, state_.records.old(i));
        effect.carries = same;
        start_fade(i, FadeFrom::record, time);
        return true;
    } else {
        start_fade(i, FadeFrom::nothing, time);
    }
    return false;
}

void EffectStage::release_old(std::uint32_t i) noexcept {
    EffectState& effect = effects_state_[i];
    if (effect.from != FadeFrom::record) return;
    effect.frozen = effect.remnant;
    effect.from = FadeFrom::frozen;
    effect.time -= effect.elapsed;
    effect.elapsed = 0;
}

void EffectStage::replace_probes(std::uint32_t probes) noexcept {
    for_each_bit(probes, [this](std::uint32_t p) { candidates_.expire(p); });
    bound_stale_ = bound_stale_ || !effects_.empty();
    for (const std::uint32_t i : effects_) {
        Record& r = state_.records.current(i);
        if ((probes >> r.probe & 1) == 0) continue;
        EffectState& effect = effects_state_[i];
        const ProbeState& probe = state_.probes[r.probe];
        if (!effect.evaluated) edited_ = true;
        if (effect.collapsed) {
            effect.last = at_hand(kind_ops()[r.kind].evaluate(r, probe.probe, 0), probe);
            edited_ = true;
        }
        effect.frozen = effect.last;
        start_fade(i, FadeFrom::frozen, state_.policy.automatic);
    }
}

void EffectStage::update() noexcept {
    for_each_bit(candidates_.probes(), [this](std::uint32_t p) {
        if (!candidates_.expired(p)) return;
        by_kind_.resize(effects_state_.size());  // scratch: list() fills it anew
        candidates_.collect(p, effects_, by_kind_, state_);
        edited_ = true;
    });
    if (edited_) list();
    if (bound_stale_) bound_all();
}

void EffectStage::start_fade(std::uint32_t i, FadeFrom from, double time) noexcept {
    EffectState& effect = effects_state_[i];
    const bool listed = effect.from != FadeFrom::none;
    if (!(time > 0) && !listed) {
        effect.gain = 1;
        return;
    }
    effect.from = from;  // where the fade is to end at once, the advance of the fades ends it
    effect.elapsed = 0;
    effect.time = time;
    if (!listed) fading_.push_back(i);
}

// A fading effect is evaluated, and so is its old end. An effect that a silence has faded out stays so until
// the silence moves it.
bool EffectStage::is_needed(std::uint32_t i) const noexcept {
    if (effects_state_[i].from != FadeFrom::none) return true;
    if (!candidates_.may_be_near(i)) return false;
    const Record& r = state_.records.current(i);
    const KindOps& ops = kind_ops()[r.kind];
    const bool gives_nothing = (r.weight == 0 && !state_.silence.moves) || ops.powerless(r);
    return !(gives_nothing && ops.arrived(r));
}

// A spring without feedback, without state of its own at the moment, and which neither a fade nor a silence
// scales.
bool EffectStage::may_collapse(std::uint32_t i) const noexcept {
    const Record& r = state_.records.current(i);
    if (r.kind != kind_of<Spring> || r.options.feedback != 0 || effects_state_[i].from != FadeFrom::none ||
        r.weight != 1 || (state_.silence.moves && r.options.on_silence != OnSilence::hold))
        return false;
    return CollapsedSprings::takes(*std::launder(reinterpret_cast<const Spring*>(r.params)),
                                   *std::launder(reinterpret_cast<const Spring::State*>(r.state)));
}

// Groups the active effects by kind and lists the kinds. Springs that can be collapsed become one.
void EffectStage::list() noexcept {
    for_each_bit(collapsed_, [this](std::uint32_t p) { springs_[p].clear(); });
    collapsed_ = 0;
    std::array<std::uint32_t, Representations::size + 1> next{};
    for (const std::uint32_t i : effects_) {
        const Record& r = state_.records.current(i);
        EffectState& effect = effects_state_[i];
        effect.evaluated = is_needed(i);
        effect.collapsed = effect.evaluated && may_collapse(i);
        if (!effect.evaluated) {
            effect.last = Wrench{};
        } else if (effect.collapsed) {
            springs_[r.probe].add(*std::launder(reinterpret_cast<const Spring*>(r.params)),
                                  std::launder(reinterpret_cast<const Spring::State*>(r.state))->anchor);
            collapsed_ |= 1u << r.probe;
        } else {
            ++next[r.kind + 1];
        }
    }
    for (std::size_t k = 0; k < Representations::size; ++k) next[k + 1] += next[k];
    kind_begin_ = next;
    by_kind_.resize(next.back());
    for (const std::uint32_t i : effects_) {
        if (effects_state_[i].evaluated && !effects_state_[i].collapsed)
            by_kind_[next[state_.records.current(i).kind]++] = i;
    }
    active_kinds_.clear();
    for (Kind k = 0; k < Representations::size; ++k) {
        if (kind_begin_[k + 1] > kind_begin_[k]) active_kinds_.push_back(k);
    }
    edited_ = false;
    bound_stale_ = true;
    state_.feedback_relisted = true;
}

Demand EffectStage::bound_of(const Record& r) const noexcept {
    const KindOps& ops = kind_ops()[r.kind];
    if (ops.load_bound == nullptr) return {};
    const double turned = 1 + state_.shares.turning * state_.probes[r.probe].arm.squaredNorm();
    const Demand bound = ops.load_bound(r, state_.limits);
    return {turned * bound.stiffness, turned * bound.damping};
}

void EffectStage::bound_all() noexcept {
    bound_ = {};
    for (const std::uint32_t i : effects_) {
        if (!effects_state_[i].evaluated) continue;
        const Demand bound = bound_of(state_.records.current(i));
        bound_.stiffness += bound.stiffness;
        bound_.damping += bound.damping;
    }
    bound_stale_ = false;
}

void EffectStage::advance_fades(double dt, Wrench& sum) noexcept {
    for (std::size_t f = 0; f < fading_.size();) {
        const std::uint32_t i = fading_[f];
        EffectState& effect = effects_state_[i];
        effect.elapsed += dt;
        if (effect.elapsed >= effect.time * (1 - 1e-9)) {
            effect.from = FadeFrom::none;
            effect.gain = 1;
            effect.remnant = effect.last = Wrench{};
            edited_ = edited_ || state_.records.current(i).kind == kind_of<Spring> || !is_needed(i);
            fading_[f] = fading_.back();
            fading_.pop_back();
            continue;
        }
        effect.gain = effect.elapsed / effect.time;
        effect.remnant = Wrench{};
        if (effect.from == FadeFrom::record) {
            Record& old = state_.records.old(i);
            const ProbeState& probe = state_.probes[old.probe];
            const KindOps& ops = kind_ops()[old.kind];
            const double step = own_step(old, ops.arrived(old), dt);
            effect.remnant =
                ((1 - effect.gain) * old.weight) * at_hand(ops.evaluate(old, probe.probe, step), probe);
            ++state_.work.evaluated;
        } else if (effect.from == FadeFrom::frozen) {
            effect.remnant = (1 - effect.gain) * effect.frozen;
        }
        effect.last = effect.remnant;  // the loop below adds the effects that are still active
        sum += effect.remnant;
        ++f;
    }
}

namespace {

// The velocity's part in an effect's force is linear.
void scale_velocity(Probe& probe, double scale) noexcept {
    probe.velocity *= scale;
    probe.smooth_velocity *= scale;
    probe.angular_velocity *= scale;
}

}  // namespace

void EffectStage::evaluate(double dt, Wrench& sum) noexcept {
    const HandScales& scales = state_.scales;
    if (scales == HandScales{}) return evaluate_at_probes(dt, sum);
    std::array<Probe, Scene::max_probes> probes;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) {
        probes[p] = state_.probes[p].probe;
        scale_velocity(state_.probes[p].probe, scales.damping / scales.effects);
    });
    Wrench effects;
    evaluate_at_probes(dt, effects);
    sum += scales.effects * effects;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) { state_.probes[p].probe = probes[p]; });
}

void EffectStage::evaluate_at_probes(double dt, Wrench& sum) noexcept {
    if (!fading_.empty()) advance_fades(dt, sum);
    for (const Kind kind : active_kinds_) {
        const std::uint32_t begin = kind_begin_[kind], end = kind_begin_[kind + 1];
        kind_ops()[kind].evaluate_all(*this, {&by_kind_[begin], end - begin}, dt, sum);
        state_.work.evaluated += end - begin;
    }
    for_each_bit(collapsed_, [&](std::uint32_t p) {
        sum += at_hand(springs_[p].evaluate(state_.probes[p].probe), state_.probes[p]);
        state_.work.evaluated += springs_[p].count();
    });
}

}  // namespace knurl::detail
