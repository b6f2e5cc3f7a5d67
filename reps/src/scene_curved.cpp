// The joint contact solution where surfaces are curved. Their tangent planes at the probe's own feet are solved
// first, as everywhere. What is found is exact where one surface holds alone (its foot is the nearest point)
// and no other is violated there, or where all that hold are flat; else it is sought where they meet.

#include <algorithm>
#include <cmath>
#include <limits>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

// Of the hand. m: an error that no force shows.
constexpr double exact_of_hand = 1e-15;
// 1/m: what is round somewhere (the edges of a box) may be flat at x_k and not where the step ends.
constexpr double least_bend = 10;
// By how much more than the hand a place moves that holds it where surfaces curve as sharply as it is deep in
// them: in the middle of a hole whose rim holds it by any amount.
constexpr double most_per_motion = 4;
constexpr double least_jump = 1e-6;  // m: of a millinewton, which nobody feels

}  // namespace

// Where it came to in the last cycle that took time; null: it is not known. One that is solved again, of more
// surfaces or without time passing, starts from the same: so its answer is the same to the bit.
const CurvedStart* SceneCore::start_of(const Layer& layer) const noexcept {
    const CurvedStart& newest = layer.reached[layer.newest];
    const bool again = newest.cycle == (step_ > 0 ? cycle_ : last_timed_);
    if (again) return layer.started ? &layer.reached[layer.newest ^ 1u] : nullptr;
    return newest.cycle == last_timed_ && last_timed_ > 0 ? &newest : nullptr;
}

CurvedStarts SceneCore::starts_of(const ContactSet& set, const Group& group) const noexcept {
    const Arena& a = arenas_[arena_];
    CurvedStarts starts;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        const CurvedStart* const start = start_of(layer);
        if (set.curved ? !start || start->active.count == 0 : layer.solution.active.count == 0) continue;
        // A set that was flat may not be any more: it was held where its planes meet.
        CurvedStart from;
        if (set.curved) {
            from = *start;
        } else {
            from.dx = layer.solution.dx;
            from.p = group.position;
            from.active = layer.solution.active;
            from.multiplier = layer.solution.multiplier;
        }
        starts.stiffness[starts.count] = layer.stiffness;
        starts.dx[starts.count] = to_plain(from.dx);
        starts.p[starts.count] = to_plain(from.p);
        starts.pushes[starts.count] = from.active.count;
        for (std::uint32_t k = 0; k < from.active.count; ++k) {
            const std::uint32_t at = set.begin + from.active.plane[k];
            std::uint32_t part = 0;
            while (at - part > set.begin && a.owner[at - part - 1] == a.owner[at]) ++part;
            starts.by[starts.count][k] = {a.owner[at], part, from.multiplier[k]};
        }
        ++starts.count;
    }
    return starts;
}

void SceneCore::take_starts(ContactSet& set, const Arena& arena, const CurvedStarts& starts) noexcept {
    for (std::uint32_t j = 0; set.curved && starts.count > 0 && j < set.layers; ++j) {
        Layer& layer = set.layer[j];
        std::uint32_t nearest = 0;
        const auto apart = [&](std::uint32_t i) { return std::abs(starts.stiffness[i] - layer.stiffness); };
        for (std::uint32_t i = 1; i < starts.count; ++i) {
            if (apart(i) < apart(nearest)) nearest = i;
        }
        CurvedStart& start = layer.reached[layer.newest];
        start = CurvedStart{};
        start.dx = to_eigen(starts.dx[nearest]);
        start.p = to_eigen(starts.p[nearest]);
        start.cycle = last_timed_;
        ActiveSet& active = start.active;
        for (std::uint32_t k = 0; k < starts.pushes[nearest]; ++k) {
            const CurvedStarts::Push& by = starts.by[nearest][k];
            std::uint32_t i = set.begin;
            while (i < set.begin + layer.count && arena.owner[i] != by.owner) ++i;
            if (i + by.part >= set.begin + layer.count) continue;
            start.multiplier[active.count] = by.multiplier;
            active.plane[active.count++] = i + by.part - set.begin;
        }
    }
}

// A texture's relief is that of the probe's foot.
double SceneCore::relief_at(Owner owner, std::uint32_t member, std::uint32_t part) const noexcept {
    if (!record(owner).textured) return 0;
    return -arenas_[arena_].s[member] - rough(owner).height[part];
}

