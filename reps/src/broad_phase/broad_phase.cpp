#include "broad_phase/broad_phase.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/clamped.hpp"

namespace knurl::detail {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// m, at the hand.
constexpr double least_margin = 2e-3, smallest_margin = 1e-6;
// Numbers of candidates: above `many` surfaces the margin is narrowed, below `few` it is widened.
constexpr std::uint32_t many = 64, few = 16, few_effects = 8;
constexpr int narrowings = 4;  // steps by which one collection of effects narrows the margin

}  // namespace

std::optional<Bound> ball_now(const Record& r, const Clock& clock) noexcept {
    std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    if (ball && !ball->velocity.isZero(0)) {
        const double since = clock.now.of(r.options.on_silence == OnSilence::hold) - r.moved;
        ball->center += std::max(0.0, since) * ball->velocity;
    }
    return ball;
}

namespace {

// A turning surface was out of reach: its motion makes up for all steps since then.
void move_on_since(Record& r, const Clock& clock) noexcept {
    const double then = clock.before.of(r.options.on_silence == OnSilence::hold);
    if (!(then >= r.moved)) return;  // placed in this cycle
    Motion& motion = *kind_ops()[r.kind].motion(r);
    motion.time += then - r.moved;
    motion.placed = 0;
    r.moved = then;
}

}  // namespace

void catch_up(Record& r, const SceneState& state, const Eigen::Vector3d& held) noexcept {
    const ProbeState& probe = state.probes[r.probe];
    const KindOps& ops = kind_ops()[r.kind];
    if (ops.turns) move_on_since(r, state.clock);
    if (!ops.bound(r) && !ops.clearance(r, probe.probe)) return;  // a surface with stiffness would be skipped
    ops.out_of_reach(r);
    Probe then = probe.probe;
    then.position = probe.before;
    if (ops.follows) then.position += held;
    then.path = nullptr;
    std::array<Contact, max_contacts> unused;
    ops.contact(r, then, ops.turns ? 0 : state.limits.period, unused);
    r.evaluated_cycle = state.clock.last_timed;
}

SurfaceCandidates::SurfaceCandidates(std::size_t slots, std::size_t probes)
    : slots_(slots),
      probes_(probes),
      always_(empty_list(slots)),
      endless_(empty_list(slots)),
      tree_(static_cast<std::uint32_t>(slots)),
      found_(slots) {
    for (Candidates& each : probes_) each.list.reserve(slots);
}

void SurfaceCandidates::reset() noexcept {
    std::fill(slots_.begin(), slots_.end(), SurfaceSlot{});
    for (Candidates& each : probes_) {
        each.coverage = Coverage{};
        each.until = 0;
        each.bounded = 0;
        each.list.clear();
    }
    used_ = 0;
    always_.clear();
    endless_.clear();
    tree_.clear();
}

// A surface without stiffness is in no set, wherever the probe is.
bool SurfaceCandidates::may_be_far(const Record& r, const SceneState& state) const noexcept {
    const KindOps& ops = kind_ops()[r.kind];
    return r.stiffness > 0 && (ops.bound(r) || ops.clearance(r, state.probes[r.probe].probe));
}

void SurfaceCandidates::place(std::uint32_t i, const SceneState& state) noexcept {
    SurfaceSlot& slot = slots_[i];
    const Record& r = state.records.current(i);
    const std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    slot.bounded = may_be_far(r, state);
    slot.endless = slot.bounded && !ball;
    slot.candidate = slot.candidate && slot.bounded;
    if (!slot.bounded) return join(always_, i, slot.place);
    if (slot.endless) {
        join(endless_, i, slot.place);
    } else if (ball->velocity.isZero(0)) {
        tree_.put(i, ball->center, ball->radius);
    } else {
        const bool holds = r.options.on_silence == OnSilence::hold;
        tree_.put_moving(i, ball->center, ball->radius, ball->velocity, r.moved, holds);
    }
    Candidates& candidates = probes_[r.probe];
    ++candidates.bounded;
    candidates.coverage.expire();
    used_ |= 1u << r.probe;
}

void SurfaceCandidates::place_again(std::uint32_t i, const SceneState& state) noexcept {
    if (!may_be_far(state.records.current(i), state)) return;
    leave(always_, i, place_of());
    place(i, state);
}

void SurfaceCandidates::forget(std::uint32_t i, const Record& current) noexcept {
    SurfaceSlot& slot = slots_[i];
    if (!slot.bounded) return leave(always_, i, place_of());
    if (slot.endless) {
        leave(endless_, i, place_of());
    } else {
        tree_.drop(i);
    }
    slot.bounded = false;
    Candidates& candidates = probes_[current.probe];
    candidates.coverage.expire();
    if (--candidates.bounded > 0) return;
    used_ &= ~(1u << current.probe);
    candidates.list.clear();
}

