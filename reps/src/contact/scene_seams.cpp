// Touching surfaces hold the hand as one surface. The proxy follows a path along the surfaces that hold it,
// and it enters and leaves a solid by this path. proxy_path.hpp says how a surface is evaluated.

#include <cmath>
#include <utility>

#include "contact/contact_stage.hpp"
#include "scene/clamped.hpp"

namespace knurl::detail {

using Eigen::Vector3d;
using Stage = ProxyPath::Stage;

namespace {

// In each round the proxy enters or leaves one surface, and no surface twice in a cycle. Where dozens
// overlap, the next cycle continues from the place reached.
constexpr int most_rounds = 16;
// How often in a cycle curved surfaces are evaluated again because the proxy has reached another place on
// them. Each time it is nearer to its final place; the next cycle continues from there.
constexpr int most_turns = 16;

}  // namespace

void ContactStage::begin_path(const ContactState& contact, const ContactSet& set,
                              const Vector3d& before) noexcept {
    lead_ = {.contact = &contact, .on = true, .fades = &set == &contact.old, .before = before};
    lead_.lone = set.moving_count == 1 && set.standing == 0;
    lead_.led = !set.held.isZero(0) && !(lead_.lone && is_held_by_first(set));
    path_.entered = path_.left = path_.grazed = false;
    path_.beside = true;
    path_.hand = world_length(seam_of_hand, state_.limits);
}

// A surface in both sets of a fade follows the set that holds the probe now, and answers the fading set
// alike.
void ContactStage::set_stage(const ContactSet& set, std::uint32_t member, bool first) noexcept {
    const Owner owner = sets_.arena().owner[member];
    const bool shared = lead_.fades && !state_.records.fades_out(owner);
    path_.first = first;
    path_.passes = shared && first;
    if (shared) {
        path_.stage = lead_.contact->now.led ? Stage::answer : Stage::free;
    } else if (!(state_.clock.step > 0)) {
        path_.stage = !set.led ? Stage::free : first ? Stage::answer : lead_.stage;
    } else if (first && !lead_.solved) {
        path_.stage = lead_.led ? Stage::answer : Stage::free;
    } else {
        path_.stage = first ? Stage::answer : lead_.stage;
    }
    lead_.again = lead_.again || !(first || lead_.solved);
    path_.joined = true;  // `to` is the proxy, until the holding surface is known
    path_.push.setZero();
    if (path_.passes) {
        path_.to = lead_.contact->now.reached;
    } else if (lead_.solved) {
        fill_path(set, member);
    } else {
        path_.to = owner >> 1 == set.held_by ? Vector3d::Zero() : set.held;
    }
}

void ContactStage::fill_path(const ContactSet& set, std::uint32_t member) noexcept {
    const Arena& a = sets_.arena();
    const ContactSolution& solution = set.layer[0].solution;
    const std::uint32_t contacts = kind_ops()[state_.records[a.owner[member]].kind].contacts;
    std::uint32_t own = 0;
    path_.push.setZero();
    for (std::uint32_t k = 0; k < solution.active.count; ++k) {
        const std::uint32_t i = solution.active.plane[k] + set.begin;
        if (!(i - member < contacts)) continue;
        ++own;
        path_.push += solution.multiplier[k] * Vector3d(a.nx[i], a.ny[i], a.nz[i]);
    }
    path_.joined = solution.active.count > own;
    path_.to = solution.dx;
    if (own > 0 && !path_.joined) path_.to.setZero();  // its foot is the probe's
    path_.holds_harder = set.gaps && holds_harder(set, member, contacts);
}

// Does a harder layer hold its proxy by one of these members?
bool ContactStage::holds_harder(const ContactSet& set, std::uint32_t member, std::uint32_t count) noexcept {
    for (std::uint32_t j = 1; j < set.layers; ++j) {
        const ActiveSet& active = set.layer[j].solution.active;
        for (std::uint32_t k = 0; k < active.count; ++k) {
            if (active.plane[k] + set.begin - member < count) return true;
        }
    }
    return false;
}

// Offers the path to all surfaces within reach. If one answers, its layers must be solved again.
void ContactStage::pass_along(ContactSet& set, const Probe& probe, Stage stage) noexcept {
    const Arena& a = sets_.arena();
    lead_.stage = stage;
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t member = a.moving[m].member;
        const Owner owner = a.owner[member];
        if (!a.moving[m].inside || owner == frozen_plane_owner) continue;
        Record& r = state_.records[owner];
        const KindOps& ops = kind_ops()[r.kind];
        if (!ops.follows || r.evaluated_cycle != state_.clock.cycle) continue;
        const bool evaluates = stage == Stage::look || stage == Stage::near || stage == Stage::overlap;
        if (stage != Stage::near && lead_.fades && !state_.records.fades_out(owner)) continue;
        if (!evaluates) {
            const bool held = a.s[member] > -std::numeric_limits<double>::infinity();
            evaluate_member(set, probe, 0, member);
            if (stage == Stage::enter && !held) begin_gap(set, probe.position, member);
            continue;
        }
        fill_path(set, member);
        if (stage == Stage::near) path_.to = lead_.place;
        path_.stage = stage;
        const double deepest = path_.deepest;
        ops.contact(r, probe, 0, found_);
        if (path_.deepest > deepest) lead_.deepest = member;
    }
    lead_.stage = Stage::answer;
}

