// Scenes out of the hand's reach: how far it may move before that ends, and the time that has passed until it
// did.

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene_core.hpp"

namespace knurl::detail {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Planes that are asked where they stand, and nothing of a fade or of friction.
double still_contact(const Group& group, const Arena& a) noexcept {
    const ContactSet& set = group.now;
    if (group.fading || set.moving_count > 0 || set.touching || set.infeasible || !rests_along(group))
        return 0;
    double worst = -infinity;
    for (std::uint32_t i = set.begin; i < set.begin + set.count + set.summed; ++i)
        worst = std::max(worst, a.s[i]);
    // Many planes were asked where the probe was then.
    const double moved = set.clear.distance > 0 ? (group.probe.position - set.clear.at).norm() : 0;
    return -worst - moved;
}

/// What has bounds is not asked where its candidates are while they hold: near_left and near_falls_short.
double still_bounds(const Group& group) noexcept {
    const Candidates& near = group.near;
    const double deep = std::max(group.now.slack, group.old.slack);  // of a last contact, it may be
    const bool too_many = near.margin > near.wanted && 2 * deep <= near.wanted;
    if (too_many || near.until != infinity) return 0;
    return near.margin * near_rounding - deep - (group.probe.position - near.at).norm();
}

}  // namespace

bool SceneCore::changed() const noexcept {
    const bool pace_moves = pace_ != (silence_ > 0 ? 0 : 1);
    return changed_size_ > 0 || moved_ || sets_edited_ || effects_edited_ || weights_move_ || pace_moves ||
           settle_ || told_.edited || told_.relisted;
}

double SceneCore::still_within() const noexcept {
    // In the last evaluation time passed, and nobody was asked.
    if (evaluated_ > 0 || last_timed_ != cycle_ || active_kinds_size_ + collapsed_used_ + fading_size_ > 0 ||
        told_.touched_size > 0 || changed())
        return 0;
    double within = still_effects(), farthest = 0;
    for (std::uint32_t rest = probes_used_; rest != 0; rest &= rest - 1) {
        const Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        if (group.placement.offset != Vec3{}) return 0;  // the hand's turning moves it, too
        farthest = std::max(farthest, group.probe.position.lpNorm<1>());
    }
    for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1)
        within = std::min(
            within, still_contact(groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))], arenas_[arena_]));
    for (std::uint32_t rest = bounded_used_; rest != 0; rest &= rest - 1)
        within = std::min(within, still_bounds(groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))]));
    // Less what the rounding of coordinates and of normals may hide.
    return std::max(0.0, within * (1 - 1e-6) - 1e-9 * farthest);
}

// All that the evaluations would have left behind.
void SceneCore::pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept {
    cycle_ += cycles;
    last_timed_ = cycle_;
    now_ = time;
    place_probes(hand);
    for (std::uint32_t rest = contacts_used_; rest != 0; rest &= rest - 1) {
        Group& group = groups_[static_cast<std::uint32_t>(__builtin_ctz(rest))];
        group.position = group.probe.position;
        for (std::uint32_t j = 0; j < group.now.layers; ++j) group.now.layer[j].proxy = group.probe.position;
    }
}

}  // namespace knurl::detail

namespace knurl {

double Scene::still_within() const noexcept {
    return impl_->still_within();
}
bool Scene::changed() const noexcept {
    return impl_->changed();
}
SceneTime Scene::time() const noexcept {
    return impl_->now_;
}
void Scene::pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept {
    if (cycles > 0) impl_->pass(cycles, time, hand);
}

}  // namespace knurl
