// The joint contact solution of each probe, layered by stiffness, and the cross-fade between two such sets.

#include <cmath>
#include <utility>

#include "clamped.hpp"
#include "far_planes.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

// Each widening at least doubles how far is asked, so this many suffice from nanometres to any scene's size.
constexpr int widenings = 64;

// How far the proxy lies from the probe (m). Not the first layer's alone: one that contradicts itself gives
// way, and may lie nearer than a harder one, which does not.
[[gnu::always_inline]] inline double proxy_distance(const ContactSet& set) noexcept {
    double square = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j)
        square = std::max(square, set.layer[j].solution.dx.squaredNorm());
    double far = std::sqrt(square);
    if (set.curved) {
        for (std::uint32_t j = 0; j < set.layers; ++j) far = std::max(far, set.layer[j].far);
    }
    return far;
}

}  // namespace

// Surfaces that do not stand still say where they are. In both sets of a fade there may be the same one: its
// state advances once. Returns the worst violation.
double SceneCore::ask(ContactSet& set, const Group& group, double dt, double worst) noexcept {
    Arena& a = arenas_[arena_];
    std::uint32_t near = 0;
    a.balls->for_near(set.moving_begin, set.moving_count, group.probe.position, set.slack,
                      [&](std::uint32_t m) {
                          ++near;
                          set.inside += !a.moving[m].inside;
                          a.moving[m].inside = true;
                          worst = std::max(worst, ask_one(set, group, dt, a.moving[m].member));
                      });
    set.left_out = near < set.moving_count;
    if (set.inside == near) return worst;
    // Some were inside and are out of reach now. One that holds the probe from however deep has no ball at
    // the moment.
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        Moving& moving = a.moving[m];
        if (!moving.inside || a.balls->near(m, group.probe.position, set.slack)) continue;
        Record& r = record(a.owner[moving.member]);
        const KindOps& ops = kind_ops()[r.kind];
        if (!ops.bound(r)) {
            worst = std::max(worst, ask_one(set, group, dt, moving.member));
            continue;
        }
        std::fill_n(a.s.begin() + moving.member, ops.contacts, -std::numeric_limits<double>::infinity());
        if (!(dt > 0)) continue;
        moving.inside = false;
        --set.inside;
    }
    return worst;
}

// The surface whose first member is `i`. Returns its worst violation, among those that are solved together.
double SceneCore::ask_one(const ContactSet& set, const Group& group, double dt, std::uint32_t i) noexcept {
    Arena& a = arenas_[arena_];
    Record& r = record(a.owner[i]);
    if (r.asked < last_timed_) prime(r, group);
    const bool held = r.use.on_silence == OnSilence::hold && silence_ > 0;
    const double step = r.asked == cycle_ ? 0 : dt;
    evaluated_ += r.asked != cycle_;
    r.asked = cycle_;
    const KindOps& ops = kind_ops()[r.kind];
    // What holds in a silence stays where it is, as in the cycle that placed it. All else goes on: what it
    // remembers of the probe's path, and a recovery.
    Motion* const stays = held && step > 0 ? ops.motion(r) : nullptr;
    const std::uint64_t placed = stays ? std::exchange(stays->placed, 1) : 0;
    const std::uint32_t count = ops.contact(r, group.probe, step, found_);
    if (stays) stays->placed = placed;
    const auto& found = found_;
    if (ops.turns) {
        r.velocity = found[0].velocity;
        if (step > 0 && !held) r.moved = now_.of(r.use.on_silence == OnSilence::hold);
    }
    if (r.rough) rough(a.owner[i]).share = found[0].friction;
    if (r.textured) {
        Rough& feel = rough(a.owner[i]);
        if (!held) feel.shift += step * r.velocity;
        const double gain = texture_gain_of(r, feel.texture, group);
        for (std::uint32_t c = 0; c < count; ++c) {
            feel.height[c] = found[c].height;
            if (!std::isfinite(found[c].height)) continue;  // nowhere near: it has no foot
            const Vector3d foot = foot_of(group, found[c].height, found[c].normal);
            found_[c].height -= gain * relief(feel.texture, foot, found[c].normal, feel.shift).height;
        }
    }
    const std::uint32_t end = set.begin + set.count;
    double worst = -std::numeric_limits<double>::infinity();
    for (std::uint32_t c = 0; c < ops.contacts; ++c, ++i) {
        if (c >= count) {
            a.s[i] = -std::numeric_limits<double>::infinity();
            continue;
        }
        a.nx[i] = found[c].normal.x();
        a.ny[i] = found[c].normal.y();
        a.nz[i] = found[c].normal.z();
        a.s[i] = -found[c].height;
        a.b[i] = found[c].damping * (set.scale == 1 ? r.weight : 1);
        if (i < end) worst = std::max(worst, a.s[i]);
    }
    return worst;
}

