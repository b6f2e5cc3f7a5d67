#include "scene/scene_core.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "scene/clamped.hpp"

namespace knurl::detail {

// A limit that is NaN or negative allows nothing, which is safe.
Limits sane_limits(Limits limits) noexcept {
    for (double* limit : {&limits.max_stiffness, &limits.max_force, &limits.max_torque}) {
        if (!(*limit > 0)) *limit = 0;
    }
    for (double* unit : {&limits.metre, &limits.newton}) {
        if (!(*unit > 0) || !std::isfinite(*unit)) *unit = 1;
    }
    return limits;
}

Shares shares_of(const Limits& limits) noexcept {
    if (!std::isfinite(limits.max_stiffness) || !(limits.max_stiffness > 0)) return {};
    const bool turns = std::isfinite(limits.max_torsion) && limits.max_torsion > 0;
    return {.stiffness = 1 / limits.max_stiffness,
            .damping = 1 / largest_damping(limits),
            .turning = turns ? limits.max_stiffness / limits.max_torsion : 0};
}

SceneCore::SceneCore(Scene::Capacity capacity, const Limits& limits)
    : model_(capacity),
      state_(capacity.representations, capacity.probes, limits),
      candidates_(capacity.representations, capacity.probes),
      sets_(state_, candidates_),
      contacts_(state_, sets_, candidates_),
      effects_(state_),
      feedback_(state_, candidates_, sets_, effects_),
      load_(state_, sets_, effects_) {}

// The placements of the probes, the silence and the count of cycles stay.
void SceneCore::clear() noexcept {
    model_.clear();
    candidates_.reset();
    sets_.reset();
    effects_.reset();
    feedback_.reset();
    state_.records.reset();
    std::fill(state_.slots.begin(), state_.slots.end(), SlotState{});
    state_.clock.now = state_.clock.before = {};
    state_.silence.held_velocity_weight = 1;
    state_.scales = {};
    state_.any_follows = false;
}

void SceneCore::index() {
    candidates_.index();
    effects_.index();
}

void SceneCore::set_limits(const Limits& limits) noexcept {
    const Limits sane = sane_limits(limits);
    if (std::memcmp(&sane, &state_.limits, sizeof sane) == 0) return;
    state_.limits = sane;
    state_.shares = shares_of(sane);
    model_.touch_all();  // a changed clamp is a change of the set like any other
}

void SceneCore::set_asset(std::uint32_t number, const Asset* asset) noexcept {
    if (number > 0 && number <= max_assets) state_.assets[number - 1] = asset;
}

bool SceneCore::refers_to(const Asset& asset) const noexcept {
    const auto made_of = [&](const Record& r) { return kind_ops()[r.kind].asset(r) == &asset; };
    for (std::uint32_t i = 0; i < state_.slots.size(); ++i) {
        if (state_.slots[i].active && made_of(state_.records.current(i))) return true;
        if (sets_.old_in_use(i) && made_of(state_.records.old(i))) return true;
    }
    return false;
}

void SceneCore::set_silence(double seconds) noexcept {
    Silence& silence = state_.silence;
    const double before = std::exchange(silence.seconds, seconds > 0 ? seconds : 0);
    // The time of a silence only grows until the silence ends.
    if (silence.moves || !(before > 0 ? silence.seconds < before : silence.seconds > 0)) return;
    silence.moves = true;
    effects_.edit();
}

namespace {

// A silence changes weights at these rates only, so no force jumps.
constexpr double fade_out = 0.1, fade_in = 0.05;  // s

double weight_after(double from, bool out, double dt) noexcept {
    const double to = out ? std::max(0.0, from - dt / fade_out) : std::min(1.0, from + dt / fade_in);
    return to < 1e-12 ? 0 : to > 1 - 1e-12 ? 1 : to;
}

/// One cycle of a silence, for all active records.
struct WeightStep {
    double silence, dt;       // s
    bool all_arrived = true;  // a record that holds, or has faded out, costs nothing more in a long silence

