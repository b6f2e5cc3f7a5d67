// The joint contact solution where surfaces are curved. First the tangent planes at the probe's own feet are
// solved, as everywhere. Their solution is exact where one surface holds alone (its foot is the nearest
// point) and it violates no other, or where all holding surfaces are flat. Else the point where the surfaces
// meet is sought.

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/contact_stage.hpp"
#include "scene/clamped.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

// m, at the hand: an error without a perceptible force.
constexpr double exact_of_hand = 1e-15;
// 1/m: the least curvature assumed of a curved surface. A surface that is round somewhere (a box at its
// edges) may be flat at the present point and round where the step ends.
constexpr double least_bend = 10;
// The largest ratio of the proxy's motion to the hand's where the radius of curvature equals the depth. In
// the middle of a hole whose rim holds the probe, the ratio has no limit.
constexpr double most_per_motion = 4;
constexpr double least_jump = 1e-6;  // m: changes the force by a millinewton, which is imperceptible

// The solution of the last cycle that took time; null: unknown. A layer that is solved again (with more
// surfaces, or without time passing) starts from the same point, so that its answer is the same to the bit.
const CurvedStart* start_of(const Layer& layer, const Clock& clock) noexcept {
    const CurvedStart& newest = layer.reached[layer.newest];
    const bool again = newest.cycle == (clock.step > 0 ? clock.cycle : clock.last_timed);
    if (again) return layer.started ? &layer.reached[layer.newest ^ 1u] : nullptr;
    return newest.cycle == clock.last_timed && clock.last_timed > 0 ? &newest : nullptr;
}

CurvedStarts::Place named(const CurvedStart& start, const ContactSet& set, const Arena& a) noexcept {
    CurvedStarts::Place place{.dx = to_plain(start.dx),
                              .p = to_plain(start.p),
                              .cycle = start.cycle,
                              .by = {},
                              .pushes = start.active.count};
    for (std::uint32_t k = 0; k < start.active.count; ++k) {
        const std::uint32_t at = set.begin + start.active.plane[k];
        std::uint32_t part = 0;
        while (at - part > set.begin && a.owner[at - part - 1] == a.owner[at]) ++part;
        place.by[k] = {a.owner[at], part, start.multiplier[k]};
    }
    return place;
}

CurvedStart found_again(const CurvedStarts::Place& place, const ContactSet& set, const Layer& layer,
                        const Arena& a) noexcept {
    CurvedStart start;
    start.dx = to_eigen(place.dx);
    start.p = to_eigen(place.p);
    start.cycle = place.cycle;
    for (std::uint32_t k = 0; k < place.pushes; ++k) {
        const CurvedStarts::Push& by = place.by[k];
        std::uint32_t i = set.begin;
        while (i < set.begin + layer.count && a.owner[i] != by.owner) ++i;
        if (i + by.part >= set.begin + layer.count) continue;
        start.multiplier[start.active.count] = by.multiplier;
        start.active.plane[start.active.count++] = i + by.part - set.begin;
    }
    return start;
}

// A layer has the surfaces of its stiffness and all harder ones. A layer of a new stiffness starts from the
// solution of the next harder layer; one that is harder than all has no start. A stiffness that changes
// gradually (a weight) stays the same layer.
const CurvedStarts::OfLayer* start_for(const CurvedStarts& starts, double stiffness) noexcept {
    constexpr double same = 0.9;
    for (std::uint32_t j = 0; j < starts.count; ++j)
        if (starts.layer[j].stiffness >= stiffness) return &starts.layer[j];
    const bool any = starts.count > 0 && starts.layer[starts.count - 1].stiffness >= same * stiffness;
    return any ? &starts.layer[starts.count - 1] : nullptr;
}

}  // namespace

