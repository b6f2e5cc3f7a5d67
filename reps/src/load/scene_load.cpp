#include <algorithm>
#include <cmath>

#include "load/load_stage.hpp"

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

/// The projector onto the span of the normals of up to three planes.
Matrix3d held_directions(const ContactSet& set, const ActiveSet& active, const Arena& a) noexcept {
    Matrix3d span = Matrix3d::Zero();
    for (std::uint32_t i = 0; i < active.count; ++i) {
        const std::uint32_t at = set.begin + active.plane[i];
        const Vector3d n(a.nx[at], a.ny[at], a.nz[at]);
        const Vector3d left = n - span * n;
        // Two planes within a ten-thousandth of a degree count as one direction.
        if (left.squaredNorm() > 1e-12) span += left * left.transpose() / left.squaredNorm();
    }
    return span;
}

/// The largest damping of the planes that hold.
double damping_of(const ContactSet& set, const ActiveSet& active, const Arena& a) noexcept {
    double most = 0;
    for (std::uint32_t i = 0; i < active.count; ++i) most = std::max(most, a.b[set.begin + active.plane[i]]);
    return most;
}

}  // namespace

Demand LoadStage::bound_of(const ContactSet& set) const noexcept {
    Demand bound;
    if (!set.touching) return bound;
    const Arena& a = sets_.arena();
    if (const Layer* top = hardest_that_holds(set)) {
        bound.stiffness = top->stiffness;
        bound.damping = damping_of(set, top->solution.active, a);
    }
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (!(a.s[i] > 0)) continue;
        bound.stiffness += state_.records[a.owner[i]].stiffness;
        bound.damping += a.b[i];
    }
    return bound;
}

Demand LoadStage::bound_of(std::uint32_t p) const noexcept {
    const ContactState& contact = sets_[p];
    Demand bound = bound_of(contact.now);
    if (contact.fade.under_way) {
        const Demand old = bound_of(contact.old);
        bound = {std::max(bound.stiffness, old.stiffness), std::max(bound.damping, old.damping)};
    }
    const TangentialState& tangential = contact.tangential;
    if (tangential.present && tangential.friction.held) {
        // Friction acts across the force. That is across all holding planes where they are solved as one.
        const bool across = !contact.fade.under_way && contact.now.summed == 0 && contact.now.layers == 1;
        const auto with = [&](double normal, double along) {
            return across ? std::max(normal, along) : normal + along;
        };
        bound = {with(bound.stiffness, tangential.friction.stiffness),
                 with(bound.damping, tangential.law.viscous)};
    }
    const Shares& shares = state_.shares;
    const double turned = 1 + shares.turning * state_.probes[p].arm.squaredNorm();
    return {shares.stiffness * turned * bound.stiffness +
                bound_of_turning(contact.force + contact.tangential.friction_force, p),
            shares.damping * turned * bound.damping};
}

// F = sum_j (k_j - k_{j-1}) (x_j - p); x_j follows p in all directions that its planes do not hold.
void LoadStage::add(const ContactSet& set, double share, HandLoad& load) const noexcept {
    if (!set.touching) return;
    const Arena& a = sets_.arena();
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
        const double most = damping_of(set, top->solution.active, a);
        const double size = set.force.norm();
        if (most > 0 && size > 0)  // along the force alone: damped_force
            damping += scale * most * (set.force / size) * (set.force / size).transpose();
    }
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (!(a.s[i] > 0)) continue;
        const Record& r = state_.records[a.owner[i]];
        const Vector3d n(a.nx[i], a.ny[i], a.nz[i]);
        stiffness += scale * r.stiffness * own_weight(set, r.weight) * n * n.transpose();
        damping += scale * a.b[i] * n * n.transpose();
    }
}

HandLoad LoadStage::at_probe(const ContactState& contact) const noexcept {
    HandLoad load;
    load.energy = energy_of(contact, sets_.arena(), state_);
    const double s = contact.fade.share_of_new();
    add(contact.now, s, load);
    if (contact.fade.under_way) add(contact.old, 1 - s, load);
    const TangentialState& tangential = contact.tangential;
    if (!tangential.present || !tangential.friction.held) return load;
    const Tangent& tangent = tangential.tangent;
    Matrix3d along = Matrix3d::Zero();
    if (tangent.dimensions == 2) along = Matrix3d::Identity() - tangent.normal * tangent.normal.transpose();
    if (tangent.dimensions == 1) along = tangent.line * tangent.line.transpose();
    load.stiffness.topLeftCorner<3, 3>() += tangential.friction.stiffness * along;
    load.damping.topLeftCorner<3, 3>() += tangential.law.viscous * along;
    return load;
}

