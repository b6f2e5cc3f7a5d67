// The tangential stage on the blended contact, once per probe: friction, texture, and the braking pulse at
// entry.

#include <cmath>

#include "contact/contact_stage.hpp"
#include "scene/clamped.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

constexpr double pulse_time = 4e-3;   // s: Salcudean and Vlaar 1994
constexpr double rearm_time = 20e-3;  // s outside, before an entry brakes again

// A place where the surface's material has more or less friction than elsewhere.
FrictionLaw scaled(FrictionLaw law, double share) noexcept {
    law.static_ *= share;
    law.dynamic *= share;
    law.viscous *= share;
    law.stiffness_per_newton *= share;
    return law;
}

// Calls visit(member, newtons) for every plane that pushes, with its part of the normal force.
template <class Visit>
void each_push(const ContactSet& set, const Arena& a, const auto& stiffness_of, double share,
               Visit visit) noexcept {
    if (!set.touching) return;
    double below = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        for (std::uint32_t i = 0; i < layer.solution.active.count; ++i) {
            visit(set.begin + layer.solution.active.plane[i],
                  share * set.per_elastic * (layer.stiffness - below) * layer.solution.multiplier[i]);
        }
        below = layer.stiffness;
    }
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (a.s[i] > 0) visit(i, share * stiffness_of(a.owner[i]) * a.s[i]);
    }
}

}  // namespace

bool TangentialState::rests() const noexcept {
    return !(friction.residual_time > 0) && !(pulse_left > 0) && (!present || apart >= rearm_time);
}

void TangentialState::release() noexcept {
    friction_force.setZero();
    relief.setZero();
    law = FrictionLaw{};
    friction = FrictionState{.generator = friction.generator, .seed = friction.seed};
    pulse_left = 0;
    apart = 1;
}

double texture_gain_of(const Record& r, const Texture& texture, const Probe& probe,
                       const SceneState& state) noexcept {
    const auto at = [&](const Vector3d& velocity) {
        return texture_gain(texture, (probe.smooth_velocity - velocity).norm(), state.limits);
    };
    const double weight = state.silence.velocity_weight(r);
    if (weight == 1) return at(r.velocity);
    const double stands = at(Vector3d::Zero());
    return stands + weight * (at(r.velocity) - stands);
}

namespace {

/// The mixture of the tangential laws of all pushing surfaces, each weighted by its part of the normal force.
struct Mixture {
    FrictionLaw law;  // without viscous friction
    double viscous = 0, braking = 0;
    Vector3d surface_velocity = Vector3d::Zero(), relief = Vector3d::Zero();
};

class Mixer {
  public:
    Mixer(const ContactState& contact, const Arena& arena, const Probe& probe,
          const SceneState& state) noexcept
        : contact_(contact), arena_(arena), probe_(probe), state_(state), s_(contact.fade.share_of_new()) {}

    // Coefficients are weighted by each plane's part of the normal force. Viscous friction does not depend on
    // that force, so it is weighted by its set's share.
    Mixture mix() const noexcept {
        double total = 0, total_now = 0, total_old = 0;
        each([&](bool now, std::uint32_t, double push) {
            total += push;
            (now ? total_now : total_old) += push;  // kept apart, since their difference may round to zero
        });
        Mixture mixture;
        if (!(total > 0)) return mixture;
        double leading = 0;
        each([&](bool now, std::uint32_t member, double push) {
            if (!(push > 0)) return;
            const double of_set = now ? s_ * push / total_now : (1 - s_) * push / total_old;
            add(mixture, leading, now ? contact_.now : contact_.old, member, push, push / total, of_set);
        });
        return mixture;
    }

  private:
    // visit(in the new set, member, newtons)
    template <class Visit>
    void each(Visit visit) const noexcept {
        const auto stiffness_of = [&](Owner o) { return state_.records[o].stiffness; };
        each_push(contact_.now, arena_, stiffness_of, s_,
                  [&](std::uint32_t i, double push) { visit(true, i, push); });
        if (!contact_.fade.under_way) return;
        each_push(contact_.old, arena_, stiffness_of, 1 - s_,
                  [&](std::uint32_t i, double push) { visit(false, i, push); });
    }

