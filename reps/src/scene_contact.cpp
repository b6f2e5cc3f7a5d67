// The joint contact solution of each probe, layered by stiffness, and the cross-fade between two such sets.

#include <cmath>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

// F = sum_j (k_j - k_{j-1}) (x_j - p), x_j the nearest point to p that satisfies all planes of stiffness k_j
// or more: a sum of gradients, so conservative, and with weights that add up to the largest k, so no stiffer
// than that.
void SceneCore::evaluate_set(ContactSet& set, const Group& group, double dt) noexcept {
    set.force.setZero();
    set.elastic = 0;
    set.touching = false;
    if (set.count == 0) return;
    Arena& a = arenas_[arena_];
    const std::uint32_t begin = set.begin;
    const Vector3d& p = group.probe.position;
    double worst =
        shift_to_probe(&a.nx[begin], &a.ny[begin], &a.nz[begin], &a.c[begin], set.count, p, &a.s[begin]);
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t i = a.moving[m];
        Record& r = record(a.owner[i]);
        if (r.met != cycle_) {  // in both sets of a fade, but one surface: its state advances once
            r.contact = kind_ops()[r.kind].contact(r, group.probe, dt);
            r.met = cycle_;
            ++evaluated_;
        }
        a.nx[i] = r.contact.normal.x();
        a.ny[i] = r.contact.normal.y();
        a.nz[i] = r.contact.normal.z();
        a.s[i] = -r.contact.height;
        a.b[i] = r.contact.damping * (set.scale == 1 ? r.weight : 1);
        worst = std::max(worst, a.s[i]);
    }
    if (!(worst > 0)) {
        for (std::uint32_t j = 0; j < set.layers; ++j) {
            set.layer[j].solution.dx.setZero();
            set.layer[j].solution.active.count = 0;
            set.layer[j].proxy = p;
        }
        set.infeasible = false;
        return;
    }
    evaluated_ += set.count - set.moving_count;

    bool infeasible = false;
    double below = 0;
    const Layer* top = nullptr;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        Layer& layer = set.layer[j];
        if (j > 0 && layer.count < set.layer[j - 1].count) {
            worst = a.s[begin];
            for (std::uint32_t i = begin + 1; i < begin + layer.count; ++i) worst = std::max(worst, a.s[i]);
        }
        const ContactPlanes planes{&a.nx[begin], &a.ny[begin], &a.nz[begin], &a.s[begin], layer.count};
        // Contradictory planes that stand still give way once and for all; moving ones are asked afresh.
        if (set.moving_count > 0) layer.give = 0;
        solve_contact_relaxed(planes, worst, layer.give, layer.solution);
        if (layer.solution.status == ContactSolution::Status::solved) {
            layer.proxy = p + layer.solution.dx;
        } else {  // bounded whatever happens: the proxy stays where it was
            layer.solution.dx = layer.proxy - p;
            layer.solution.active.count = 0;
            infeasible = true;
        }
        infeasible = infeasible || layer.give > 0;
        set.force += (layer.stiffness - below) * layer.solution.dx;
        below = layer.stiffness;
        if (layer.solution.active.count > 0) top = &layer;
    }
    set.infeasible = infeasible;
    const double elastic = set.force.norm();
    set.elastic = elastic;
    set.touching = elastic > 0;
    if (!set.touching) return;
    if (top) {
        double weighted = 0, sum = 0;
        for (std::uint32_t i = 0; i < top->solution.active.count; ++i) {
            weighted += top->solution.multiplier[i] * a.b[begin + top->solution.active.plane[i]];
            sum += top->solution.multiplier[i];
        }
        if (weighted > 0) {  // along the force alone, and never pulling
            const Vector3d m = set.force / elastic;
            set.force = m * std::max(0.0, elastic - weighted / sum * group.probe.velocity.dot(m));
        }
    }
    set.force = clamped(set.scale * set.force, limits_.max_force);
}

void SceneCore::evaluate_contacts(double dt, Wrench& sum) noexcept {
    for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        Group& group = groups_[p];
        evaluate_set(group.now, group, dt);
        Vector3d force = group.now.force;
        if (group.fading) {
            evaluate_set(group.old, group, dt);
            if (group.fresh) {
                // A surface that rises under the hand does it no faster than rise_speed.
                const auto depth = [](const ContactSet& set) {
                    return set.layers > 0 && set.touching ? set.layer[0].solution.dx.norm() : 0.0;
                };
                const double rise = depth(group.now) - depth(group.old);
                if (rise > 0) group.time = std::max(group.time, rise / policy_.rise_speed);
                group.fresh = false;
            }
            group.elapsed += dt;
            if (group.elapsed >= group.time * (1 - 1e-9)) {
                end_fade(group);
                if (group.now.count == 0) contacts_used_ &= ~(1u << p);
            } else {
                force = group.old.force + (group.elapsed / group.time) * (force - group.old.force);
            }
        }
        group.force = force;
        group.position = group.probe.position;
        sum.force += force;
        if (group.placement.offset != Vec3{}) sum.torque += group.arm.cross(force);
    }
}

}  // namespace knurl::detail
