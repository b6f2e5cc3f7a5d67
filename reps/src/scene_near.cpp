// Which bounded surfaces a probe might touch: collected once, and exact until the probe has moved by the
// margin.

#include <algorithm>
#include <cmath>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

namespace {

constexpr double least_margin = 2e-3, smallest_margin = 1e-6;  // m, of the hand
constexpr std::uint32_t many = 64, few = 16;

}  // namespace

// One without stiffness is in no set, wherever the probe is.
bool SceneCore::may_be_far(const Record& r) const noexcept {
    const KindOps& ops = kind_ops()[r.kind];
    return r.stiffness > 0 && (ops.bound(r) || ops.clearance(r, groups_[r.probe].probe));
}

void SceneCore::place_surface(std::uint32_t i) noexcept {
    Slot& slot = slots_[i];
    const Record& r = felt(i);
    const std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    slot.bounded = may_be_far(r);
    slot.endless = slot.bounded && !ball;
    slot.near = slot.near && slot.bounded;
    if (!slot.bounded) return join(always_, always_size_, i, &Slot::always_place);
    if (slot.endless) {
        join(endless_, endless_size_, i, &Slot::always_place);
    } else if (ball->velocity.isZero(0)) {
        reach_.put(i, ball->center, ball->radius);
    } else {
        const bool holds = r.use.on_silence == OnSilence::hold;
        reach_.put_moving(i, ball->center, ball->radius, ball->velocity, r.moved, holds);
    }
    Group& group = groups_[r.probe];
    ++group.bounded;
    group.near.margin = -1;
    bounded_used_ |= 1u << r.probe;
}

void SceneCore::forget_surface(std::uint32_t i) noexcept {
    Slot& slot = slots_[i];
    if (!slot.bounded) return leave(always_, always_size_, i, &Slot::always_place);
    if (slot.endless) {
        leave(endless_, endless_size_, i, &Slot::always_place);
    } else {
        reach_.drop(i);
    }
    const std::uint32_t probe = felt(i).probe;
    Group& group = groups_[probe];
    group.near.margin = -1;
    slot.bounded = false;
    if (--group.bounded == 0) {
        bounded_used_ &= ~(1u << probe);
        group.near.size = 0;
    }
}

bool SceneCore::near_left() noexcept {
    bool left = false;
    for (std::uint32_t rest = bounded_used_; rest != 0; rest &= rest - 1) {
        Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        const double deep = std::max(group.now.slack, group.old.slack);
        // After a deep contact the candidates are many: as soon as few will do, they are collected anew.
        const bool too_many = group.near.margin > group.near.wanted && 2 * deep <= group.near.wanted;
        const double within = too_many ? 0 : group.near.margin * near_rounding - deep;
        if (within > 0 && now_.all < group.near.until &&
            (group.probe.position - group.near.at).squaredNorm() < within * within)
            continue;
        group.near.margin = -1;
        left = true;
    }
    return left;
}

std::optional<Bound> SceneCore::ball_now(const Record& r) const noexcept {
    std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    if (ball && !ball->velocity.isZero(0)) {
        const double since = now_.of(r.use.on_silence == OnSilence::hold) - r.moved;
        ball->center += std::max(0.0, since) * ball->velocity;
    }
    return ball;
}

// All steps since then at once.
void SceneCore::catch_up(Record& r) noexcept {
    const double then = before_.of(r.use.on_silence == OnSilence::hold);
    if (!(then >= r.moved)) return;  // placed in this cycle
    Motion& motion = *kind_ops()[r.kind].motion(r);
    motion.time += then - r.moved;
    motion.placed = 0;
    r.moved = then;
}

// A surface that was not asked in the last cycle that took time was out of reach then. Its state is made what
// it would be had it been asked: no path before that cycle, and the probe where it was in it.
void SceneCore::prime(Record& r, const Group& group) noexcept {
    const KindOps& ops = kind_ops()[r.kind];
    if (ops.turns) catch_up(r);
    if (!ops.bound(r) && !ops.clearance(r, group.probe)) return;  // not skipped, but without stiffness
    ops.out_of_reach(r);
    Probe then = group.probe;
    then.position = group.before;
    std::array<Contact, max_contacts> unused;
    ops.contact(r, then, ops.turns ? 0 : limits_.period, unused);
    r.asked = last_timed_;
}

