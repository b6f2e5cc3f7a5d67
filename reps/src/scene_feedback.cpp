// What the application and the servo learn after a cycle.

#include <algorithm>
#include <cmath>

#include "scene_core.hpp"

namespace knurl {

using Eigen::Vector3d;
using namespace detail;

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

Vector3d point_of(const Group& group) noexcept {
    const Vector3d& p = group.probe.position;
    if (!group.now.touching || group.now.layers == 0) return p;
    const Vector3d dx = group.now.layer[0].solution.dx;
    const double depth = dx.norm();
    return depth > 0 ? Vector3d(p + dx - (group.probe.radius / depth) * dx) : p;
}

void touching_feedback(const SceneCore& core, std::uint32_t i, Feedback& out) noexcept {
    const Record& r = core.felt(i);
    const Group& group = core.groups_[r.probe];
    const ContactSet& set = group.now;
    const std::uint32_t first = core.slots_[i].member;
    const Arena& a = core.arenas_[core.arena_];
    const double s = group.fading ? group.elapsed / group.time : 1;
    double push = 0;  // N; 0 too where damping outweighs the depth, and touched all the same
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
    const double whole = group.force.norm();
    if (group.rough && whole > 0) out.wrench.force += (push / whole) * (group.along + group.relief);
    if (group.placement.offset != Vec3{}) out.wrench.torque = group.arm.cross(out.wrench.force);
    out.contact_point = point_of(group);
}

void surface_feedback(const SceneCore& core, std::uint32_t i, const Record& r, Feedback& out) noexcept {
    const Slot& slot = core.slots_[i];
    const Group& group = core.groups_[r.probe];
    const ContactSet& set = group.now;
    if (r.rough) out.tangential_stiffness = core.rough(core.owner(i, false)).law.stiffness;
    if (group.fading) out.flags |= Feedback::fading;
    if (slot.bounded && !slot.near) return;
    if (slot.member == SceneCore::gone || set.count + set.summed == 0) return;
    if (set.infeasible) out.flags |= Feedback::infeasible;
    if (!r.summed && (set.scale != 1 || r.weight == 1))
        out.stiffness = layer_stiffness(set, slot.member - set.begin);
    if (set.touching) touching_feedback(core, i, out);
}

void effect_feedback(const Slot& slot, Feedback& out) noexcept {
    out.wrench = slot.last;
    if (slot.last.force != Vector3d::Zero() || slot.last.torque != Vector3d::Zero())
        out.flags |= Feedback::touching;
    if (slot.from != Slot::From::none) out.flags |= Feedback::fading;
}

/// Neither is touched, so that neither has a wrench.
bool rests_alike(const Feedback& a, const Feedback& b) noexcept {
    return ((a.flags | b.flags) & Feedback::touching) == 0 && a.flags == b.flags && a.handle == b.handle &&
           a.stiffness == b.stiffness && a.tangential_stiffness == b.tangential_stiffness;
}

}  // namespace