CurvedStarts starts_of(const ContactSet& set, const ContactState& contact, const Arena& a,
                       const Clock& clock) noexcept {
    CurvedStarts starts;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        CurvedStarts::OfLayer& of = starts.layer[starts.count++];
        of.stiffness = layer.stiffness;
        if (set.curved) {
            of.newest = named(layer.reached[layer.newest], set, a);
            of.before = named(layer.reached[layer.newest ^ 1u], set, a);
            of.started = layer.started;
            continue;
        }
        // A flat set may become curved: its solution is where its planes meet.
        CurvedStart from;
        from.dx = layer.solution.dx;
        from.p = contact.position;
        from.active = layer.solution.active;
        from.multiplier = layer.solution.multiplier;
        from.cycle = clock.last_timed;
        of.newest = named(from, set, a);
    }
    return starts;
}

void take_starts(ContactSet& set, const Arena& arena, const CurvedStarts& starts) noexcept {
    for (std::uint32_t j = 0; set.curved && j < set.layers; ++j) {
        Layer& layer = set.layer[j];
        const CurvedStarts::OfLayer* const of = start_for(starts, layer.stiffness);
        if (!of) continue;
        layer.reached[layer.newest] = found_again(of->newest, set, layer, arena);
        layer.reached[layer.newest ^ 1u] = found_again(of->before, set, layer, arena);
        layer.started = of->started;
    }
}

// The relief of a texture is taken at the probe's foot.
double CurvedStage::relief_at(Owner owner, std::uint32_t member, std::uint32_t part) const noexcept {
    if (!state_.records[owner].textured) return 0;
    return -sets_.arena().s[member] - state_.records.tangential(owner).height[part];
}

// Do the surfaces meet at another point than their tangent planes at the probe's feet do?
bool CurvedStage::meet_elsewhere(const ContactSet& set, const Probe& probe,
                                 const Layer& layer) const noexcept {
    const Arena& a = sets_.arena();
    const ActiveSet& active = layer.solution.active;
    const auto holds = [&](std::uint32_t member) {
        return (active.count > 0 && set.begin + active.plane[0] == member) ||
               (active.count > 1 && set.begin + active.plane[1] == member) ||
               (active.count > 2 && set.begin + active.plane[2] == member);
    };
    const auto lies_elsewhere = [&](std::uint32_t first, const KindOps& ops, Owner owner) {
        std::array<CurvedContact, max_contacts> found;
        Probe there = probe;
        there.position += layer.solution.dx;
        const std::uint32_t count = ops.curved_at(state_.records[owner], probe, there, found);
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
        const KindOps& ops = kind_ops()[state_.records[owner].kind];
        if (!ops.curved) continue;
        bool near = false;  // a surface that holds alone holds at its foot
        for (std::uint32_t i = first; i < first + ops.contacts; ++i)
            near = near || (-a.s[i] < layer.far && (active.count != 1 || !holds(i)));
        if (near && lies_elsewhere(first, ops, owner)) return true;
    }
    return false;
}