// A fine relief is gone at a speed that takes a few cycles to leave: what is felt of it, not the speed, moves
// on evenly.
double SceneCore::texture_gain_of(const Record& r, const Texture& texture,
                                  const Group& group) const noexcept {
    const auto at = [&](const Vector3d& velocity) {
        return texture_gain(texture, (group.probe.smooth_velocity - velocity).norm(), limits_);
    };
    const double pace = pace_of(r);
    if (pace == 1) return at(r.velocity);
    const double stands = at(Vector3d::Zero());
    return stands + pace * (at(r.velocity) - stands);
}

// Planes whose forces add up, as the paper's do.
void SceneCore::add_summed(ContactSet& set, const Group& group) noexcept {
    const Arena& a = arenas_[arena_];
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (!(a.s[i] > 0)) continue;
        const Record& r = record(a.owner[i]);
        const Vector3d n(a.nx[i], a.ny[i], a.nz[i]);
        const double k = r.stiffness * (set.scale == 1 ? r.weight : 1);
        const double b = scales_.damping / scales_.contacts * a.b[i];
        set.force += std::max(0.0, k * a.s[i] - b * n.dot(group.probe.velocity - velocity_of(r))) * n;
        set.touching = true;
    }
}

// F = sum_j (k_j - k_{j-1}) (x_j - p), x_j the nearest point to p that satisfies all planes of stiffness k_j
// or more: a sum of gradients, so conservative, and with weights that add up to the largest k, so no stiffer
// than that.
const Layer* SceneCore::solve(ContactSet& set, const Group& group, double worst) noexcept {
    const Arena& a = arenas_[arena_];
    const std::uint32_t begin = set.begin;
    const Vector3d& p = group.probe.position;
    set.force.setZero();
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
        // How far contradictory planes that stand still give way is found once, but as exactly as distances
        // round where the probe is then: again where they are half as large. Moving ones are asked afresh.
        if (set.moving_count > 0 || worst < layer.given_at / 2) layer.give = 0;
        if (set.curved) {
            infeasible = !solve_curved(set, group, layer, worst) || infeasible;
        } else {
            infeasible = !solve_planes(layer, planes, worst, p) || infeasible;
        }
        set.force += (layer.stiffness - below) * layer.solution.dx;
        below = layer.stiffness;
        if (layer.solution.active.count > 0) top = &layer;
    }
    set.infeasible = infeasible;
    return top;
}

// Damping of each plane that holds, against its own surface's motion: along the force alone, and never
// pulling. Returns the size of what is left (N).
double SceneCore::damped_force(ContactSet& set, const Group& group, const Layer& top) noexcept {
    const Arena& a = arenas_[arena_];
    double weighted = 0, closing = 0, sum = 0;
    const double share = scales_.damping / scales_.contacts;
    const double elastic = set.force.norm();
    const Vector3d m = set.force / elastic;
    for (std::uint32_t i = 0; i < top.solution.active.count; ++i) {
        const std::uint32_t at = set.begin + top.solution.active.plane[i];
        const double b = share * top.solution.multiplier[i] * a.b[at];
        sum += top.solution.multiplier[i];
        if (!(b > 0)) continue;
        weighted += b;
        const Owner owner = a.owner[at];
        if (owner != bridge_owner) closing += b * velocity_of(record(owner)).dot(m);
    }
    const double felt = std::max(0.0, elastic - (weighted * group.probe.velocity.dot(m) - closing) / sum);
    set.force = felt * m;
    return felt;
}