// Is it where the surfaces themselves meet, what their planes at the probe's feet have told?
bool SceneCore::meet_elsewhere(const ContactSet& set, const Group& group, const Layer& layer) const noexcept {
    const Arena& a = arenas_[arena_];
    const ActiveSet& active = layer.solution.active;
    const auto holds = [&](std::uint32_t member) {
        return (active.count > 0 && set.begin + active.plane[0] == member) ||
               (active.count > 1 && set.begin + active.plane[1] == member) ||
               (active.count > 2 && set.begin + active.plane[2] == member);
    };
    const auto lies_elsewhere = [&](std::uint32_t first, const KindOps& ops, Owner owner) {
        std::array<CurvedContact, max_contacts> found;
        Probe there = group.probe;
        there.position += layer.solution.dx;
        const std::uint32_t count = ops.curved_at(record(owner), group.probe, there, found);
        for (std::uint32_t part = 0; part < count; ++part) {
            const std::uint32_t i = first + part;
            if (holds(i) ? active.count > 1 : found[part].height + relief_at(owner, i, part) < 0) return true;
        }
        return false;
    };
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t first = a.moving[m].member;
        if (first >= set.begin + layer.count) continue;
        const Owner owner = a.owner[first];
        const KindOps& ops = kind_ops()[record(owner).kind];
        if (!ops.curved) continue;
        bool near = false;  // one that holds alone does so at its foot
        for (std::uint32_t i = first; i < first + ops.contacts; ++i)
            near = near || (-a.s[i] < layer.far && (active.count != 1 || !holds(i)));
        if (near && lies_elsewhere(first, ops, owner)) return true;
    }
    return false;
}

// Those that may matter no farther than `within` from the probe, as they are at p + dx. More than there is room
// for: none.
std::uint32_t SceneCore::list_near_surfaces(const ContactSet& set, const Group& group, const Layer& layer,
                                            const Vector3d& dx, double within) noexcept {
    const Arena& a = arenas_[arena_];
    std::array<CurvedContact, max_contacts> found;
    Probe there = group.probe;
    there.position += dx;
    std::uint32_t size = 0;
    for (std::uint32_t i = set.begin; i < set.begin + layer.count;) {
        const Owner owner = a.owner[i];
        const bool stands = owner == bridge_owner || record(owner).stands;
        const KindOps* const ops = stands ? nullptr : &kind_ops()[record(owner).kind];
        const std::uint32_t parts = stands ? 1 : ops->contacts;
        bool near = false;
        for (std::uint32_t part = 0; part < parts; ++part) near = near || a.s[i + part] >= -within;
        const std::uint32_t count =
            near && ops && ops->curved ? ops->curved_at(record(owner), group.probe, there, found) : 0;
        for (std::uint32_t part = 0; near && part < parts; ++part) {
            const std::uint32_t at = i + part;
            if (!(a.s[at] >= -within)) continue;
            if (size == max_near_surfaces) return 0;
            NearSurface& surface = near_surfaces_[size++];
            surface.member = at - set.begin;
            surface.holds = false;
            surface.curved = part < count;
            if (surface.curved) {
                surface.at = found[part];
                surface.at.height += relief_at(owner, at, part);
            } else {
                surface.at = {.normal = {a.nx[at], a.ny[at], a.nz[at]}};
                surface.at.height = surface.at.normal.dot(dx) - a.s[at];
            }
        }
        i += parts;
    }
    return size;
}