// What is near now was far from any cache: all of it is on its way at once before any of it is looked at.
void SceneCore::fetch(std::span<const std::uint32_t> slots) const noexcept {
    const auto lines_of = [](const auto& what, std::size_t bytes) {
        for (std::size_t at = 0; at < bytes; at += 64)
            __builtin_prefetch(reinterpret_cast<const std::byte*>(&what) + at);
    };
    constexpr std::size_t shape = 128;  // bytes: the lengths and places that a bound takes
    for (const std::uint32_t i : slots) lines_of(slots_[i], 128);
    for (const std::uint32_t i : slots) {
        const Record& r = felt(i);
        lines_of(static_cast<const RecordHead&>(r), sizeof(RecordHead));
        lines_of(r.params, shape);
        lines_of(r.state, 64);
    }
}

void SceneCore::collect_near(Group& group, std::uint32_t probe) noexcept {
    Candidates& near = group.near;
    const double typical = std::max(world_length(least_margin, limits_), reach_.mean_radius() / 2);
    if (!(near.wanted > 0)) near.wanted = typical;
    near.at = group.probe.position;
    const double deep = std::max(group.now.slack, group.old.slack);
    // Twice what a contact needs, but of a deep one no more than lets its need double: there are many.
    near.margin = std::max(near.wanted, deep + std::min(deep, std::max(near.wanted, 0.6 * deep)));
    const double within = near.margin + group.placement.radius;
    std::uint32_t found = reach_.collect(near.at, within, near_);
    if (found > many) near.wanted = std::max(world_length(smallest_margin, limits_), near.wanted / 2);
    if (found < few) near.wanted = std::min(typical, near.wanted * 2);
    const Reach::Coming coming =
        reach_.collect_moving(near.at, within, now_, std::span(near_).subspan(found));
    found += coming.count;
    near.until = now_.all + coming.lasts;
    // Through one that has no end the path of this cycle may have led, if it was as long as that is far away.
    const double endless = near.margin + (near.at - group.before).norm();
    for (std::uint32_t k = 0; k < endless_size_; ++k) {
        const std::uint32_t i = endless_[k];
        if (felt(i).probe != probe) continue;
        const std::optional<double> clear = kind_ops()[felt(i).kind].clearance(felt(i), group.probe);
        const double lost = 1e-12 * (near.at.lpNorm<1>() + endless);
        if (!clear || !(*clear > endless + lost)) near_[found++] = i;
    }
    fetch(std::span(near_.data(), found));

    std::uint32_t size = 0;
    for (std::uint32_t k = 0; k < found; ++k) {
        if (felt(near_[k]).probe == probe) near_[size++] = near_[k];
    }
    // One that holds the probe from however deep has no bound at the moment.
    for (std::uint32_t k = 0; k < near.size; ++k) {  // but not what is another probe's by now
        if (felt(near.slots[k]).probe == probe) slots_[near.slots[k]].near = false;
    }
    for (std::uint32_t k = 0; k < size; ++k) slots_[near_[k]].near = true;
    for (std::uint32_t k = 0; k < near.size; ++k) {
        const std::uint32_t i = near.slots[k];
        const Slot& slot = slots_[i];
        if (slot.near || !slot.bounded || slot.endless || !slot.felt || slot.renewed ||
            felt(i).probe != probe)
            continue;
        if (!kind_ops()[felt(i).kind].bound(felt(i))) near_[size++] = i;
    }
    std::sort(near_.begin(), near_.begin() + size);
    const bool same =
        size == near.size && std::equal(near_.begin(), near_.begin() + size, near.slots.begin());
    for (std::uint32_t k = 0; k < size; ++k) slots_[near_[k]].near = true;
    if (group.fading && group.olds_left_out)
        sets_edited_ = true;  // they are to be asked whether they are near now
    if (same) return;

    std::copy(near_.begin(), near_.begin() + size, near.slots.begin());
    near.size = size;
    sets_edited_ = true;
}

}  // namespace knurl::detail