void SceneCore::evaluate_set(ContactSet& set, const Group& group, double dt) noexcept {
    set.force.setZero();
    set.elastic = set.per_elastic = 0;
    set.touching = false;
    if (set.count + set.summed == 0) return;
    Arena& a = arenas_[arena_];
    const std::uint32_t begin = set.begin;
    const Vector3d& p = group.probe.position;
    double worst = -std::numeric_limits<double>::infinity();
    if (set.standing > 0)  // else all of them are asked where they are
        worst = ask_standing(set, a, p);
    if (set.summed > 0) {
        const std::uint32_t from = begin + set.count;
        shift_to_probe(&a.nx[from], &a.ny[from], &a.nz[from], &a.c[from], set.summed, p, &a.s[from]);
    }
    const double standing = worst;
    if (set.moving_count > 0) worst = ask(set, group, dt, standing);
    if (!(worst > 0)) {
        set.slack = 0;
        for (std::uint32_t j = 0; j < set.layers; ++j) {
            set.layer[j].solution.dx.setZero();
            set.layer[j].solution.active.count = 0;
            set.layer[j].proxy = p;
        }
        set.infeasible = false;
        if (set.summed > 0) {
            add_summed(set, group);
            set.force = clamped(set.scale * set.force, limits_.max_force);
        }
        return;
    }
    evaluated_ += set.standing;

    const Layer* top = solve(set, group, worst);
    // What is out of reach of the probe might hold the proxy, which is as far from it as the contact is deep.
    double far = proxy_distance(set);
    for (int round = 0; set.left_out && far > set.slack && round < widenings; ++round) {
        set.slack = 2 * far;
        worst = ask(set, group, dt, standing);
        top = solve(set, group, worst);
        far = proxy_distance(set);
    }
    set.slack = 1.25 * far;
    const double elastic = set.force.norm();
    double felt = elastic;
    set.elastic = elastic;
    set.touching = elastic > 0;
    if (top && set.touching) {
        const ContactSolution& by = top->solution;
        bool damped = false;
        for (std::uint32_t i = 0; i < by.active.count; ++i)
            damped = damped || by.multiplier[i] * a.b[begin + by.active.plane[i]] > 0;
        if (damped) felt = damped_force(set, group, *top);
    }
    if (set.summed > 0) add_summed(set, group);
    const Vector3d whole = set.scale * set.force;
    set.force = clamped(whole, limits_.max_force);
    if (elastic > 0) {
        set.per_elastic = felt == elastic ? set.scale : set.scale * felt / elastic;
        if (set.force != whole) set.per_elastic *= set.force.norm() / whole.norm();
    }
}

// Candidates cover the proxy's way too: a contact that suddenly is deeper than their margin asks for more of
// them.
bool SceneCore::near_falls_short() noexcept {
    bool more = false;
    for (std::uint32_t rest = contacts_used_ & bounded_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        Group& group = groups_[p];
        const double deep = std::max(group.now.slack, group.fading ? group.old.slack : 0) / 1.25;
        const double left = group.near.margin * near_rounding - deep;
        if (left > 0 && (group.probe.position - group.near.at).squaredNorm() < left * left) continue;
        collect_near(group, p);
        more = more || sets_edited_;
    }
    if (more) rebuild_sets();
    return more;
}

void SceneCore::evaluate_contacts(double dt, Wrench& sum) noexcept {
    for (int round = 0; round < widenings; ++round) {
        for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1) {
            Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
            evaluate_set(group.now, group, dt);
            if (group.fading) evaluate_set(group.old, group, dt);
        }
        if (bounded_used_ == 0 || !near_falls_short()) break;
    }
    for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<std::uint32_t>(__builtin_ctz(rest));
        Group& group = groups_[p];
        if (group.now.curved && group.now.touching && dt > 0) lean(group.now, group);
        Vector3d force = group.now.force;
        if (group.fading) {
            if (group.fresh) {
                // A surface that rises under the hand does it no faster than rise_speed.
                const auto depth = [](const ContactSet& set) {
                    return set.layers > 0 && set.touching ? set.layer[0].solution.dx.norm() : 0.0;
                };
                const double rise = depth(group.now) - depth(group.old);
                if (rise > 0)
                    group.time = std::max(group.time, rise / world_length(policy_.rise_speed, limits_));
                group.fresh = false;
            }
            group.elapsed += dt;
            if (group.elapsed >= group.time * (1 - 1e-9)) {
                end_fade(group);
                if (group.now.count + group.now.summed == 0) {
                    contacts_used_ &= ~(1u << p);
                    release(group);
                }
            } else {
                force = group.old.force + (group.elapsed / group.time) * (force - group.old.force);
            }
        }
        group.force = force;
        group.position = group.probe.position;
        if (group.rough || group.friction.residual_time > 0) force = along(group, force, dt);
        force *= scales_.contacts;
        sum.force += force;
        if (group.placement.offset != Vec3{}) sum.torque += group.arm.cross(force);
    }
}

}  // namespace knurl::detail