// Lists the surfaces within `within` of the probe, evaluated at p + dx. Lists none if there are more than
// fit.
std::uint32_t CurvedStage::list_near_surfaces(const ContactSet& set, const Probe& probe, const Layer& layer,
                                              const Vector3d& dx, double within, Room& room) noexcept {
    const Arena& a = sets_.arena();
    std::array<CurvedContact, max_contacts> found;
    Probe there = probe;
    there.position += dx;
    std::uint32_t size = 0;
    for (std::uint32_t i = set.begin; i < set.begin + layer.count;) {
        const Owner owner = a.owner[i];
        const bool stands = owner == frozen_plane_owner || state_.records[owner].stands;
        const KindOps* const ops = stands ? nullptr : &kind_ops()[state_.records[owner].kind];
        const std::uint32_t parts = stands ? 1 : ops->contacts;
        bool near = false;
        for (std::uint32_t part = 0; part < parts; ++part) near = near || a.s[i + part] >= -within;
        const std::uint32_t count =
            near && ops && ops->curved ? ops->curved_at(state_.records[owner], probe, there, found) : 0;
        for (std::uint32_t part = 0; near && part < parts; ++part) {
            const std::uint32_t at = i + part;
            if (!(a.s[at] >= -within)) continue;
            if (size == max_near_surfaces) return 0;
            NearSurface& surface = *new (room.at(size++)) NearSurface;
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

// m: how far the motion of hand and surfaces can move the proxy without a surface letting go.
double CurvedStage::explained(const ContactSet& set, const ContactSolution& to,
                              double motion) const noexcept {
    double speed = 0;
    for (std::uint32_t k = 0; k < to.active.count; ++k) {
        const Owner owner = sets_.arena().owner[set.begin + to.active.plane[k]];
        if (owner != frozen_plane_owner) speed = std::max(speed, state_.records[owner].velocity.norm());
    }
    return most_per_motion * (motion + speed * state_.limits.period);
}

bool CurvedStage::any_curved(const ContactSet& set, const ActiveSet& active) const noexcept {
    for (std::uint32_t k = 0; k < active.count; ++k) {
        const Owner owner = sets_.arena().owner[set.begin + active.plane[k]];
        if (owner == frozen_plane_owner || state_.records[owner].stands) continue;
        if (kind_ops()[state_.records[owner].kind].curved) return true;
    }
    return false;
}

// Does the planes' solution lie farther from the last one than the hand's motion explains? Then it is another
// local minimum, though a nearer one, and the present surfaces continue to hold. Exceptions: one surface that
// holds alone as before, and flat ones, whose solution does not depend on the last one.
bool CurvedStage::jumps(const ContactSet& set, const CurvedStart& start, const Layer& layer,
                        const Vector3d& p) const noexcept {
    const ActiveSet &now = layer.solution.active, &then = start.active;
    if (now.count == 1 && then.count == 1 && now.plane[0] == then.plane[0]) return false;
    if (!any_curved(set, now) && !any_curved(set, then)) return false;
    return (layer.solution.dx - start.dx + (p - start.p)).norm() >
           explained(set, layer.solution, (p - start.p).norm()) + world_length(least_jump, state_.limits);
}

// The surfaces near the probe, evaluated at `at`, and how much each pushed there.
std::span<NearSurface> CurvedStage::near_surfaces(const ContactSet& set, const Probe& probe,
                                                  const Layer& layer, const Descent& descent,
                                                  Room& room) noexcept {
    const ContactSolution& at = descent.at;
    const std::uint32_t size = list_near_surfaces(set, probe, layer, at.dx, descent.within, room);
    if (size == 0) return {};
    const std::span<NearSurface> near(room.at(0), size);
    for (NearSurface& surface : near) {
        surface.pushes = 0;
        for (std::uint32_t k = 0; k < at.active.count; ++k) {
            if (at.active.plane[k] == surface.member) surface.pushes = at.multiplier[k];
        }
    }
    return near;
}

// Takes one step. The next step corrects for the bend of the surfaces over this step, and for the change of
// their multipliers.
void CurvedStage::take_step(std::span<NearSurface> near, const CurvedStep& step, const Vector3d& p,
                            Descent& descent) const noexcept {
    ContactSolution& at = descent.at;
    at.active = step.active;
    at.multiplier = step.multiplier;
    for (std::uint32_t k = 0; k < step.active.count; ++k) {
        NearSurface& surface = near[step.active.plane[k]];
        at.active.plane[k] = surface.member;
        descent.normals[k] = to_plain(surface.at.normal);
        surface.pushes -= step.multiplier[k];
        surface.holds = true;
    }
    const double exact = world_length(exact_of_hand, state_.limits), length = step.step.norm();
    double bend = 0, change = 0;
    bool missed = false;  // a surface that the step did not use may bend into the step
    for (const NearSurface& surface : near) {
        if (!surface.curved) continue;
        const double by = std::max(least_bend / state_.limits.metre, surface.at.bend.norm());
        if (surface.holds || surface.pushes != 0) {
            bend = std::max(bend, by);
            change += std::abs(surface.pushes);
        } else {
            const double left = surface.at.height + surface.at.normal.dot(step.step);
            missed = missed || (left < by * length * length && by * length * length > exact);
        }
    }
    // A step within rounding is left out: a hand at rest gets the same force to the bit.
    const double scale = p.lpNorm<1>() + at.dx.lpNorm<1>();
    if (length > std::max(exact / 8, 4 * std::numeric_limits<double>::epsilon() * scale)) at.dx += step.step;
    descent.done = !missed && bend * length * (length + change) <= exact;
    descent.within = std::max(descent.within, 2 * at.dx.norm());
}

// The multipliers of a descent that has not converged belong to no solution, but the next cycle would start
// with them, and between contradictory surfaces they would grow without bound. They are replaced by those of
// the point nearest to dx.
void CurvedStage::balance(Descent& descent) noexcept {
    ContactSolution& at = descent.at;
    std::array<double, 3> nx{}, ny{}, nz{}, s{};
    double worst = 0;
    for (std::uint32_t k = 0; k < at.active.count; ++k) {
        const Vector3d n = to_eigen(descent.normals[k]);
        nx[k] = n.x(), ny[k] = n.y(), nz[k] = n.z();
        s[k] = n.dot(at.dx);
        worst = std::max(worst, s[k]);
    }
    ContactSolution nearest;
    if (worst > 0)
        solve_contact({nx.data(), ny.data(), nz.data(), s.data(), at.active.count}, worst, 0, nearest);
    at.multiplier = {};
    for (std::uint32_t i = 0; i < nearest.active.count; ++i)
        at.multiplier[nearest.active.plane[i]] = nearest.multiplier[i];
}

// The point that held the hand no longer exists. If the new one is farther away than the hand's motion
// explains, the proxy moves there with a limited speed.
void CurvedStage::slide(const ContactSet& set, const CurvedStart& start, const Vector3d& p,
                        ContactSolution& at) const noexcept {
    const Vector3d from = start.dx + (start.p - p), way = at.dx - from;
    const double room =
        std::max(explained(set, at, (p - start.p).norm()),
                 world_length(state_.policy.rise_speed, state_.limits) * state_.limits.period);
    const double length = way.norm();
    if (length > room) at.dx = from + (room / length) * way;
}

bool CurvedStage::solve_layer(ContactSet& set, const Probe& probe, Layer& layer, double worst) noexcept {
    const Arena& a = sets_.arena();
    const Vector3d& p = probe.position;
    const ContactPlanes planes{&a.nx[set.begin], &a.ny[set.begin], &a.nz[set.begin], &a.s[set.begin],
                               layer.count};
    const bool feasible = solve_planes(layer, planes, worst, p);
    layer.far = layer.solution.dx.norm();
    layer.joined = false;
    // A warm start needs a hand that moved less than its depth. Otherwise the descent starts where the planes
    // meet.
    const CurvedStart* const start = start_of(layer, state_.clock);
    Descent descent{.at = layer.solution};
    descent.warm = start && start->active.count > 0 && start->dx.norm() >= (p - start->p).norm();
    const bool elsewhere = descent.warm && jumps(set, *start, layer, p);
    if (feasible && !elsewhere && !meet_elsewhere(set, probe, layer)) return true;

    ContactSolution& at = descent.at;
    if (descent.warm) {
        at.dx = start->dx + (start->p - p);
        at.active = start->active;
        at.multiplier = start->multiplier;
    }
    const double most = 2 * std::max(layer.far, at.dx.norm());  // m: the limit of the proxy's distance
    descent.within = most;
    Room room;
    for (std::uint32_t round = 0; round < max_curved_rounds && !descent.done; ++round) {
        ++state_.work.curved_rounds;
        const std::span<NearSurface> near = near_surfaces(set, probe, layer, descent, room);
        const CurvedStep step = solve_curved_step(near, at.dx);
        if (near.empty() || !step.found) {
            if (!descent.warm) return feasible;
            descent.warm = false;
            at = layer.solution;
            continue;
        }
        take_step(near, step, p, descent);
        layer.far = std::max(layer.far, at.dx.norm());
    }
    // All listed surfaces have been evaluated within this distance.
    layer.far = std::max(layer.far, descent.within);
    if (!at.dx.allFinite() || (!descent.done && at.dx.norm() > most)) return feasible;
    if (!descent.done) balance(descent);
    if (descent.warm) slide(set, *start, p, at);
    at.status = ContactSolution::Status::solved;
    layer.solution = at;
    layer.proxy = p + at.dx;
    layer.give = 0;
    if (&layer == set.layer.data()) set.corner = descent.normals;
    layer.joined = true;
    return true;
}

bool CurvedStage::solve(ContactSet& set, const Probe& probe, Layer& layer, double worst) noexcept {
    if (state_.clock.step > 0 && layer.reached[layer.newest].cycle != state_.clock.cycle) {
        layer.started = start_of(layer, state_.clock) != nullptr;
        layer.newest ^= 1u;
        layer.reached[layer.newest].cycle = state_.clock.cycle;
    }
    const bool feasible = solve_layer(set, probe, layer, worst);
    if (state_.clock.step > 0) {
        CurvedStart& reached = layer.reached[layer.newest];
        reached.dx = layer.solution.dx;
        reached.p = probe.position;
        reached.active = layer.solution.active;
        reached.multiplier = layer.solution.multiplier;
        reached.cycle = state_.clock.cycle;
    }
    return feasible;
}

bool CurvedStage::put_planes_alone(Arena& a, const ContactSet& set, const Probe& probe, std::uint32_t j,
                                   PlanesApart& apart) const noexcept {
    const Layer& layer = set.layer[j];
    bool any = false;
    CurvedContact found;
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t i = a.moving[m].member;
        if (i >= set.begin + layer.count || apart.full()) continue;
        const Owner owner = a.owner[i];
        const Record& r = state_.records[owner];
        const KindOps& ops = kind_ops()[r.kind];
        if (!ops.plane_alone || !ops.plane_alone(r, probe, layer.stiffness, found)) continue;
        if (apart.has(i)) continue;
        apart.keep(a, i);
        const double height = found.height + relief_at(owner, i, 0);
        a.nx[i] = found.normal.x();
        a.ny[i] = found.normal.y();
        a.nz[i] = found.normal.z();
        a.s[i] = -height;
        any = true;
    }
    return any;
}

void PlanesApart::put_back(Arena& a) const noexcept {
    for (std::uint32_t k = 0; k < count; ++k) {
        a.nx[plane[k].member] = plane[k].nx;
        a.ny[plane[k].member] = plane[k].ny;
        a.nz[plane[k].member] = plane[k].nz;
        a.s[plane[k].member] = plane[k].s;
    }
}

// In layer j a solid takes the normal at the layer's proxy. So the force has no step when the solid takes
// hold or lets go, with others or while another one holds in its place. A solid that holds alone is left
// out: the proxy is at its own foot.
void CurvedStage::lean_in_layer(const ContactSet& set, const Probe& probe, std::uint32_t j) noexcept {
    const Arena& a = sets_.arena();
    const Layer& layer = set.layer[j];
    const ActiveSet& active = layer.solution.active;
    if (active.count == 0) return;
    Probe there = probe;
    there.position = layer.proxy;
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t i = a.moving[m].member, plane = i - set.begin;
        if (plane >= layer.count) continue;
        Record& r = state_.records[a.owner[i]];
        const KindOps& ops = kind_ops()[r.kind];
        if (!ops.plane_alone) continue;
        const bool holds = active.plane[0] == plane || (active.count > 1 && active.plane[1] == plane) ||
                           (active.count > 2 && active.plane[2] == plane);
        if (holds ? active.count == 1 : !(a.s[i] > 0)) continue;
        const bool harder = j + 1 < set.layers && plane < set.layer[j + 1].count;
        ops.lean(r, there, harder ? layer.stiffness : std::numeric_limits<double>::infinity());
    }
}

// Runs at the end of a cycle, so that within a cycle a repeated evaluation gives the same answer.
void CurvedStage::lean(const ContactSet& set, const Probe& probe) noexcept {
    for (std::uint32_t j = 0; j < set.layers; ++j) lean_in_layer(set, probe, j);
}

}  // namespace knurl::detail