bool SurfaceCandidates::outdated(std::uint32_t p, const SceneState& state, double deepest) const noexcept {
    const Candidates& candidates = probes_[p];
    // A deep contact collects many candidates. They are collected anew as soon as a smaller margin suffices.
    return too_many(candidates, deepest) || !(state.clock.now.all < candidates.until) ||
           !candidates.coverage.holds(state.probes[p].probe.position, deepest);
}

double SurfaceCandidates::sleep_radius(std::uint32_t p, const SceneState& state,
                                       double deepest) const noexcept {
    const Candidates& candidates = probes_[p];
    if (too_many(candidates, deepest) || candidates.until != infinity) return 0;
    return candidates.coverage.left(state.probes[p].probe.position, deepest);
}

bool SurfaceCandidates::passes_by(std::uint32_t p, const Bound& ball, const SceneState& state) noexcept {
    Candidates& candidates = probes_[p];
    const Coverage& covered = candidates.coverage;
    const double within = covered.margin + state.probes[p].placement.radius;
    const double far = within + 1e-12 * (covered.at.lpNorm<1>() + within);
    const double gap = (ball.center - covered.at).norm() - (ball.radius * (1 + 1e-12) + far);
    const double away = gap > 0 ? away_for(gap, ball.velocity.norm()) : 0;
    if (!(away > 0)) return false;
    candidates.until = std::min(candidates.until, state.clock.now.all + away);
    return true;
}

// These records are in no cache yet. Prefetching all of them first lets their cache misses overlap.
void SurfaceCandidates::fetch(std::span<const std::uint32_t> slots, const SceneState& state) const noexcept {
    const auto lines_of = [](const auto& what, std::size_t bytes) {
        for (std::size_t at = 0; at < bytes; at += 64)
            __builtin_prefetch(reinterpret_cast<const std::byte*>(&what) + at);
    };
    constexpr std::size_t shape = 128;  // bytes: the lengths and positions that a bound reads
    for (const std::uint32_t i : slots) {
        lines_of(slots_[i], sizeof(SurfaceSlot));
        lines_of(state.slots[i], sizeof(SlotState));
    }
    for (const std::uint32_t i : slots) {
        const Record& r = state.records.current(i);
        lines_of(static_cast<const RecordHead&>(r), sizeof(RecordHead));
        lines_of(r.params, shape);
        lines_of(r.state, 64);
    }
}

bool SurfaceCandidates::collect(std::uint32_t p, SceneState& state, double deep) noexcept {
    ++state.work.collections;
    Candidates& candidates = probes_[p];
    Coverage& covered = candidates.coverage;
    const ProbeState& probe = state.probes[p];
    const Limits& limits = state.limits;
    const double typical = std::max(world_length(least_margin, limits), tree_.mean_radius() / 2);
    if (!(covered.wanted > 0)) covered.wanted = typical;
    covered.at = probe.probe.position;
    // Twice what the contact needs, so that it may deepen. In a deep contact the reserve is smaller, since
    // the margin holds many surfaces.
    covered.margin = std::max(covered.wanted, deep + std::min(deep, std::max(covered.wanted, 0.6 * deep)));
    const double within = covered.margin + probe.placement.radius;
    std::uint32_t found = tree_.collect(covered.at, within, found_);
    if (found > many) covered.wanted = std::max(world_length(smallest_margin, limits), covered.wanted / 2);
    if (found < few) covered.wanted = std::min(typical, covered.wanted * 2);
    const BoundingTree::Coming coming =
        tree_.collect_moving(covered.at, within, state.clock.now, std::span(found_).subspan(found));
    found += coming.count;
    candidates.until = state.clock.now.all + coming.lasts;
    // The probe's path of this cycle may have crossed an endless surface, so the length of that path is
    // added.
    const double endless = covered.margin + (covered.at - probe.before).norm();
    for (const std::uint32_t i : endless_) {
        const Record& r = state.records.current(i);
        if (r.probe != p) continue;
        const std::optional<double> clear = kind_ops()[r.kind].clearance(r, probe.probe);
        const double lost = 1e-12 * (covered.at.lpNorm<1>() + endless);
        if (!clear || !(*clear > endless + lost)) found_[found++] = i;
    }
    fetch(std::span(found_.data(), found), state);

    const auto is_of_probe = [&](std::uint32_t i) { return state.records.current(i).probe == p; };
    std::uint32_t size = 0;
    for (std::uint32_t k = 0; k < found; ++k) {
        if (is_of_probe(found_[k])) found_[size++] = found_[k];
    }
    for (const std::uint32_t i : candidates.list) {  // a surface may belong to another probe by now
        if (is_of_probe(i)) slots_[i].candidate = false;
    }
    for (std::uint32_t k = 0; k < size; ++k) slots_[found_[k]].candidate = true;
    // A surface that holds the probe at any depth has no bound at the moment, so the tree does not find it.
    for (const std::uint32_t i : candidates.list) {
        const SurfaceSlot& slot = slots_[i];
        const bool stays = !slot.candidate && slot.bounded && !slot.endless && state.slots[i].active &&
                           !state.slots[i].renewed && is_of_probe(i);
        const Record& r = state.records.current(i);
        if (stays && !kind_ops()[r.kind].bound(r)) found_[size++] = i;
    }
    std::sort(found_.begin(), found_.begin() + size);
    for (std::uint32_t k = 0; k < size; ++k) slots_[found_[k]].candidate = true;
    if (std::equal(found_.begin(), found_.begin() + size, candidates.list.begin(), candidates.list.end()))
        return false;
    candidates.list.assign(found_.begin(), found_.begin() + size);
    return true;
}

