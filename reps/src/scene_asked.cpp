// Which effects are asked: not those that are out of reach, nor those that give nothing as they stand. What they
// would have answered is nothing, so the sum is the same to the bit.

#include <algorithm>
#include <limits>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

namespace {

constexpr double least_effect_margin = 2e-3;  // m, of the hand
constexpr std::uint32_t few_effects = 8;
constexpr int narrowings = 4;  // of the margin, in one collection

/// How far the probe may go until others may have come near (m).
double left_of(const Group& group) noexcept {
    return group.near_effects.margin * near_rounding;
}

}  // namespace

// One that fades is asked, as its old end is. What a silence has taken away stays so until it is asked to move.
bool SceneCore::to_be_asked(std::uint32_t i) const noexcept {
    const Slot& slot = slots_[i];
    if (slot.from != Slot::From::none) return true;
    if (slot.bounded && !slot.near) return false;
    const Record& r = felt(i);
    const KindOps& ops = kind_ops()[r.kind];
    const bool gives_nothing = (r.weight == 0 && !weights_move_) || ops.powerless(r);
    return !(gives_nothing && ops.arrived(r));
}

void SceneCore::place_effect(std::uint32_t i) noexcept {
    const Record& r = felt(i);
    const std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    if (!ball) return;
    slots_[i].bounded = true;
    effect_reach_.put(i, ball->center, ball->radius);
    Group& group = groups_[r.probe];
    ++group.bounded_effects;
    group.near_effects.margin = -1;
    bounded_effects_used_ |= 1u << r.probe;
}

void SceneCore::forget_effect(std::uint32_t i) noexcept {
    Slot& slot = slots_[i];
    if (!slot.bounded) return;
    slot.bounded = slot.near = false;
    effect_reach_.drop(i);
    const std::uint32_t probe = felt(i).probe;
    if (--groups_[probe].bounded_effects == 0) bounded_effects_used_ &= ~(1u << probe);
    groups_[probe].near_effects.margin = -1;
}

bool SceneCore::near_effects_left() noexcept {
    bool left = false;
    for (std::uint32_t rest = bounded_effects_used_; rest != 0; rest &= rest - 1) {
        Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        const double within = left_of(group);
        if (within > 0 && (group.probe.position - group.near_effects.at).squaredNorm() < within * within)
            continue;
        group.near_effects.margin = -1;
        left = true;
    }
    return left;
}

void SceneCore::collect_effects(Group& group, std::uint32_t probe) noexcept {
    Nearby& near = group.near_effects;
    const double least = world_length(least_effect_margin, limits_);
    const double typical = std::max(least, effect_reach_.mean_radius() / 2);
    if (!(near.wanted > 0)) near.wanted = typical;
    near.at = group.probe.position;
    near.margin = near.wanted;
    std::uint32_t found = effect_reach_.collect(near.at, near.margin, near_);
    // One that is large makes the others no nearer: rather look again sooner than ask many that give nothing.
    for (int i = 0; i < narrowings && found > few_effects && near.margin > least; ++i) {
        near.margin = std::max(least, near.margin / 4);
        found = effect_reach_.collect(near.at, near.margin, near_);
    }
    near.wanted = found < few_effects ? std::min(typical, near.margin * 2) : near.margin;
    for (std::uint32_t e = 0; e < effects_size_; ++e) {
        Slot& slot = slots_[effects_[e]];
        if (slot.bounded && felt(effects_[e]).probe == probe) slot.near = false;
    }
    for (std::uint32_t k = 0; k < found; ++k) {
        if (felt(near_[k]).probe == probe) slots_[near_[k]].near = true;
    }
    effects_edited_ = true;
}

double SceneCore::still_effects() const noexcept {
    double within = std::numeric_limits<double>::infinity();
    for (std::uint32_t rest = bounded_effects_used_; rest != 0; rest &= rest - 1) {
        const Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        within = std::min(within, left_of(group) - (group.probe.position - group.near_effects.at).norm());
    }
    return within;
}

}  // namespace knurl::detail
