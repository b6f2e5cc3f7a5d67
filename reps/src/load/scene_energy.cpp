// The energy that a probe's contacts hold at full strength: the potential whose gradient is their force.

#include "load/scene_energy.hpp"

namespace knurl::detail {

namespace {

// sum_j (k_j - k_{j-1}) |x_j - p|^2 / 2, and k depth^2 / 2 of each summed plane.
double held_by(const ContactSet& set, const Arena& a, const Records& records) noexcept {
    if (!set.touching) return 0;
    double twice = 0, below = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        twice += (layer.stiffness - below) * layer.solution.dx.squaredNorm();
        below = layer.stiffness;
    }
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        const Record& r = records[a.owner[i]];
        if (a.s[i] > 0) twice += r.stiffness * own_weight(set, r.weight) * a.s[i] * a.s[i];
    }
    return 0.5 * set.scale * twice;
}

}  // namespace

double freed_by_fade(double before, double after, double time, double step) noexcept {
    // A fade acts in all its cycles but the last. What the last one takes away is distributed over the
    // others.
    return time > step ? std::max(0.0, before - after) * step / (time - step) : 0;
}

PartEnergy energy_of(const ContactState& contact, const Arena& arena, const SceneState& state) noexcept {
    const double now = held_by(contact.now, arena, state.records);
    PartEnergy energy{.held = now};
    if (contact.fade.under_way) {
        const double old = held_by(contact.old, arena, state.records);
        const double share = contact.fade.share_of_new();
        energy = {.held = share * now + (1 - share) * old,
                  .freed = freed_by_fade(old, now, contact.fade.time, state.clock.step)};
    }
    const FrictionState& friction = contact.tangential.friction;
    if (contact.tangential.present && friction.held && friction.stiffness > 0)
        energy.held += 0.5 * friction.last.squaredNorm() / friction.stiffness;
    return energy;
}

}  // namespace knurl::detail
