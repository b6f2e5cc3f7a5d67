// How stiff and how damped the hand feels the scene: of the contacts as they were solved, of the effects where the
// probes are.

#include <algorithm>
#include <cmath>

#include "scene_energy.hpp"

namespace knurl::detail {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// The hardest layer that holds; null: none does.
const Layer* hardest_that_holds(const ContactSet& set) noexcept {
    for (std::uint32_t j = set.layers; j-- > 0;)
        if (set.layer[j].solution.active.count > 0) return &set.layer[j];
    return nullptr;
}

/// Onto what up to three planes hold: the span of their normals.
Matrix3d held_directions(const ContactSet& set, const ActiveSet& active, const Arena& a) noexcept {
    Matrix3d span = Matrix3d::Zero();
    for (std::uint32_t i = 0; i < active.count; ++i) {
        const std::uint32_t at = set.begin + active.plane[i];
        const Vector3d n(a.nx[at], a.ny[at], a.nz[at]);
        const Vector3d left = n - span * n;
        // Two planes that are one to a ten-thousandth of a degree hold one direction.
        if (left.squaredNorm() > 1e-12) span += left * left.transpose() / left.squaredNorm();
    }
    return span;
}

}  // namespace

Demand SceneCore::bound_of(const ContactSet& set) const noexcept {
    Demand bound;
    if (!set.touching) return bound;
    const Arena& a = arenas_[arena_];
    if (const Layer* top = hardest_that_holds(set)) {
        bound.stiffness = top->stiffness;
        const ActiveSet& active = top->solution.active;
        for (std::uint32_t i = 0; i < active.count; ++i)
            bound.damping = std::max(bound.damping, a.b[set.begin + active.plane[i]]);
    }
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (!(a.s[i] > 0)) continue;
        bound.stiffness += record(a.owner[i]).stiffness;
        bound.damping += a.b[i];
    }
    return bound;
}

Demand SceneCore::bound_of(const Group& group) const noexcept {
    Demand bound = bound_of(group.now);
    if (group.fading) {
        const Demand old = bound_of(group.old);
        bound = {std::max(bound.stiffness, old.stiffness), std::max(bound.damping, old.damping)};
    }
    if (group.rough && group.friction.held) {
        // Friction acts across the force. That is across all planes that hold where they are solved as one.
        const bool across = !group.fading && group.now.summed == 0 && group.now.layers == 1;
        const auto with = [&](double normal, double tangential) {
            return across ? std::max(normal, tangential) : normal + tangential;
        };
        bound = {with(bound.stiffness, group.friction.stiffness), with(bound.damping, group.law.viscous)};
    }
    const double turned = 1 + shares_.turning * group.arm.squaredNorm();
    return {shares_.stiffness * turned * bound.stiffness, shares_.damping * turned * bound.damping};
}

// F = sum_j (k_j - k_{j-1}) (x_j - p), and x_j follows p along all that its planes do not hold.
void SceneCore::add_load(const ContactSet& set, double share, HandLoad& load) const noexcept {
    if (!set.touching) return;
    const Arena& a = arenas_[arena_];
    const double scale = share * set.scale;
    auto stiffness = load.stiffness.topLeftCorner<3, 3>();
    auto damping = load.damping.topLeftCorner<3, 3>();
    double below = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        stiffness += scale * (layer.stiffness - below) * held_directions(set, layer.solution.active, a);
        below = layer.stiffness;
    }
    if (const Layer* top = hardest_that_holds(set)) {
        const ActiveSet& active = top->solution.active;
        double most = 0;
        for (std::uint32_t i = 0; i < active.count; ++i)
            most = std::max(most, a.b[set.begin + active.plane[i]]);
        const double size = set.force.norm();
        if (most > 0 && size > 0)  // along the force alone: damped_force
            damping += scale * most * (set.force / size) * (set.force / size).transpose();
    }
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (!(a.s[i] > 0)) continue;
        const Record& r = record(a.owner[i]);
        const Vector3d n(a.nx[i], a.ny[i], a.nz[i]);
        stiffness += scale * r.stiffness * (set.scale == 1 ? r.weight : 1) * n * n.transpose();
        damping += scale * a.b[i] * n * n.transpose();
    }
}

// At the probe.
HandLoad SceneCore::load_of(const Group& group) const noexcept {
    HandLoad load;
    const double s = group.fading ? group.elapsed / group.time : 1;
    add_load(group.now, s, load);
    if (group.fading) add_load(group.old, 1 - s, load);
    if (group.rough && group.friction.held) {
        const Tangent& tangent = group.tangent;
        Matrix3d along = Matrix3d::Zero();
        if (tangent.dimensions == 2)
            along = Matrix3d::Identity() - tangent.normal * tangent.normal.transpose();
        if (tangent.dimensions == 1) along = tangent.line * tangent.line.transpose();
        load.stiffness.topLeftCorner<3, 3>() += group.friction.stiffness * along;
        load.damping.topLeftCorner<3, 3>() += group.law.viscous * along;
    }
    load.energy = energy_of(*this, group);
    return load;
}