// False: the surfaces contradict each other, as far as their planes show it.
bool SceneCore::solve_curved_layer(ContactSet& set, const Group& group, Layer& layer, double worst) noexcept {
    const Arena& a = arenas_[arena_];
    const Vector3d& p = group.probe.position;
    const bool softest = &layer == set.layer.data();
    const ContactPlanes planes{&a.nx[set.begin], &a.ny[set.begin], &a.nz[set.begin], &a.s[set.begin],
                               layer.count};
    const bool feasible = solve_planes(layer, planes, worst, p);
    layer.far = layer.solution.dx.norm();
    layer.joined = false;
    // The hand has come from nearer than it was held: else it begins where the planes meet.
    const CurvedStart* const start = start_of(layer);
    const double motion = start ? (p - start->p).norm() : 0;
    bool warm = start && start->active.count > 0 && start->dx.norm() >= motion;
    const auto explained = [&](const ContactSolution& to) {  // m: a way of x that no surface has let go for
        double speed = 0;
        for (std::uint32_t k = 0; k < to.active.count; ++k) {
            const Owner owner = a.owner[set.begin + to.active.plane[k]];
            if (owner != bridge_owner) speed = std::max(speed, record(owner).velocity.norm());
        }
        return most_per_motion * (motion + speed * limits_.period);
    };
    // Where the planes' solution lies farther off, it is another place, though nearer: the one that holds goes on.
    // Not so one that holds alone, as it did, nor what is flat: they answer as if there were no other.
    const auto is_curved = [&](std::uint32_t plane) {
        const Owner owner = a.owner[set.begin + plane];
        return owner != bridge_owner && !record(owner).stands && kind_ops()[record(owner).kind].curved;
    };
    const auto any_curved = [&](const ActiveSet& active) {
        for (std::uint32_t k = 0; k < active.count; ++k)
            if (is_curved(active.plane[k])) return true;
        return false;
    };
    const bool alone = warm && layer.solution.active.count == 1 && start->active.count == 1 &&
                       layer.solution.active.plane[0] == start->active.plane[0];
    const bool flat = warm && !any_curved(layer.solution.active) && !any_curved(start->active);
    const bool jumps = warm && !alone && !flat &&
                       (layer.solution.dx - start->dx + (p - start->p)).norm() >
                           explained(layer.solution) + world_length(least_jump, limits_);
    if (feasible && !jumps && !meet_elsewhere(set, group, layer)) return true;

    ContactSolution at = layer.solution;
    if (warm) {
        at.dx = start->dx + (start->p - p);
        at.active = start->active;
        at.multiplier = start->multiplier;
    }
    const double most = 2 * std::max(layer.far, at.dx.norm());  // m: no farther, whatever happens
    const double exact = world_length(exact_of_hand, limits_);
    double within = most;
    bool done = false;
    std::array<Vec3, 3> normals{};
    for (std::uint32_t round = 0; round < max_curved_rounds && !done; ++round) {
        ++curved_rounds_;
        const std::uint32_t size = list_near_surfaces(set, group, layer, at.dx, within);
        const std::span<NearSurface> near(near_surfaces_.data(), size);
        for (NearSurface& surface : near) {
            surface.pushes = 0;
            for (std::uint32_t k = 0; k < at.active.count; ++k) {
                if (at.active.plane[k] == surface.member) surface.pushes = at.multiplier[k];
            }
        }
        const CurvedStep step = solve_curved_step(near, at.dx);
        if (size == 0 || !step.found) {
            if (!warm) return feasible;
            warm = false;
            at = layer.solution;
            continue;
        }
        at.active = step.active;
        at.multiplier = step.multiplier;
        for (std::uint32_t k = 0; k < step.active.count; ++k) {
            NearSurface& surface = near[step.active.plane[k]];
            at.active.plane[k] = surface.member;
            normals[k] = to_plain(surface.at.normal);
            surface.pushes -= step.multiplier[k];
            surface.holds = true;
        }
        // The next step makes up for what the bend of the surfaces has changed on the way, and what the change
        // of their multipliers has changed of this one.
        const double length = step.step.norm();
        double bend = 0, change = 0;
        bool missed = false;  // one that the step did not touch may bend into it
        for (const NearSurface& surface : near) {
            if (!surface.curved) continue;
            const double by = std::max(least_bend / limits_.metre, surface.at.bend.norm());
            if (surface.holds || surface.pushes != 0) {
                bend = std::max(bend, by);
                change += std::abs(surface.pushes);
            } else {
                const double left = surface.at.height + surface.at.normal.dot(step.step);
                missed = missed || (left < by * length * length && by * length * length > exact);
            }
        }
        // What is no more than rounding is no step: a hand at rest feels the same to the bit.
        const double scale = p.lpNorm<1>() + at.dx.lpNorm<1>();
        if (length > std::max(exact / 8, 4 * std::numeric_limits<double>::epsilon() * scale))
            at.dx += step.step;
        done = !missed && bend * length * (length + change) <= exact;
        layer.far = std::max(layer.far, at.dx.norm());
        within = std::max(within, 2 * at.dx.norm());
    }
    layer.far = std::max(layer.far, within);  // all that was listed has been asked, then
    if (!at.dx.allFinite() || (!done && at.dx.norm() > most)) return feasible;
    // Where it has to go farther than the hand explains, since the place that held it is none any more, it slides.
    if (warm) {
        const Vector3d from = start->dx + (start->p - p), way = at.dx - from;
        const double length = way.norm();
        const double room =
            std::max(explained(at), world_length(policy_.rise_speed, limits_) * limits_.period);
        if (length > room) at.dx = from + (room / length) * way;
    }
    at.status = ContactSolution::Status::solved;
    layer.solution = at;
    layer.proxy = p + at.dx;
    layer.give = 0;
    if (softest) set.corner = normals;
    layer.joined = true;
    return true;
}

bool SceneCore::solve_curved(ContactSet& set, const Group& group, Layer& layer, double worst) noexcept {
    if (step_ > 0 && layer.reached[layer.newest].cycle != cycle_) {
        layer.started = start_of(layer) != nullptr;
        layer.newest ^= 1u;
        layer.reached[layer.newest].cycle = cycle_;
    }
    const bool feasible = solve_curved_layer(set, group, layer, worst);
    if (step_ > 0) {
        CurvedStart& reached = layer.reached[layer.newest];
        reached.dx = layer.solution.dx;
        reached.p = group.probe.position;
        reached.active = layer.solution.active;
        reached.multiplier = layer.solution.multiplier;
        reached.cycle = cycle_;
    }
    return feasible;
}

// At the end of a cycle: within it a surface that is asked again answers the same.
void SceneCore::lean(const ContactSet& set, const Group& group) noexcept {
    const Arena& a = arenas_[arena_];
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        if (layer.solution.active.count < 2) continue;
        Probe there = group.probe;
        there.position = layer.proxy;
        for (std::uint32_t k = 0; k < layer.solution.active.count; ++k) {
            const Owner owner = a.owner[set.begin + layer.solution.active.plane[k]];
            if (owner == bridge_owner) continue;
            const KindOps& ops = kind_ops()[record(owner).kind];
            if (ops.curved) ops.lean(record(owner), there);
        }
    }
}

}  // namespace knurl::detail