    void add(Mixture& mixture, double& leading, const ContactSet& set, std::uint32_t member, double push,
             double share, double of_set) const noexcept {
        const Owner owner = arena_.owner[member];
        if (owner == frozen_plane_owner) {
            mixture.viscous += of_set * contact_.frozen_plane.law.viscous;
            return add_share(mixture.law, leading, contact_.frozen_plane.law, share);
        }
        const Record& r = state_.records[owner];
        mixture.surface_velocity += share * state_.silence.velocity_of(r);
        if (!r.has_tangential) return add_share(mixture.law, leading, FrictionLaw{}, share);
        const TangentialRecord& feel = state_.records.tangential(owner);
        add_share(mixture.law, leading, feel.share == 1 ? feel.law : scaled(feel.law, feel.share), share);
        mixture.viscous += of_set * feel.share * feel.law.viscous;
        mixture.braking += share * feel.braking;
        if (!r.textured) return;
        const Vector3d n(arena_.nx[member], arena_.ny[member], arena_.nz[member]);
        std::uint32_t part = 0;  // index among its surface's contacts
        while (member - part > set.begin && arena_.owner[member - part - 1] == owner) ++part;
        Relief under = relief(feel.texture, foot_of(probe_, feel.height[part], n), n, feel.shift);
        under.slope *= texture_gain_of(r, feel.texture, probe_, state_);
        mixture.relief += texture_force(feel.texture, under, push, state_.limits);
    }

    const ContactState& contact_;
    const Arena& arena_;
    const Probe& probe_;
    const SceneState& state_;
    const double s_;  // the new set's share
};

/// In how many directions the probe may slide: across one plane, along the edge of two, or not at all.
Tangent tangent_of(const ContactState& contact, const Arena& a, const Vector3d& normal) noexcept {
    Tangent tangent{.normal = normal};
    const ContactSet& set = contact.now.touching || !contact.fade.under_way ? contact.now : contact.old;
    if (set.layers == 0) return tangent;
    const ActiveSet& active = set.layer[0].solution.active;
    if (active.count == 3) tangent.dimensions = 0;
    if (active.count != 2) return tangent;
    const auto normal_of = [&](std::uint32_t i) -> Vector3d {
        if (set.layer[0].joined) return to_eigen(set.corner[i]);
        const std::uint32_t at = set.begin + active.plane[i];
        return Vector3d(a.nx[at], a.ny[at], a.nz[at]);
    };
    const Vector3d line = normal_of(0).cross(normal_of(1));
    const double length = line.norm();
    // Two planes within a ten-thousandth of a degree form no corner.
    if (length > 1e-6) {
        tangent.line = line / length;
        tangent.dimensions = 1;
    }
    return tangent;
}

/// N, along the normal: takes a share of the hand's momentum away at entry.
double braking_pulse(TangentialState& state, double braking, double entry, double mass, double dt) noexcept {
    if (braking > 0 && state.apart >= rearm_time) {
        state.pulse = braking * mass * std::max(0.0, entry) / pulse_time;
        state.pulse_left = pulse_time;
    }
    state.apart = 0;
    if (!(state.pulse_left > 0)) return 0;
    state.pulse_left -= dt;
    return state.pulse;
}

}  // namespace

Vector3d with_tangential(std::uint32_t p, ContactSets& sets, const SceneState& state, const Vector3d& force,
                         double dt) noexcept {
    ContactState& contact = sets[p];
    TangentialState& tangential = contact.tangential;
    const Probe& probe = state.probes[p].probe;
    const double normal_force = force.norm();
    tangential.friction_force.setZero();
    tangential.relief.setZero();
    if (!(normal_force > 0)) {
        tangential.law = FrictionLaw{};
        friction_force(tangential.law, tangential.friction, {}, {}, state.limits, dt);
        tangential.apart += dt;
        tangential.pulse_left = 0;
        return force;
    }
    tangential.tangent = tangent_of(contact, sets.arena(), force / normal_force);
    const Mixture mixture = Mixer(contact, sets.arena(), probe, state).mix();
    tangential.relief = mixture.relief;
    FrictionLaw law = mixture.law;
    law.viscous = std::min(mixture.viscous, largest_damping(state.limits));
    tangential.law = law;
    law.viscous *= state.scales.damping / state.scales.contacts;
    tangential.friction_force = friction_force(law, tangential.friction, tangential.tangent,
                                               {.position = probe.position,
                                                .velocity = probe.smooth_velocity,
                                                .surface_velocity = mixture.surface_velocity,
                                                .normal_force = normal_force},
                                               state.limits, dt);
    const double entry = -(probe.velocity - mixture.surface_velocity).dot(tangential.tangent.normal);
    const double pulse = braking_pulse(tangential, mixture.braking, entry, state.limits.mass, dt);
    return clamped(force + tangential.friction_force + tangential.relief + pulse * tangential.tangent.normal,
                   state.limits.max_force);
}

}  // namespace knurl::detail
