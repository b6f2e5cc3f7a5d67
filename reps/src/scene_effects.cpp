// Effects add up; each fades by itself.

#include <new>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

void SceneCore::start_effect_fade(std::uint32_t i, Slot::From from, double time) noexcept {
    Slot& slot = slots_[i];
    const bool listed = slot.from != Slot::From::none;
    if (!(time > 0) && !listed) {
        slot.gain = 1;
        return;
    }
    slot.from = from;  // a listed one that is to end at once does so when the fades are advanced
    slot.elapsed = 0;
    slot.time = time;
    if (!listed) fading_[fading_size_++] = i;
}

// A spring that nobody asks about, that has no state of its own at the moment and that no fade scales, nor a
// silence.
bool SceneCore::may_collapse(std::uint32_t i) const noexcept {
    const Record& r = felt(i);
    if (r.kind != kind_of<Spring> || r.use.feedback != 0 || slots_[i].from != Slot::From::none ||
        r.weight != 1 || (weights_move_ && r.use.on_silence != OnSilence::hold))
        return false;
    return CollapsedSprings::takes(*std::launder(reinterpret_cast<const Spring*>(r.params)),
                                   *std::launder(reinterpret_cast<const Spring::State*>(r.state)));
}

// The felt effects grouped by kind, and the kinds that there are; springs that can be one, made one.
void SceneCore::list_effects() noexcept {
    for (std::uint32_t rest = collapsed_used_; rest != 0; rest &= rest - 1)
        groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))].springs.clear();
    collapsed_used_ = 0;
    std::array<std::uint32_t, Representations::size + 1> next{};
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        const std::uint32_t i = effects_[e];
        const Record& r = felt(i);
        Slot& slot = slots_[i];
        slot.asked = to_be_asked(i);
        slot.collapsed = slot.asked && may_collapse(i);
        if (!slot.asked) {
            slot.last = Wrench{};
        } else if (slot.collapsed) {
            groups_[r.probe].springs.add(
                *std::launder(reinterpret_cast<const Spring*>(r.params)),
                std::launder(reinterpret_cast<const Spring::State*>(r.state))->anchor);
            collapsed_used_ |= 1u << r.probe;
        } else {
            ++next[r.kind + 1];
        }
    }
    for (std::size_t k = 0; k < Representations::size; ++k) next[k + 1] += next[k];
    kind_begin_ = next;
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        if (slots_[effects_[e]].asked && !slots_[effects_[e]].collapsed)
            by_kind_[next[felt(effects_[e]).kind]++] = effects_[e];
    }
    active_kinds_size_ = 0;
    for (Kind k = 0; k < Representations::size; ++k) {
        if (kind_begin_[k + 1] > kind_begin_[k]) active_kinds_[active_kinds_size_++] = k;
    }
    effects_edited_ = false;
    told_.relisted = true;
}

Wrench SceneCore::at_hand(const Wrench& at_probe, const Group& group) const noexcept {
    Wrench w{clamped(at_probe.force, limits_.max_force), clamped(at_probe.torque, limits_.max_torque)};
    if (group.placement.offset != Vec3{}) w.torque += group.arm.cross(w.force);
    return w;
}

void SceneCore::advance_effect_fades(double dt, Wrench& sum) noexcept {
    for (std::uint32_t f = 0; f < fading_size_;) {
        const std::uint32_t i = fading_[f];
        Slot& slot = slots_[i];
        slot.elapsed += dt;
        if (slot.elapsed >= slot.time * (1 - 1e-9)) {
            slot.from = Slot::From::none;
            slot.gain = 1;
            slot.remnant = slot.last = Wrench{};
            effects_edited_ = effects_edited_ || felt(i).kind == kind_of<Spring> || !to_be_asked(i);
            fading_[f] = fading_[--fading_size_];
            continue;
        }
        slot.gain = slot.elapsed / slot.time;
        slot.remnant = Wrench{};
        if (slot.from == Slot::From::record) {
            Record& old = faded(i);
            const Group& group = groups_[old.probe];
            const KindOps& ops = kind_ops()[old.kind];
            const double step = own_step(old, ops.arrived(old), dt);
            slot.remnant =
                ((1 - slot.gain) * old.weight) * at_hand(ops.evaluate(old, group.probe, step), group);
            ++evaluated_;
        } else if (slot.from == Slot::From::frozen) {
            slot.remnant = (1 - slot.gain) * slot.frozen;
        }
        slot.last = slot.remnant;  // those that still have an effect add theirs
        sum += slot.remnant;
        ++f;
    }
}

namespace {

// What an effect makes of velocity is linear in it.
void scale_velocity(Probe& probe, double scale) noexcept {
    probe.velocity *= scale;
    probe.smooth_velocity *= scale;
    probe.angular_velocity *= scale;
}

}  // namespace

void SceneCore::evaluate_effects(double dt, Wrench& sum) noexcept {
    if (scales_ == HandScales{}) return evaluate_effects_at(dt, sum);
    std::array<Probe, Scene::max_probes> probes;
    for (std::uint32_t rest = probes_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        probes[p] = groups_[p].probe;
        scale_velocity(groups_[p].probe, scales_.damping / scales_.effects);
    }
    Wrench effects;
    evaluate_effects_at(dt, effects);
    sum += scales_.effects * effects;
    for (std::uint32_t rest = probes_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        groups_[p].probe = probes[p];
    }
}

void SceneCore::evaluate_effects_at(double dt, Wrench& sum) noexcept {
    if (fading_size_ > 0) advance_effect_fades(dt, sum);
    for (std::uint32_t k = 0; k < active_kinds_size_; ++k) {
        const Kind kind = active_kinds_[k];
        const std::uint32_t begin = kind_begin_[kind], end = kind_begin_[kind + 1];
        kind_ops()[kind].evaluate_all(*this, std::span<const std::uint32_t>(&by_kind_[begin], end - begin),
                                      dt, sum);
        evaluated_ += end - begin;
    }
    for (std::uint32_t rest = collapsed_used_; rest != 0; rest &= rest - 1) {
        const Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        sum += at_hand(group.springs.evaluate(group.probe), group);
        evaluated_ += group.springs.count();
    }
}

}  // namespace knurl::detail
