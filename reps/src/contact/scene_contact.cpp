// The joint contact solution of each probe, layered by stiffness, and the cross-fade between two such sets.

#include <cmath>
#include <utility>

#include "broad_phase/far_planes.hpp"
#include "contact/contact_stage.hpp"
#include "scene/clamped.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

// Each widening at least doubles the radius of evaluation. So this many suffice from nanometres to a scene of
// any size.
constexpr int widenings = 64;

// The distance of the proxy from the probe (m). It is not always the first layer's: a layer that contradicts
// itself gives way, and its point may be nearer than that of a harder layer that does not.
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

// Evaluates surfaces that do not stand still. A surface may be in both sets of a fade: its state advances
// once. Returns the worst violation.
double ContactStage::evaluate_moving(ContactSet& set, const Probe& probe, double dt, double worst) noexcept {
    Arena& a = sets_.arena();
    std::uint32_t near = 0;
    a.bounding_spheres->for_each_within(
        set.moving_begin, set.moving_count, probe.position, set.slack, [&](std::uint32_t m) {
            ++near;
            set.inside += !a.moving[m].inside;
            a.moving[m].inside = true;
            worst = std::max(worst, evaluate_member(set, probe, dt, a.moving[m].member));
        });
    set.left_out = near < set.moving_count;
    if (set.inside == near) return worst;
    // Surfaces that were inside may be out of reach now. One that holds the probe at any depth has no ball at
    // the moment.
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        Moving& moving = a.moving[m];
        if (!moving.inside || a.bounding_spheres->within(m, probe.position, set.slack)) continue;
        Record& r = state_.records[a.owner[moving.member]];
        const KindOps& ops = kind_ops()[r.kind];
        if (!ops.bound(r)) {
            worst = std::max(worst, evaluate_member(set, probe, dt, moving.member));
            continue;
        }
        std::fill_n(a.s.begin() + moving.member, ops.contacts, -std::numeric_limits<double>::infinity());
        if (!(dt > 0)) continue;
        moving.inside = false;
        --set.inside;
    }
    return worst;
}

// Evaluates the surface whose first member is `i`. Returns its worst violation, among those that are solved
// together.
double ContactStage::evaluate_member(const ContactSet& set, const Probe& probe, double dt,
                                     std::uint32_t i) noexcept {
    const Owner owner = sets_.arena().owner[i];
    Record& r = state_.records[owner];
    if (r.evaluated_cycle < state_.clock.last_timed) catch_up(r, state_, set.held);
    const bool first = r.evaluated_cycle != state_.clock.cycle;
    const double step = first ? dt : 0;
    state_.work.evaluated += first;
    r.evaluated_cycle = state_.clock.cycle;
    const KindOps& ops = kind_ops()[r.kind];
    if (lead_.on && ops.follows) set_stage(set, i, first);
    const std::uint32_t count = contacts_of(r, ops, probe, step);
    if (r.has_tangential) state_.records.tangential(owner).share = found_[0].friction;
    if (r.textured) subtract_relief(r, state_.records.tangential(owner), probe, step, count);
    return put_contacts(set, r, ops.contacts, count, i);
}

// Writes into found_. A surface that holds in silence stays where it is, as in the cycle that placed it. All
// others advance: their memory of the probe's path, and a recovery.
std::uint32_t ContactStage::contacts_of(Record& r, const KindOps& ops, const Probe& probe,
                                        double step) noexcept {
    const bool held = state_.silence.holds(r);
    Motion* const stays = held && step > 0 ? ops.motion(r) : nullptr;
    const std::uint64_t placed = stays ? std::exchange(stays->placed, 1) : 0;
    const std::uint32_t count = ops.contact(r, probe, step, found_);
    if (stays) stays->placed = placed;
    if (ops.turns) {
        r.velocity = found_[0].velocity;
        if (step > 0 && !held) r.moved = state_.clock.now.of(r.options.on_silence == OnSilence::hold);
    }
    return count;
}

void ContactStage::subtract_relief(const Record& r, TangentialRecord& feel, const Probe& probe, double step,
                                   std::uint32_t count) noexcept {
    if (!state_.silence.holds(r)) feel.shift += step * r.velocity;
    const double gain = texture_gain_of(r, feel.texture, probe, state_);
    for (std::uint32_t c = 0; c < count; ++c) {
        Contact& found = found_[c];
        feel.height[c] = found.height;
        if (!std::isfinite(found.height)) continue;  // it has no foot near the probe
        const Vector3d foot = foot_of(probe, found.height, found.normal);
        found.height -= gain * relief(feel.texture, foot, found.normal, feel.shift).height;
    }
}