Demand SceneCore::bound_of(const Record& effect) const noexcept {
    const KindOps& ops = kind_ops()[effect.kind];
    if (ops.load_bound == nullptr) return {};
    const double turned = 1 + shares_.turning * groups_[effect.probe].arm.squaredNorm();
    const Demand bound = ops.load_bound(effect, limits_);
    return {turned * bound.stiffness, turned * bound.damping};
}

void SceneCore::bound_effects() noexcept {
    effects_bound_ = {};
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        if (!slots_[effects_[e]].asked) continue;
        const Demand bound = bound_of(felt(effects_[e]));
        effects_bound_.stiffness += bound.stiffness;
        effects_bound_.damping += bound.damping;
    }
    effects_bound_stale_ = false;
}

}  // namespace knurl::detail

namespace knurl {

using namespace detail;

LoadBound Scene::load_bound() const noexcept {
    const SceneCore& core = *impl_;
    LoadBound bound{.surfaces = core.surfaces_size_ > 0};
    for (std::uint32_t rest = core.contacts_used_; rest != 0; rest &= rest - 1) {
        const Demand group = core.bound_of(core.groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))]);
        bound.contacts += group.stiffness;
        bound.damping += group.damping;
    }
    const auto add_effects = [&](const Demand& demand) {
        bound.effects += demand.stiffness;
        bound.damping += demand.damping;
    };
    if (core.effects_size_ > 0) add_effects(core.effects_bound_);
    for (std::uint32_t f = 0; f < core.fading_size_; ++f) {
        if (core.slots_[core.fading_[f]].from == Slot::From::record)
            add_effects(core.bound_of(core.faded(core.fading_[f])));
    }
    return bound;
}

SceneLoad Scene::load() const noexcept {
    const SceneCore& core = *impl_;
    HandLoad contacts, effects;
    const auto has_arm = [&core](const Group& group) {  // that matters: of rotation nothing may be known
        return core.shares_.turning > 0 && group.placement.offset != Vec3{};
    };
    const auto add = [&](HandLoad& sum, const HandLoad& at_probe, const Group& group) {
        sum += has_arm(group) ? moved_by(at_probe, group.arm) : at_probe;
    };
    // What the arm of a force adds, which turns with the hand.
    const auto turn = [&](HandLoad& sum, const Eigen::Vector3d& force, const Group& group) {
        if (has_arm(group)) sum.stiffness.bottomRightCorner<3, 3>() += turned_force(group.arm, force);
    };
    for (std::uint32_t rest = core.contacts_used_; rest != 0; rest &= rest - 1) {
        const Group& group = core.groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        add(contacts, core.load_of(group), group);
        turn(contacts, group.force + group.along, group);
    }
    // J that it holds at its full gain.
    const auto add_effect = [&](const Record& r, double gain) {
        const KindOps& ops = kind_ops()[r.kind];
        const Group& group = core.groups_[r.probe];
        if (ops.load == nullptr || !(gain * r.weight > 0)) return 0.0;
        const HandLoad load = r.weight * ops.load(r, group.probe);
        add(effects, gain * load, group);
        return load.energy.held;
    };
    const auto add_old = [&](std::uint32_t i, double now) {
        const Slot& slot = core.slots_[i];
        if (slot.from != Slot::From::record) return;
        const double old = add_effect(core.faded(i), 1 - slot.gain);
        effects.energy.freed += freed_by_fade(old, now, slot.time, core.step_);
    };
    for (std::uint32_t e = 0; e < core.effects_size_; ++e) {
        const std::uint32_t i = core.effects_[e];
        const Slot& slot = core.slots_[i];
        if (!slot.asked) continue;
        const double held = add_effect(core.felt(i), slot.gain);
        if (!slot.collapsed) turn(effects, slot.last.force, core.groups_[core.felt(i).probe]);
        add_old(i, held);
    }
    // Those that are removed are faded out though they are no longer felt.
    for (std::uint32_t f = 0; f < core.fading_size_; ++f)
        if (!core.slots_[core.fading_[f]].felt) add_old(core.fading_[f], 0);
    for (std::uint32_t rest = core.collapsed_used_; rest != 0; rest &= rest - 1) {
        const Group& group = core.groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        turn(effects, group.springs.evaluate(group.probe).force, group);
    }
    const HandLoad of_contacts = as_shares(contacts, core.limits_),
                   of_effects = as_shares(effects, core.limits_);
    return {.contacts = of_contacts.stiffness,
            .effects = of_effects.stiffness,
            .damping = of_contacts.damping + of_effects.damping,
            .in_contacts = of_contacts.energy,
            .in_effects = of_effects.energy,
            .surfaces = core.surfaces_size_ > 0};
}

void Scene::set_scales(const HandScales& scales) noexcept {
    impl_->scales_ = scales;
}

}  // namespace knurl
