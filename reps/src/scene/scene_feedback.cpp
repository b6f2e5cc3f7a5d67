#include <algorithm>

#include "scene/feedback_stage.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

// The share of one plane in its set's force: sum_j (k_j - k_{j-1}) u_j n.
double share(const ContactSet& set, std::uint32_t member) noexcept {
    double sum = 0, below = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        for (std::uint32_t i = 0; i < layer.solution.active.count; ++i) {
            if (layer.solution.active.plane[i] == member) {
                sum += (layer.stiffness - below) * layer.solution.multiplier[i];
            }
        }
        below = layer.stiffness;
    }
    return sum;
}

double layer_stiffness(const ContactSet& set, std::uint32_t member) noexcept {
    double k = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        if (member < set.layer[j].count) k = set.layer[j].stiffness;
    }
    return k;
}

/// Both are untouched, so neither has a wrench.
bool rests_alike(const Feedback& a, const Feedback& b) noexcept {
    return ((a.flags | b.flags) & Feedback::touching) == 0 && a.flags == b.flags && a.id == b.id &&
           a.stiffness == b.stiffness && a.tangential_stiffness == b.tangential_stiffness;
}

}  // namespace

FeedbackStage::FeedbackStage(SceneState& state, const SurfaceCandidates& candidates, const ContactSets& sets,
                             const EffectStage& effects)
    : state_(state),
      candidates_(candidates),
      sets_(sets),
      effects_(effects),
      entry_(state.slots.size()),
      probe_(state.slots.size()),
      touched_(empty_list(state.slots.size())) {}

void FeedbackStage::reset() noexcept {
    std::fill(entry_.begin(), entry_.end(), 0u);
    touched_.clear();
    state_.feedback_edited = state_.feedback_relisted = true;
}

Vector3d FeedbackStage::contact_point(std::uint32_t probe) const noexcept {
    const Vector3d& p = state_.probes[probe].probe.position;
    const ContactSet& set = sets_[probe].now;
    if (!set.touching || set.layers == 0) return p;
    const Vector3d dx = set.layer[0].solution.dx;
    const double depth = dx.norm();
    return depth > 0 ? Vector3d(p + dx - (state_.probes[probe].probe.radius / depth) * dx) : p;
}

void FeedbackStage::write_touch(std::uint32_t i, const Record& r, Feedback& out) const noexcept {
    const ContactState& contact = sets_[r.probe];
    const ContactSet& set = contact.now;
    const Arena& a = sets_.arena();
    const std::uint32_t first = sets_.member(i);
    const double s = contact.fade.share_of_new();
    double push = 0;  // N; also 0 where damping outweighs the depth, though the surface is touched
    bool touched = false;
    for (std::uint32_t at = first; at < first + kind_ops()[r.kind].contacts; ++at) {
        const double part = r.summed ? r.stiffness * std::max(0.0, a.s[at]) : share(set, at - set.begin);
        if (!(part > 0)) continue;
        touched = true;
        const double felt = s * (r.summed ? set.scale : set.per_elastic) * part;
        push += felt;
        out.wrench.force += felt * Vector3d(a.nx[at], a.ny[at], a.nz[at]);
    }
    if (!touched) return;
    out.flags |= Feedback::touching;
    const double whole = contact.force.norm();
    const TangentialState& tangential = contact.tangential;
    if (tangential.present && whole > 0)
        out.wrench.force += (push / whole) * (tangential.friction_force + tangential.relief);
    const ProbeState& probe = state_.probes[r.probe];
    if (probe.placement.offset != Vec3{}) out.wrench.torque = probe.arm.cross(out.wrench.force);
    out.contact_point = contact_point(r.probe);
}

void FeedbackStage::write_surface(std::uint32_t i, const Record& r, Feedback& out) const noexcept {
    const ContactState& contact = sets_[r.probe];
    const ContactSet& set = contact.now;
    if (r.has_tangential)
        out.tangential_stiffness = state_.records.tangential(state_.records.owner(i, false)).law.stiffness;
    if (contact.fade.under_way) out.flags |= Feedback::fading;
    if (!candidates_.may_be_near(i) || sets_.member(i) == ContactSets::in_no_set || contact.empty()) return;
    if (set.infeasible) out.flags |= Feedback::infeasible;
    if (!r.summed && (set.scale != 1 || r.weight == 1))
        out.stiffness = layer_stiffness(set, sets_.member(i) - set.begin);
    if (set.touching) write_touch(i, r, out);
}

void FeedbackStage::write_effect(std::uint32_t i, Feedback& out) const noexcept {
    const EffectState& effect = effects_[i];
    out.wrench = effect.last;
    if (effect.last.force != Vector3d::Zero() || effect.last.torque != Vector3d::Zero())
        out.flags |= Feedback::touching;
    if (effect.from != FadeFrom::none) out.flags |= Feedback::fading;
}

Feedback FeedbackStage::feedback_of(std::uint32_t i, bool surface) const noexcept {
    const Record& r = state_.records.current(i);
    Feedback f{.id = {i, state_.slots[i].generation},
               .wrench = {},
               .contact_point = state_.probes[r.probe].probe.position,
               .stiffness = r.stiffness,
               .flags = state_.silence.seconds > 0 ? Feedback::silent : 0};
    if (surface) {
        write_surface(i, r, f);
    } else {
        write_effect(i, f);
    }
    if (r.clamped || f.stiffness < r.stiffness) f.flags |= Feedback::stiffness_clamped;
    return f;
}