LoadBound LoadStage::bound() const noexcept {
    LoadBound bound{.surfaces = !sets_.surfaces().empty()};
    for_each_bit(sets_.probes(), [&](std::uint32_t p) {
        if (sets_[p].is_clear()) return;
        const Demand of_probe = bound_of(p);
        bound.contacts += of_probe.stiffness;
        bound.damping += of_probe.damping;
    });
    const auto add_effects = [&](const Demand& demand) {
        bound.effects += demand.stiffness;
        bound.damping += demand.damping;
    };
    if (!effects_.effects().empty()) add_effects(effects_.bound());
    if (state_.shares.turning > 0) bound.effects += bound_of_turning_effects();
    for (const std::uint32_t i : effects_.fading()) {
        if (effects_[i].from == FadeFrom::record) add_effects(effects_.bound_of(state_.records.old(i)));
    }
    return bound;
}

// turned_force has no eigenvalue above |arm| |force|.
double LoadStage::bound_of_turning(const Vector3d& force, std::uint32_t p) const noexcept {
    if (!has_arm(p)) return 0;
    return state_.shares.stiffness * state_.shares.turning * state_.probes[p].arm.norm() * force.norm();
}

double LoadStage::bound_of_turning_effects() const noexcept {
    double bound = 0;
    for (const std::uint32_t i : effects_.evaluated())
        bound += bound_of_turning(effects_[i].last.force, state_.records.current(i).probe);
    for_each_bit(effects_.collapsed_probes(), [&](std::uint32_t p) {
        if (has_arm(p)) bound += bound_of_turning(effects_.collapsed_wrench(p).force, p);
    });
    return bound;
}

/// Has the arm an effect on the load? `turning` is 0 where the device's limits of rotation are unknown.
bool LoadStage::has_arm(std::uint32_t p) const noexcept {
    return state_.shares.turning > 0 && state_.probes[p].placement.offset != Vec3{};
}

void LoadStage::move_to_hand(HandLoad& sum, const HandLoad& at_probe, std::uint32_t p) const noexcept {
    sum += has_arm(p) ? moved_by(at_probe, state_.probes[p].arm) : at_probe;
}

/// The force turns with the hand; this adds what its arm contributes to the load.
void LoadStage::turn(HandLoad& sum, const Vector3d& force, std::uint32_t p) const noexcept {
    if (has_arm(p)) sum.stiffness.bottomRightCorner<3, 3>() += turned_force(state_.probes[p].arm, force);
}

HandLoad LoadStage::of_contacts() const noexcept {
    HandLoad sum;
    for_each_bit(sets_.probes(), [&](std::uint32_t p) {
        const ContactState& contact = sets_[p];
        move_to_hand(sum, at_probe(contact), p);
        turn(sum, contact.force + contact.tangential.friction_force, p);
    });
    return sum;
}

HandLoad LoadStage::of_effects() const noexcept {
    HandLoad sum;
    const Records& records = state_.records;
    // J that the effect holds at its full gain.
    const auto add_effect = [&](const Record& r, double gain) {
        const KindOps& ops = kind_ops()[r.kind];
        if (ops.load == nullptr || !(gain * r.weight > 0)) return 0.0;
        const HandLoad load = r.weight * ops.load(r, state_.probes[r.probe].probe);
        move_to_hand(sum, gain * load, r.probe);
        return load.energy.held;
    };
    const auto add_old = [&](std::uint32_t i, double now) {
        const EffectState& effect = effects_[i];
        if (effect.from != FadeFrom::record) return;
        const double old = add_effect(records.old(i), 1 - effect.gain);
        sum.energy.freed += freed_by_fade(old, now, effect.time, state_.clock.step);
    };
    for (const std::uint32_t i : effects_.effects()) {
        const EffectState& effect = effects_[i];
        if (!effect.evaluated) continue;
        const Record& r = records.current(i);
        const double held = add_effect(r, effect.gain);
        if (!effect.collapsed) turn(sum, effect.last.force, r.probe);
        add_old(i, held);
    }
    // Removed effects still fade out though they are not listed any more.
    for (const std::uint32_t i : effects_.fading()) {
        if (!state_.slots[i].active) add_old(i, 0);
    }
    for_each_bit(effects_.collapsed_probes(),
                 [&](std::uint32_t p) { turn(sum, effects_.collapsed_wrench(p).force, p); });
    return sum;
}

SceneLoad LoadStage::load() const noexcept {
    const HandLoad contacts = as_shares(of_contacts(), state_.limits),
                   effects = as_shares(of_effects(), state_.limits);
    return {.contacts = contacts.stiffness,
            .effects = effects.stiffness,
            .damping = contacts.damping + effects.damping,
            .in_contacts = contacts.energy,
            .in_effects = effects.energy,
            .surfaces = !sets_.surfaces().empty()};
}

}  // namespace knurl::detail