// Counts the surfaces near enough to that place (m, from the probe) to touch it, except one that is about to
// leave.
std::uint32_t ContactStage::count_close(ContactSet& set, const Probe& probe, const Vector3d& place) noexcept {
    const Arena& a = sets_.arena();
    lead_.place = place;
    path_.close = 0;
    pass_along(set, probe, Stage::near);
    for (std::uint32_t i = set.begin; i < set.begin + set.count; ++i) {
        const Owner owner = a.owner[i];
        if (owner != frozen_plane_owner && kind_ops()[state_.records[owner].kind].follows) continue;
        const double height = Vector3d(a.nx[i], a.ny[i], a.nz[i]).dot(place) - a.s[i];
        path_.close += std::abs(height) <= path_.hand;
    }
    return path_.close;
}

const Layer* ContactStage::solve_or_rest(ContactSet& set, const Probe& probe, double dt, double standing,
                                         double& worst) noexcept {
    lead_.solved = true;
    if (worst > 0) return solve_widening(set, probe, dt, standing, worst);
    set.force.setZero();
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        set.layer[j].solution.dx.setZero();
        set.layer[j].solution.active.count = 0;
    }
    return nullptr;
}

const Layer* ContactStage::lead_proxy(ContactSet& set, const Probe& probe, double dt, double standing,
                                      double& worst) noexcept {
    const Vector3d& dx = set.layer[0].solution.dx;
    const bool met = path_.entered || path_.left || path_.grazed || worst > 0;
    const bool leads = dt > 0 ? lead_.led || lead_.again || (met && !lead_.lone) : set.led;
    const Layer* top = nullptr;
    if (dt > 0 && leads) {
        top = lead_on(set, probe, dt, standing, worst);
    } else {
        top = solve_or_rest(set, probe, dt, standing, worst);
    }
    if (dt > 0) set.led = leads;
    if (!leads) {
        come_alone(set, worst > 0);
        return top;
    }
    set.reached = dx;
    if (!(probe.radius > 0)) return top;
    return brush(set, probe, dt, standing, worst, top);
}

// Offers the path to each surface that a probe with a radius overlaps, the deepest first: it may be apart
// from the others by now.
const Layer* ContactStage::brush(ContactSet& set, const Probe& probe, double dt, double standing,
                                 double& worst, const Layer* top) noexcept {
    path_.commits = dt > 0;
    for (int round = 0; round < most_rounds; ++round) {
        path_.deepest = 0;
        pass_along(set, probe, Stage::overlap);
        path_.commits = false;
        if (!(path_.deepest > 0)) break;
        lead_.stage = Stage::brush;
        evaluate_member(set, probe, 0, lead_.deepest);
        lead_.stage = Stage::answer;
        worst = worst_of(sets_.arena(), set.begin, set.count);
        top = solve_or_rest(set, probe, dt, standing, worst);
    }
    return top;
}

// Moves the proxy from its last place to where all holding surfaces leave it.
const Layer* ContactStage::lead_on(ContactSet& set, const Probe& probe, double dt, double standing,
                                   double& worst) noexcept {
    const Vector3d& dx = set.layer[0].solution.dx;
    const auto solve_anew = [&] {
        worst = worst_of(sets_.arena(), set.begin, set.count);
        return solve_or_rest(set, probe, dt, standing, worst);
    };
    if (!lead_.led || lead_.again) pass_along(set, probe, Stage::rewind);
    const Layer* top = solve_anew();
    path_.hold = lead_.led ? set.held : dx;
    int turns = 0;
    for (int round = 0; round < most_rounds + turns; ++round) {
        path_.when = 2;
        path_.left = path_.turned = false;
        path_.turns = turns < most_turns;
        pass_along(set, probe, Stage::look);
        if (path_.turned) {
            ++turns;
            pass_along(set, probe, Stage::answer);
            top = solve_anew();
        } else if (path_.when <= 1) {
            pass_along(set, probe, Stage::enter);
            top = solve_anew();
        } else if (path_.left) {
            path_.left = false;
            count_close(set, probe, dx);
            pass_along(set, probe, Stage::leave);
            if (!path_.left) break;
            path_.hold = dx;
            top = solve_anew();
        } else if (path_.grazed && path_.hold.isZero(0) &&
                   count_close(set, probe, Vector3d(path_.graze)) > 1) {
            path_.hold = lead_.before - probe.position;  // it lands on what two surfaces form together
        } else {
            break;
        }
    }
    return top;
}

void ContactStage::remember_proxy(ContactSet& set) noexcept {
    set.held_by = ContactSets::in_no_set;
    if (set.layers == 0) {
        set.held.setZero();
        return;
    }
    const ContactSolution& solution = set.layer[0].solution;
    set.held = set.follows ? set.reached : solution.dx;
    if (solution.active.count == 1)
        set.held_by = sets_.arena().owner[set.begin + solution.active.plane[0]] >> 1;
}

}  // namespace knurl::detail