// Writes the first `count` contacts of `room` to members `i` on. Returns the worst violation, among those
// that are solved together.
double ContactStage::put_contacts(const ContactSet& set, const Record& r, std::uint32_t room,
                                  std::uint32_t count, std::uint32_t i) noexcept {
    Arena& a = sets_.arena();
    const auto& found = found_;
    const std::uint32_t end = set.begin + set.count;
    double worst = -std::numeric_limits<double>::infinity();
    for (std::uint32_t c = 0; c < room; ++c, ++i) {
        if (c >= count) {
            a.s[i] = -std::numeric_limits<double>::infinity();
            continue;
        }
        a.nx[i] = found[c].normal.x();
        a.ny[i] = found[c].normal.y();
        a.nz[i] = found[c].normal.z();
        a.s[i] = -found[c].height;
        a.b[i] = found[c].damping * own_weight(set, r.weight);
        if (i < end) worst = std::max(worst, a.s[i]);
    }
    return worst;
}

// Planes whose forces are summed, as in the paper.
void ContactStage::add_summed(ContactSet& set, const Probe& probe) noexcept {
    const Arena& a = sets_.arena();
    for (std::uint32_t i = set.begin + set.count; i < set.begin + set.count + set.summed; ++i) {
        if (!(a.s[i] > 0)) continue;
        const Record& r = state_.records[a.owner[i]];
        const Vector3d n(a.nx[i], a.ny[i], a.nz[i]);
        const double k = r.stiffness * own_weight(set, r.weight);
        const double b = state_.scales.damping / state_.scales.contacts * a.b[i];
        set.force +=
            std::max(0.0, k * a.s[i] - b * n.dot(probe.velocity - state_.silence.velocity_of(r))) * n;
        set.touching = true;
    }
}

// F = sum_j (k_j - k_{j-1}) (x_j - p), x_j the nearest point to p that satisfies all planes of stiffness k_j
// or more. A sum of gradients, so conservative. The weights add up to the largest k, so it is no stiffer than
// that.
const Layer* ContactStage::solve(ContactSet& set, const Probe& probe, double worst) noexcept {
    Arena& a = sets_.arena();
    const std::uint32_t begin = set.begin;
    const Vector3d& p = probe.position;
    state_.work.layers += set.layers;
    set.force.setZero();
    bool infeasible = false;
    double below = 0;
    const Layer* top = nullptr;
    PlanesApart apart;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        Layer& layer = set.layer[j];
        if (j > 0 && layer.count < set.layer[j - 1].count) {
            worst = worst_of(a, begin, layer.count);
        }
        if (set.gaps && j > 0 && lower_by_gaps(set, layer, apart)) worst = worst_of(a, begin, layer.count);
        const ContactPlanes planes{&a.nx[begin], &a.ny[begin], &a.nz[begin], &a.s[begin], layer.count};
        // The give of contradictory planes that stand still is found once, as exactly as distances round at
        // the probe's place. It is found again where the violation has halved. Moving planes are solved
        // afresh.
        if (set.moving_count > 0 || worst < layer.given_at / 2) layer.give = 0;
        if (set.curved) {
            if (j > 0 && curved_.put_planes_alone(a, set, probe, j, apart))
                worst = worst_of(a, begin, layer.count);
            infeasible = !curved_.solve(set, probe, layer, worst) || infeasible;
        } else {
            infeasible = !solve_planes(layer, planes, worst, p) || infeasible;
        }
        set.force += (layer.stiffness - below) * layer.solution.dx;
        below = layer.stiffness;
        if (layer.solution.active.count > 0) top = &layer;
    }
    apart.put_back(a);
    set.infeasible = infeasible;
    return top;
}

