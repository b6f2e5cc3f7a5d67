// Which claims a cycle processes (claim_set.hpp).

#include <algorithm>
#include <cmath>

#include "servo_impl.hpp"

namespace knurl::servo {

void Servo::Impl::find_awake(Nanoseconds now, double dt) noexcept {
    constexpr double fastest = 1e3;  // m and m/s; beyond it, a scene may treat the hand as absent
    hand_usable = dt > 0 && tip.pose.position.lpNorm<1>() < fastest && tip.velocity.lpNorm<1>() < fastest &&
                  tip.angular_velocity.allFinite() && tip.pose.orientation.coeffs().allFinite();
    claims.look(hand_usable ? &tip.pose.position : nullptr, now);
}

void Servo::Impl::wake_claims() noexcept {
    claims.wake_all([this](Claim::Impl& c) {
        if (c.channels && options.silence) c.watch_silence(last_now);
    });
}

void Servo::Impl::evaluate_scene(std::size_t place, const Probe& probe, double dt) noexcept {
    Claim::Impl& c = claims[place];
    if (c.scene_sleeps && hand_usable && !c.scene.changed() &&
        claims.sleeping_scene(place).holds(probe.position)) {
        if (options.sleep)
            c.feedback.keep();
        else
            c.evaluate(probe, dt);
        return;
    }
    if (const std::uint64_t owed = claims.cycles_owed(place); c.scene_sleeps && options.sleep && owed > 0)
        c.scene.pass(owed, claims.time(place), c.in_world(passed_hand));
    c.scene_sleeps = false;
    const SceneTime before = c.scene.time();
    const bool changed = c.scene.changed();  // it may well change again in the next cycle
    c.evaluate(probe, dt);
    // With a margin: a hand that is about to leave the ball should not put the scene to sleep.
    if (changed || !hand_usable || c.touching || c.scene.size() == 0 || c.scene.evaluated() > 0) return;
    constexpr double most = 10, least = 1e-4, ahead = 32;  // m, m, cycles
    const double within = std::min(most, c.scene.sleep_radius() / std::abs(c.terms.frame.scale));
    if (!(within > least + ahead * dt * probe.velocity.norm()) || !c.wrench.force.isZero(0) ||
        !c.wrench.torque.isZero(0))
        return;
    c.scene_sleeps = true;
    claims.put_scene_to_sleep(place, {.at = probe.position, .within = within, .since = report.cycle},
                              {.time = before, .held_share = c.silent_for > 0 ? 0.0 : 1.0});
}

void Servo::Impl::put_to_sleep(std::size_t place) noexcept {
    Claim::Impl& c = claims[place];
    if (!options.sleep || !c.nothing_to_do()) return;
    // Its last touch is still to be shown: it is awake when its turn comes.
    if (scene_log != nullptr && (c.shown_touching || c.shown_asleep != c.scene_sleeps)) return;
    if (c.scene_sleeps) c.feedback.keep();
    const bool heard = c.channels && options.silence && !(c.silent_for > 0);
    claims.put_to_sleep(place, {.until = heard ? c.silence.heard_until() : Sleep::for_ever,
                                .present = c.scene_sleeps ? c.scene.size() : 0,
                                .armed = c.wants_force(),
                                .keeps_on = c.wants_force() && !c.joined,
                                .surfaces = c.scene_sleeps && c.gain > 0 && c.scene.load_bound().surfaces});
}

}  // namespace knurl::servo