    bool changes(Record& r) noexcept {
        if (r.options.on_silence == OnSilence::hold) return false;
        const double delay = r.options.on_silence == OnSilence::move ? r.options.silence_time : 0;
        const bool fades = silence > delay, will_fade = silence > 0 && !fades;
        const double before = r.weight;
        r.weight = weight_after(r.weight, fades, dt);
        all_arrived = all_arrived && !will_fade && r.weight == (fades ? 0 : 1);
        return r.weight != before;
    }
};

}  // namespace

void SceneCore::advance_weights(double dt) noexcept {
    Records& records = state_.records;
    WeightStep step{.silence = state_.silence.seconds, .dt = dt};
    bool surfaces = false;
    for (const std::uint32_t i : sets_.surfaces()) surfaces |= step.changes(records.current(i));
    sets_.for_each_old([&](Record& r) { surfaces |= step.changes(r); });
    for (const std::uint32_t i : effects_.effects()) step.changes(records.current(i));
    for (const std::uint32_t i : effects_.fading()) {
        if (effects_[i].from == FadeFrom::record) step.changes(records.old(i));
    }
    if (surfaces) sets_.rebuild();
    state_.feedback_edited = true;
    effects_.edit();  // springs whose weights change cannot be collapsed
    state_.silence.moves = !step.all_arrived;
}

void SceneCore::place_probes(const Probe& hand) noexcept {
    const Clock& clock = state_.clock;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) {
        ProbeState& at = state_.probes[p];
        if (clock.last_timed + 1 == clock.cycle) at.before = at.probe.position;
        at.probe = hand;
        at.probe.radius = at.placement.radius;
        at.probe.path = &contacts_.path();
        if (at.placement.offset == Vec3{}) {
            at.arm.setZero();
            return;
        }
        at.arm = hand.orientation * to_eigen(at.placement.offset);
        const Eigen::Vector3d turning = hand.angular_velocity.cross(at.arm);
        at.probe.position += at.arm;
        at.probe.velocity += turning;
        at.probe.smooth_velocity += turning;
    });
}

void SceneCore::advance_clock(double dt) noexcept {
    Clock& clock = state_.clock;
    ++clock.cycle;
    clock.step = dt;
    clock.before = clock.now;
    clock.now.all += dt;
    Silence& silence = state_.silence;
    if (!(silence.seconds > 0)) clock.now.held += dt;
    // A surface that holds stops at once. The velocity that its friction, damping and texture use changes
    // gradually, since a force must not step.
    silence.held_velocity_weight = weight_after(silence.held_velocity_weight, silence.seconds > 0, dt);
}

bool SceneCore::has_changed() noexcept {
    const bool left = candidates_.probes() != 0 &&
                      candidates_.left(state_, [this](std::uint32_t p) { return sets_[p].deepest(); });
    const bool effects_left = effects_.probes_left();
    return left || effects_left || model_.slots_changed() || sets_.edited() || effects_.edited();
}

Wrench SceneCore::evaluate(const Probe& hand, double dt) noexcept {
    // A probe with an invalid or far position has no force and changes no state.
    constexpr double farthest = 1e12;  // m
    if (!(hand.position.lpNorm<1>() < farthest) || !(hand.velocity.lpNorm<1>() < farthest) ||
        !(hand.angular_velocity.lpNorm<1>() < farthest) || !hand.orientation.coeffs().allFinite())
        return {};
    if (!(dt > 0)) dt = 0;
    state_.work = {};
    state_.probes_used = model_.probes_used();
    advance_clock(dt);
    if (model_.placements_changed()) take_placements();
    place_probes(hand);
    if (has_changed()) {
        Silence& silence = state_.silence;
        // A representation that is added during a silence starts at full strength.
        silence.moves = silence.moves || (silence.seconds > 0 && (model_.slots_changed() || sets_.edited()));
        take_changes();
    }
    state_.settles = false;
    if (state_.silence.moves && dt > 0) advance_weights(dt);
    Wrench sum;
    if (sets_.probes() != 0) contacts_.evaluate(dt, sum);
    if (!effects_.idle()) effects_.evaluate(dt, sum);
    if (dt > 0) state_.clock.last_timed = state_.clock.cycle;
    // The field tables keep every product finite. This check guards the result nevertheless.
    if (!sum.force.allFinite() || !sum.torque.allFinite()) return {};
    return sum;
}

}  // namespace knurl::detail
