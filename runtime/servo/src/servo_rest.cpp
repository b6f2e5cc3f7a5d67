// Which claims a cycle looks at (rest.hpp).

#include <algorithm>
#include <cmath>
#include <limits>

#include "claim_impl.hpp"
#include "servo_impl.hpp"

namespace knurl::servo {

namespace {

/// m: so much nearer than this to `from` is within the ball, whatever rounding does.
double room_in(const StillScene& still, const Eigen::Vector3d& from) noexcept {
    return (still.within - (from - still.at).norm()) * (1 - 1e-9) - 1e-9;
}

}  // namespace

void Servo::Impl::find_awake(Nanoseconds now, double dt) noexcept {
    constexpr double fastest = 1e3;  // m/s; beyond it, a scene may say that there is no hand
    hand_usable = dt > 0 && hand.pose.position.lpNorm<1>() < fastest && hand.velocity.lpNorm<1>() < fastest &&
                  hand.angular_velocity.allFinite() && hand.pose.orientation.coeffs().allFinite();
    if (!hand_usable || !((hand.pose.position - rest_at).norm() < rest_within)) wake_near();
    // Two passes here too: the words of many applications arrive together. Those of claims that are awake
    // are read at the end of the cycle (shm::who_waits).
    for (std::size_t i = 0; i < claims_size; ++i) __builtin_prefetch(rests[i].flag);
    awake_size = 0;
    resting_armed = 0;
    resting_present = 0;
    resting_keep_on = resting_surfaces = false;
    for (std::size_t i = 0; i < claims_size; ++i) {
        if (rests[i].look(now)) {
            awake[awake_size++] = i;
        } else {
            resting_present += rests[i].present;
            resting_armed += rests[i].armed ? 1 : 0;
            resting_keep_on = resting_keep_on || rests[i].keeps_on;
            resting_surfaces = resting_surfaces || rests[i].surfaces;
        }
    }
}

void Servo::Impl::wake_near() noexcept {
    rest_at = hand.pose.position;
    rest_within = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < claims_size; ++i) {
        if (!rests[i].resting || rests[i].present == 0) continue;
        if (!hand_usable || !stills[i].holds(rest_at))
            rests[i].resting = false;
        else
            rest_within = std::min(rest_within, room_in(stills[i], rest_at));
    }
}

void Servo::Impl::rouse(Nanoseconds now) noexcept {
    awake_size = 0;
    for (std::size_t i = 0; i < claims_size; ++i) {
        awake[awake_size++] = i;
        Claim::Impl& c = *claims[i]->impl;
        if (c.channels && options.silence && rests[i].resting) c.watch_silence(now);
        rests[i].resting = false;
    }
    resting_armed = 0;
    resting_present = 0;
    resting_keep_on = resting_surfaces = false;
}

void Servo::Impl::evaluate_scene(std::size_t index, const Probe& probe, double dt) noexcept {
    Claim::Impl& c = *claims[index]->impl;
    StillScene& still = stills[index];
    if (still.on && hand_usable && !c.scene.changed() && still.holds(probe.position)) {
        if (options.rest)
            c.felt.keep();
        else
            c.evaluate(probe, dt);
        return;
    }
    if (still.on && options.rest && passed > still.since)
        c.scene.pass(passed - still.since, clocks[index].time, c.in_world(passed_hand));
    still.on = c.still = false;
    const bool changed = c.scene.changed();  // and may well be in the next cycle
    c.evaluate(probe, dt);
    // With some room: a hand that is about to leave the ball need not enter it.
    if (changed || !hand_usable || c.touching || c.scene.size() == 0 || c.scene.evaluated() > 0) return;
    constexpr double most = 10, least = 1e-4, ahead = 32;  // m, m, cycles
    const double within = std::min(most, c.scene.still_within() / std::abs(c.terms.frame.scale));
    if (!(within > least + ahead * dt * probe.velocity.norm()) || !c.wrench.force.isZero(0) ||
        !c.wrench.torque.isZero(0))
        return;
    still = {.at = probe.position, .within = within, .since = report.cycle, .on = true};
    c.still = true;
    became_still[became_still_size++] = index;
}

/// All scenes have been evaluated that are, in this cycle.
void Servo::Impl::pass_time(double dt) noexcept {
    passed = report.cycle;
    for (std::size_t i = 0; i < claims_size; ++i) {
        clocks[i].time.all += dt;
        clocks[i].time.held += dt * clocks[i].held_share;
    }
    for (std::size_t i = 0; i < became_still_size; ++i) {
        const Claim::Impl& c = *claims[became_still[i]]->impl;
        clocks[became_still[i]] = {.time = c.scene.time(), .held_share = c.silent_for > 0 ? 0.0 : 1.0};
    }
}

/// One that was looked at in this cycle.
void Servo::Impl::put_to_rest(std::size_t index) noexcept {
    Claim::Impl& c = *claims[index]->impl;
    Rest& rest = rests[index];
    rest.resting = options.rest && c.nothing_to_do();
    if (!rest.resting) return;
    rest.armed = c.wants_force();
    rest.keeps_on = rest.armed && !c.joined;
    rest.present = c.still ? c.scene.size() : 0;
    rest.surfaces = c.still && c.gain > 0 && c.scene.load_bound().surfaces;
    if (c.still) {
        c.felt.keep();
        rest_within = std::min(rest_within, room_in(stills[index], rest_at));
    }
    rest.until =
        c.channels && options.silence && !(c.silent_for > 0) ? c.silence.heard_until() : Rest::for_ever;
}

}  // namespace knurl::servo
