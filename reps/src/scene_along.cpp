// What is felt along the surface, once per probe, on the blended contact: friction, texture, the braking
// pulse at entry.

#include <cmath>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

constexpr double pulse_time = 4e-3;   // s: Salcudean and Vlaar 1994
constexpr double rearm_time = 20e-3;  // s outside, until the next entry brakes again

// Where the surface's material rubs more or less than the rest of it.
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

bool rests_along(const Group& group) noexcept {
    return !(group.friction.residual_time > 0) && !(group.pulse_left > 0) &&
           (!group.rough || group.apart >= rearm_time);
}

// `force` is the contact's; the answer is that and all that lies along the surface.
Vector3d SceneCore::along(Group& group, const Vector3d& force, double dt) noexcept {
    const double normal_force = force.norm();
    const Arena& a = arenas_[arena_];
    const double s = group.fading ? group.elapsed / group.time : 1;
    const auto stiffness_of = [&](Owner o) { return record(o).stiffness; };
    // visit(in the new set, member, newtons)
    const auto each = [&](auto visit) {
        each_push(group.now, a, stiffness_of, s, [&](std::uint32_t i, double push) { visit(true, i, push); });
        if (!group.fading) return;
        each_push(group.old, a, stiffness_of, 1 - s,
                  [&](std::uint32_t i, double push) { visit(false, i, push); });
    };

    group.along.setZero();
    group.relief.setZero();
    if (!(normal_force > 0)) {
        group.law = FrictionLaw{};
        friction_force(group.law, group.friction, {}, {}, limits_, dt);
        group.apart += dt;
        group.pulse_left = 0;
        return force;
    }
    Tangent tangent{.normal = force / normal_force};
    const ContactSet& corner = group.now.touching || !group.fading ? group.now : group.old;
    if (corner.layers > 0) {
        const ActiveSet& active = corner.layer[0].solution.active;
        if (active.count == 3) tangent.dimensions = 0;
        if (active.count == 2) {
            const auto normal = [&](std::uint32_t i) -> Vector3d {
                if (corner.layer[0].joined) return to_eigen(corner.corner[i]);
                const std::uint32_t at = corner.begin + active.plane[i];
                return Vector3d(a.nx[at], a.ny[at], a.nz[at]);
            };
            const Vector3d line = normal(0).cross(normal(1));
            const double length = line.norm();
            // Two planes that are one to a ten-thousandth of a degree are no corner.
            if (length > 1e-6) {
                tangent.line = line / length;
                tangent.dimensions = 1;
            }
        }
    }

    // Coefficients count by each plane's part of the normal force. Viscous friction is no part of that, so it
    // comes and goes with its set.
    double total = 0, total_now = 0, total_old = 0, braking = 0, viscous = 0;
    each([&](bool now, std::uint32_t, double push) {
        total += push;
        (now ? total_now : total_old) += push;  // apart: their difference may round to nothing
    });
    FrictionLaw law;
    Vector3d surface_velocity = Vector3d::Zero();
    if (total > 0) {
        double leading = 0;
        each([&](bool now, std::uint32_t member, double push) {
            const Owner owner = a.owner[member];
            if (!(push > 0)) return;
            const double share = push / total;
            const double of_set = now ? s * push / total_now : (1 - s) * push / total_old;
            if (owner == bridge_owner) {
                viscous += of_set * group.bridge_law.viscous;
                return add_share(law, leading, group.bridge_law, share);
            }
            const Record& r = record(owner);
            surface_velocity += share * velocity_of(r);
            if (!r.rough) return add_share(law, leading, FrictionLaw{}, share);
            const Rough& feel = rough(owner);
            add_share(law, leading, feel.share == 1 ? feel.law : scaled(feel.law, feel.share), share);
            viscous += of_set * feel.share * feel.law.viscous;
            braking += share * feel.braking;
            if (!r.textured) return;
            const Vector3d n(a.nx[member], a.ny[member], a.nz[member]);
            const double gain = texture_gain_of(r, feel.texture, group);
            std::uint32_t part = 0;  // of its surface's contacts
            const std::uint32_t begin = now ? group.now.begin : group.old.begin;
            while (member - part > begin && a.owner[member - part - 1] == owner) ++part;
            Relief under = relief(feel.texture, foot_of(group, feel.height[part], n), n, feel.shift);
            under.slope *= gain;
            group.relief += texture_force(feel.texture, under, push, limits_);
        });
    }
    law.viscous = std::min(viscous, largest_damping(limits_));
    group.law = law;
    group.tangent = tangent;
    law.viscous *= scales_.damping / scales_.contacts;
    group.along = friction_force(law, group.friction, tangent,
                                 {.position = group.probe.position,
                                  .velocity = group.probe.smooth_velocity,
                                  .surface_velocity = surface_velocity,
                                  .normal_force = normal_force},
                                 limits_, dt);

    Vector3d pulse = Vector3d::Zero();
    if (braking > 0 && group.apart >= rearm_time) {
        const double entry = -(group.probe.velocity - surface_velocity).dot(tangent.normal);
        group.pulse = braking * limits_.mass * std::max(0.0, entry) / pulse_time;
        group.pulse_left = pulse_time;
    }
    group.apart = 0;
    if (group.pulse_left > 0) {
        pulse = group.pulse * tangent.normal;
        group.pulse_left -= dt;
    }
    return clamped(force + group.along + group.relief + pulse, limits_.max_force);
}

}  // namespace knurl::detail