/// Changes the flags that all surfaces of a probe share. False: more than these flags has changed.
bool FeedbackStage::rewrite_flags(std::span<Feedback> kept, std::span<std::uint64_t> written) noexcept {
    std::uint32_t fading = 0, infeasible = 0;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) {
        fading |= (sets_[p].fade.under_way ? 1u : 0u) << p;
        infeasible |= (sets_[p].now.infeasible ? 1u : 0u) << p;
    });
    const bool alike = !state_.feedback_edited && infeasible == infeasible_;
    const std::uint32_t silent = state_.silence.seconds > 0 ? Feedback::silent : 0;
    const std::uint32_t silence = silent_ ^ silent, fades = fading_ ^ fading;
    silent_ = silent;
    fading_ = fading;
    infeasible_ = infeasible;
    state_.feedback_edited = false;
    if (!alike || (silence | fades) == 0) return alike;
    for (std::uint32_t n = 0; n < surface_entries_; ++n) {
        const std::uint32_t change = silence | ((fades >> probe_[n] & 1) != 0 ? Feedback::fading : 0);
        kept[n].flags ^= change;
        written[n / 64] |= std::uint64_t{change != 0} << (n % 64);
    }
    return true;
}

template <class Put>
void FeedbackStage::write_surfaces(std::uint32_t room, Put put) noexcept {
    surface_entries_ = 0;
    touched_.clear();
    for (const std::uint32_t i : sets_.surfaces()) {
        const Record& r = state_.records.current(i);
        const bool listed = r.reported && surface_entries_ < room;
        entry_[i] = listed ? surface_entries_++ : no_entry;
        if (!listed) continue;
        probe_[entry_[i]] = r.probe;
        if (put(entry_[i], feedback_of(i, true))) touched_.push_back(i);
    }
}

/// Reports all effects, or only those that are evaluated: the others have not changed.
template <class Put>
void FeedbackStage::write_effects(std::uint32_t room, bool all, Put put) noexcept {
    if (!all) {
        for (const std::uint32_t i : effects_.evaluated()) {
            if (entry_[i] != no_entry) put(entry_[i], feedback_of(i, false));
        }
        return;
    }
    std::uint32_t n = surface_entries_;
    for (const std::uint32_t i : effects_.effects()) {
        const bool listed = state_.records.current(i).reported && n < room;
        entry_[i] = listed ? n++ : no_entry;
        if (listed) put(entry_[i], feedback_of(i, false));
    }
    effect_entries_ = n - surface_entries_;
    state_.feedback_relisted = false;
}

/// Reports the surfaces that are touched, and those that were touched before.
template <class Put>
void FeedbackStage::write_touched(Put put) noexcept {
    std::size_t kept = 0;
    const auto write = [&](std::uint32_t i) {
        return entry_[i] != no_entry && put(entry_[i], [&] { return feedback_of(i, true); });
    };
    for (const std::uint32_t i : touched_) {
        if (write(i)) touched_[kept++] = i;
    }
    touched_.resize(kept);
    const auto write_owner = [&](Owner owner) {
        if (write(owner >> 1)) touched_.push_back(owner >> 1);
    };
    const Arena& a = sets_.arena();
    for_each_bit(sets_.probes(), [&](std::uint32_t p) {
        const ContactSet& set = sets_[p].now;
        if (!set.touching) return;
        for (std::uint32_t j = 0; j < set.layers; ++j) {
            const ActiveSet& active = set.layer[j].solution.active;
            for (std::uint32_t c = 0; c < active.count; ++c)
                write_owner(a.owner[set.begin + active.plane[c]]);
        }
        const std::uint32_t sums = set.begin + set.count;
        for (std::uint32_t at = sums; at < sums + set.summed; ++at) {
            if (a.s[at] > 0) write_owner(a.owner[at]);
        }
    });
}

std::size_t FeedbackStage::write(std::span<Feedback> out) const noexcept {
    std::size_t n = 0;
    const auto write_all = [&](std::span<const std::uint32_t> list, bool surfaces) {
        for (const std::uint32_t i : list) {
            if (n < out.size() && state_.records.current(i).reported) out[n++] = feedback_of(i, surfaces);
        }
    };
    write_all(sets_.surfaces(), true);
    write_all(effects_.effects(), false);
    return n;
}

std::size_t FeedbackStage::write_changes(std::span<Feedback> kept, const Rewritten& rewritten) noexcept {
    const auto [written, flags] = rewritten;
    std::fill(written.begin(), written.end(), 0);
    std::fill(flags.begin(), flags.end(), 0);
    const std::size_t room = std::min(kept.size(), 64 * std::min(written.size(), flags.size()));
    const auto bit = [](std::size_t n) { return std::uint64_t{1} << (n % 64); };
    const auto put = [&, written = written](std::size_t n, const Feedback& f) {
        if (rests_alike(f, kept[n])) return false;
        kept[n] = f;
        written[n / 64] |= bit(n);
        return (f.flags & Feedback::touching) != 0;
    };
    const bool silence = (silent_ != 0) != (state_.silence.seconds > 0);
    const bool all_effects = state_.feedback_edited || state_.feedback_relisted || silence;
    if (rewrite_flags(kept, flags)) {
        write_touched([&, written = written](std::size_t n, auto feedback) {
            return (written[n / 64] & bit(n)) == 0 && put(n, feedback());  // a surface may be listed twice
        });
    } else {
        write_surfaces(static_cast<std::uint32_t>(room), put);
    }
    write_effects(static_cast<std::uint32_t>(room), all_effects, put);
    return surface_entries_ + effect_entries_;
}

}  // namespace knurl::detail