// Damping of each plane that holds, relative to its own surface's motion: along the force alone, and never
// pulling. Returns the size of the remaining force (N).
double ContactStage::damped_force(ContactSet& set, const Probe& probe, const Layer& top) noexcept {
    const Arena& a = sets_.arena();
    double weighted = 0, closing = 0, sum = 0;
    const double share = state_.scales.damping / state_.scales.contacts;
    const double elastic = set.force.norm();
    const Vector3d m = set.force / elastic;
    for (std::uint32_t i = 0; i < top.solution.active.count; ++i) {
        const std::uint32_t at = set.begin + top.solution.active.plane[i];
        const double b = share * top.solution.multiplier[i] * a.b[at];
        sum += top.solution.multiplier[i];
        if (!(b > 0)) continue;
        weighted += b;
        const Owner owner = a.owner[at];
        if (owner != frozen_plane_owner)
            closing += b * state_.silence.velocity_of(state_.records[owner]).dot(m);
    }
    const double felt = std::max(0.0, elastic - (weighted * probe.velocity.dot(m) - closing) / sum);
    set.force = felt * m;
    return felt;
}

// A surface out of the probe's reach might hold the proxy, whose distance from the probe is the depth of the
// contact.
[[gnu::always_inline]] inline const Layer* ContactStage::widen(ContactSet& set, const Probe& probe, double dt,
                                                               double standing, double& worst) noexcept {
    const Layer* top = solve(set, probe, worst);
    double far = proxy_distance(set);
    for (int round = 0; set.left_out && far > set.slack && round < widenings; ++round) {
        set.slack = 2 * far;
        worst = evaluate_moving(set, probe, dt, standing);
        top = solve(set, probe, worst);
        far = proxy_distance(set);
    }
    set.slack = 1.25 * far;
    return top;
}

const Layer* ContactStage::solve_widening(ContactSet& set, const Probe& probe, double dt, double standing,
                                          double& worst) noexcept {
    return widen(set, probe, dt, standing, worst);
}

// Evaluates planes that stand still. Returns the worst violation, of those that are solved together.
[[gnu::always_inline]] inline double ContactStage::scan_standing(ContactSet& set,
                                                                 const Vector3d& p) noexcept {
    Arena& a = sets_.arena();
    if (set.summed > 0) {
        const std::uint32_t from = set.begin + set.count;
        shift_to_probe(&a.nx[from], &a.ny[from], &a.nz[from], &a.c[from], set.summed, p, &a.s[from]);
    }
    // Else all of them are evaluated at the probe's place.
    return set.standing > 0 ? evaluate_standing(set, a, p) : -std::numeric_limits<double>::infinity();
}

[[gnu::always_inline]] inline void ContactStage::rest(ContactSet& set, const Probe& probe,
                                                      double dt) noexcept {
    set.slack = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        set.layer[j].solution.dx.setZero();
        set.layer[j].solution.active.count = 0;
        set.layer[j].proxy = probe.position;
    }
    set.infeasible = false;
    if (set.summed == 0) {
        set.clear.alone = dt > 0 && set.moving_count == 0;
        return;
    }
    add_summed(set, probe);
    set.force = clamped(set.scale * set.force, state_.limits.max_force);
}

void ContactStage::evaluate_set(const ContactState& contact, ContactSet& set, const ProbeState& at,
                                double dt) noexcept {
    const Probe& probe = at.probe;
    set.force.setZero();
    set.elastic = set.per_elastic = 0;
    set.touching = set.clear.alone = false;
    if (set.count + set.summed == 0) return;
    const double standing = scan_standing(set, probe.position);
    double worst = standing;
    // A surface in both sets of a fade answers the fading set as it has answered the other: by the proxy's
    // path.
    lead_.on = set.follows && (!is_alone(set) || &set == &contact.old);
    if (lead_.on) begin_path(contact, set, at.before);
    if (set.moving_count > 0) worst = evaluate_moving(set, probe, dt, standing);
    const Layer* const top = lead_.on    ? lead_proxy(set, probe, dt, standing, worst)
                             : worst > 0 ? widen(set, probe, dt, standing, worst)
                                         : nullptr;
    if (set.follows && !lead_.on) come_alone(set, worst > 0);
    if (!(worst > 0)) return rest(set, probe, dt);
    state_.work.evaluated += set.standing;

    const double elastic = set.force.norm();
    double felt = elastic;
    set.elastic = elastic;
    set.touching = elastic > 0;
    if (top && set.touching) {
        const ContactSolution& by = top->solution;
        bool damped = false;
        for (std::uint32_t i = 0; i < by.active.count; ++i)
            damped = damped || by.multiplier[i] * sets_.arena().b[set.begin + by.active.plane[i]] > 0;
        if (damped) felt = damped_force(set, probe, *top);
    }
    if (set.summed > 0) add_summed(set, probe);
    const Vector3d whole = set.scale * set.force;
    set.force = clamped(whole, state_.limits.max_force);
    if (elastic > 0) {
        set.per_elastic = felt == elastic ? set.scale : set.scale * felt / elastic;
        if (set.force != whole) set.per_elastic *= set.force.norm() / whole.norm();
    }
}