namespace detail {

Feedback SceneCore::feedback_of(std::uint32_t i, bool surface) const noexcept {
    const Record& r = felt(i);
    Feedback f{.handle = {i, slots_[i].felt_generation},
               .wrench = {},
               .contact_point = groups_[r.probe].probe.position,
               .stiffness = r.stiffness,
               .flags = silence_ > 0 ? Feedback::silent : 0};
    if (surface) {
        surface_feedback(*this, i, r, f);
    } else {
        effect_feedback(slots_[i], f);
    }
    if (r.clamped || f.stiffness < r.stiffness) f.flags |= Feedback::stiffness_clamped;
    return f;
}

/// What all surfaces of a probe share changes their flags alike. False: more than that has changed.
bool SceneCore::retold_by_flags(std::span<Feedback> kept, std::span<std::uint64_t> written) noexcept {
    std::uint32_t fading = 0, infeasible = 0;
    for (std::uint32_t rest = probes_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        fading |= (groups_[p].fading ? 1u : 0u) << p;
        infeasible |= (groups_[p].now.infeasible ? 1u : 0u) << p;
    }
    const bool alike = !told_.edited && infeasible == told_.infeasible;
    const std::uint32_t silent = silence_ > 0 ? Feedback::silent : 0;
    const std::uint32_t silence = told_.silent ^ silent, fades = told_.fading ^ fading;
    told_.silent = silent;
    told_.fading = fading;
    told_.infeasible = infeasible;
    told_.edited = false;
    if (!alike || (silence | fades) == 0) return alike;
    for (std::uint32_t n = 0; n < told_.entries; ++n) {
        const std::uint32_t change = silence | ((fades >> told_.probe[n] & 1) != 0 ? Feedback::fading : 0);
        kept[n].flags ^= change;
        written[n / 64] |= std::uint64_t{change != 0} << (n % 64);
    }
    return true;
}

template <class Put>
void SceneCore::tell_surfaces(std::uint32_t room, Put put) noexcept {
    told_.entries = told_.touched_size = 0;
    for (std::uint32_t k = 0; k < surfaces_size_; ++k) {
        const std::uint32_t i = surfaces_[k];
        const bool told = felt(i).reported && told_.entries < room;
        slots_[i].entry = told ? told_.entries++ : gone;
        if (!told) continue;
        told_.probe[slots_[i].entry] = felt(i).probe;
        if (put(slots_[i].entry, feedback_of(i, true))) told_.touched[told_.touched_size++] = i;
    }
}

/// All effects, or those alone that are asked: of the others there is nothing new.
template <class Put>
void SceneCore::tell_effects(std::uint32_t room, bool all, Put put) noexcept {
    if (!all) {
        for (std::uint32_t k = 0; k < kind_begin_.back(); ++k) {
            const std::uint32_t i = by_kind_[k];
            if (slots_[i].entry != gone) put(slots_[i].entry, feedback_of(i, false));
        }
        return;
    }
    std::uint32_t n = told_.entries;
    for (std::uint32_t k = 0; k < effects_size_; ++k) {
        const std::uint32_t i = effects_[k];
        const bool told = felt(i).reported && n < room;
        slots_[i].entry = told ? n++ : gone;
        if (told) put(slots_[i].entry, feedback_of(i, false));
    }
    told_.effects = n - told_.entries;
    told_.relisted = false;
}

/// Those that are touched, and those that were.
template <class Put>
void SceneCore::tell_touched(Put put) noexcept {
    const std::uint32_t before = told_.touched_size;
    told_.touched_size = 0;
    const auto tell = [&](std::uint32_t i) {
        if (slots_[i].entry != gone && put(slots_[i].entry, [&] { return feedback_of(i, true); }))
            told_.touched[told_.touched_size++] = i;
    };
    for (std::uint32_t k = 0; k < before; ++k) tell(told_.touched[k]);
    const Arena& a = arenas_[arena_];
    for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1) {
        const ContactSet& set = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))].now;
        if (!set.touching) continue;
        for (std::uint32_t j = 0; j < set.layers; ++j) {
            const ActiveSet& active = set.layer[j].solution.active;
            for (std::uint32_t c = 0; c < active.count; ++c) tell(a.owner[set.begin + active.plane[c]] >> 1);
        }
        const std::uint32_t sums = set.begin + set.count;
        for (std::uint32_t at = sums; at < sums + set.summed; ++at) {
            if (a.s[at] > 0) tell(a.owner[at] >> 1);
        }
    }
}

}  // namespace detail

Vector3d Scene::contact_point() const noexcept {
    return point_of(impl_->groups_[0]);
}

std::uint32_t Scene::size() const noexcept {
    return impl_->size_;
}
std::uint32_t Scene::count(Kind kind) const noexcept {
    return kind < Representations::size ? impl_->counts_[kind] : 0;
}
std::uint32_t Scene::curved_rounds() const noexcept {
    return impl_->curved_rounds_;
}
std::uint32_t Scene::evaluated() const noexcept {
    return impl_->evaluated_;
}

std::size_t Scene::feedback(std::span<Feedback> out) const noexcept {
    const SceneCore& core = *impl_;
    std::size_t n = 0;
    const auto tell = [&](const std::vector<std::uint32_t>& list, std::uint32_t size, bool surfaces) {
        for (std::uint32_t k = 0; k < size && n < out.size(); ++k) {
            if (core.felt(list[k]).reported) out[n++] = core.feedback_of(list[k], surfaces);
        }
    };
    tell(core.surfaces_, core.surfaces_size_, true);
    tell(core.effects_, core.effects_size_, false);
    return n;
}

std::size_t Scene::feedback(std::span<Feedback> kept, const Rewritten& rewritten) noexcept {
    SceneCore& core = *impl_;
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
    const bool silence = (core.told_.silent != 0) != (core.silence_ > 0);
    const bool all_effects = core.told_.edited || core.told_.relisted || silence;
    if (core.retold_by_flags(kept, flags)) {
        core.tell_touched([&, written = written](std::size_t n, auto feedback) {
            return (written[n / 64] & bit(n)) == 0 && put(n, feedback());  // one may be named twice
        });
    } else {
        core.tell_surfaces(static_cast<std::uint32_t>(room), put);
    }
    core.tell_effects(static_cast<std::uint32_t>(room), all_effects, put);
    return core.told_.entries + core.told_.effects;
}

}  // namespace knurl