EffectCandidates::EffectCandidates(std::size_t slots, std::size_t probes)
    : slots_(slots), probes_(probes), tree_(static_cast<std::uint32_t>(slots), BoundingTree::Moves::never) {}

void EffectCandidates::reset() noexcept {
    std::fill(slots_.begin(), slots_.end(), EffectSlot{});
    std::fill(probes_.begin(), probes_.end(), Candidates{});
    used_ = 0;
    tree_.clear();
}

void EffectCandidates::place(std::uint32_t i, const Record& r) noexcept {
    const std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    if (!ball) return;
    slots_[i].bounded = true;
    tree_.put(i, ball->center, ball->radius);
    Candidates& candidates = probes_[r.probe];
    ++candidates.bounded;
    candidates.coverage.expire();
    used_ |= 1u << r.probe;
}

void EffectCandidates::forget(std::uint32_t i, const Record& r) noexcept {
    EffectSlot& slot = slots_[i];
    if (!slot.bounded) return;
    slot = EffectSlot{};
    tree_.drop(i);
    Candidates& candidates = probes_[r.probe];
    if (--candidates.bounded == 0) used_ &= ~(1u << r.probe);
    candidates.coverage.expire();
}

bool EffectCandidates::left(const SceneState& state) noexcept {
    bool any = false;
    for_each_bit(used_, [&](std::uint32_t p) {
        Coverage& covered = probes_[p].coverage;
        if (covered.holds(state.probes[p].probe.position, 0)) return;
        covered.expire();
        any = true;
    });
    return any;
}

void EffectCandidates::collect(std::uint32_t p, std::span<const std::uint32_t> effects,
                               std::span<std::uint32_t> scratch, SceneState& state) noexcept {
    ++state.work.collections;
    Coverage& coverage = probes_[p].coverage;
    const double least = world_length(least_margin, state.limits);
    const double typical = std::max(least, tree_.mean_radius() / 2);
    if (!(coverage.wanted > 0)) coverage.wanted = typical;
    coverage.at = state.probes[p].probe.position;
    coverage.margin = coverage.wanted;
    std::uint32_t found = tree_.collect(coverage.at, coverage.margin, scratch);
    // A large effect leaves the others as far away as they are. Collecting again sooner is cheaper than
    // evaluating many effects whose force is zero.
    for (int i = 0; i < narrowings && found > few_effects && coverage.margin > least; ++i) {
        coverage.margin = std::max(least, coverage.margin / 4);
        found = tree_.collect(coverage.at, coverage.margin, scratch);
    }
    coverage.wanted = found < few_effects ? std::min(typical, coverage.margin * 2) : coverage.margin;
    for (const std::uint32_t i : effects) {
        if (slots_[i].bounded && state.records.current(i).probe == p) slots_[i].candidate = false;
    }
    for (std::uint32_t k = 0; k < found; ++k) {
        if (state.records.current(scratch[k]).probe == p) slots_[scratch[k]].candidate = true;
    }
}

double EffectCandidates::sleep_radius(const SceneState& state) const noexcept {
    double within = infinity;
    for_each_bit(used_, [&](std::uint32_t p) {
        within = std::min(within, probes_[p].coverage.left(state.probes[p].probe.position, 0));
    });
    return within;
}

}  // namespace knurl::detail