// Candidates must cover the proxy too. A contact that suddenly becomes deeper than their margin needs more
// candidates.
bool ContactStage::candidates_fall_short() noexcept {
    bool more = false;
    for_each_bit(sets_.probes() & candidates_.probes(), [&](std::uint32_t p) {
        const ContactState& contact = sets_[p];
        const double deep = std::max(contact.now.slack, contact.fade.under_way ? contact.old.slack : 0);
        if (candidates_.covers(p, state_, deep / 1.25)) return;
        const bool others = candidates_.collect(p, state_, contact.deepest());
        more = more || others || contact.old_may_be_near();
    });
    if (more) sets_.rebuild();
    return more;
}

// The force of the new set, or of both while one fades into the other.
Vector3d ContactStage::cross_fade(std::uint32_t p, double dt) noexcept {
    ContactState& contact = sets_[p];
    CrossFade& fade = contact.fade;
    if (fade.fresh) {
        // A surface that rises under the hand pushes it out no faster than rise_speed.
        const auto depth = [](const ContactSet& set) {
            return set.layers > 0 && set.touching ? set.layer[0].solution.dx.norm() : 0.0;
        };
        const double rise = depth(contact.now) - depth(contact.old);
        if (rise > 0)
            fade.time = std::max(fade.time, rise / world_length(state_.policy.rise_speed, state_.limits));
        fade.fresh = false;
    }
    fade.elapsed += dt;
    const Vector3d now = contact.now.force, old = contact.old.force;
    if (fade.elapsed < fade.time * (1 - 1e-9)) return old + fade.share_of_new() * (now - old);
    sets_.end_fade(p);
    return now;
}

void ContactStage::stay_clear(ContactState& contact, const Vector3d& p) const noexcept {
    contact.position = p;
    for (std::uint32_t j = 0; j < contact.now.layers; ++j) contact.now.layer[j].proxy = p;
}

/// The whole force of a probe's surfaces, once its sets are solved.
[[gnu::always_inline]] inline Vector3d ContactStage::felt_by(std::uint32_t p, double dt) noexcept {
    const Probe& probe = state_.probes[p].probe;
    ContactState& contact = sets_[p];
    if (contact.now.curved && contact.now.touching && dt > 0) curved_.lean(contact.now, probe);
    const Vector3d force = contact.fade.under_way ? cross_fade(p, dt) : contact.now.force;
    contact.force = force;
    if (state_.any_follows && dt > 0) {
        remember_layers(contact, probe.position);
        remember_proxy(contact.now);
        close_gaps(contact.now);
        if (contact.fade.under_way) {
            remember_proxy(contact.old);
            close_gaps(contact.old);
        }
    }
    contact.position = probe.position;
    if (!contact.tangential.needed() || (force.isZero(0) && contact.tangential.rests())) return force;
    ++state_.work.tangential;
    return with_tangential(p, sets_, state_, force, dt);
}

void ContactStage::evaluate(double dt, Wrench& sum) noexcept {
    std::uint32_t near = 0;  // bits: the probes that may touch something
    for (int round = 0; round < widenings; ++round) {
        near = 0;
        for_each_bit(sets_.probes(), [&](std::uint32_t p) {
            const ProbeState& at = state_.probes[p];
            ContactState& contact = sets_[p];
            if (contact.is_clear() && still_clear(contact.now.clear, at.probe.position))
                return stay_clear(contact, at.probe.position);
            near |= 1u << p;
            evaluate_set(contact, contact.now, at, dt);
            if (contact.fade.under_way) evaluate_set(contact, contact.old, at, dt);
        });
        if (candidates_.probes() == 0 || !candidates_fall_short()) break;
    }
    for_each_bit(near, [&](std::uint32_t p) {
        const ProbeState& at = state_.probes[p];
        const Vector3d force = state_.scales.contacts * felt_by(p, dt);
        sum.force += force;
        if (at.placement.offset != Vec3{}) sum.torque += at.arm.cross(force);
    });
}

}  // namespace knurl::detail
