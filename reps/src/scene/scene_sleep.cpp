// Sleeping scenes, out of the hand's reach: how far the hand may move until they wake, and the time that
// passes until they do.

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/scene_core.hpp"

namespace knurl::detail {

bool SceneCore::changed() const noexcept {
    const Silence& silence = state_.silence;
    const bool velocity_moves = silence.held_velocity_weight != (silence.seconds > 0 ? 0 : 1);
    return model_.changed() || sets_.edited() || effects_.edited() || silence.moves || velocity_moves ||
           state_.settles || state_.feedback_edited || state_.feedback_relisted;
}

// Requires planes that stand still, and neither a fade nor friction.
double SceneCore::sleep_radius_of(std::uint32_t probe) const noexcept {
    const ContactState& contact = sets_[probe];
    const ContactSet& set = contact.now;
    if (contact.fade.under_way || set.moving_count > 0 || set.touching || set.infeasible ||
        !contact.tangential.rests())
        return 0;
    double worst = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = set.begin; i < set.begin + set.count + set.summed; ++i)
        worst = std::max(worst, sets_.arena().s[i]);
    // A skipped scan left the heights of the probe's place at that time, set.clear.at.
    const bool skipped = set.clear.distance > 0;
    const Eigen::Vector3d& p = state_.probes[probe].probe.position;
    return -worst - (skipped ? (p - set.clear.at).norm() : 0);
}

double SceneCore::sleep_radius() const noexcept {
    const Clock& clock = state_.clock;
    // In the last evaluation time passed, and no surface was evaluated.
    if (state_.work.evaluated > 0 || clock.last_timed != clock.cycle || !effects_.idle() ||
        feedback_.touches() || changed())
        return 0;
    double within = effects_.sleep_radius(), farthest = 0;
    bool turns = false;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) {
        turns = turns || state_.probes[p].placement.offset != Vec3{};
        farthest = std::max(farthest, state_.probes[p].probe.position.lpNorm<1>());
    });
    if (turns) return 0;  // a rotation of the hand moves the probe, too
    for_each_bit(sets_.probes(), [&](std::uint32_t p) { within = std::min(within, sleep_radius_of(p)); });
    // While the candidates hold, surfaces with bounds that are not among them are not evaluated.
    for_each_bit(candidates_.probes(), [&](std::uint32_t p) {
        within = std::min(within, candidates_.sleep_radius(p, state_, sets_[p].deepest()));
    });
    // Subtracts what the rounding of coordinates and normals may hide.
    return std::max(0.0, within * (1 - 1e-6) - 1e-9 * farthest);
}

// Brings the state to what the skipped evaluations would have left.
void SceneCore::pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept {
    if (cycles == 0) return;
    state_.clock.cycle += cycles;
    state_.clock.last_timed = state_.clock.cycle;
    state_.clock.now = time;
    place_probes(hand);
    for_each_bit(sets_.probes(), [&](std::uint32_t p) {
        ContactState& contact = sets_[p];
        contact.position = state_.probes[p].probe.position;
        for (std::uint32_t j = 0; j < contact.now.layers; ++j) contact.now.layer[j].proxy = contact.position;
    });
}

}  // namespace knurl::detail
