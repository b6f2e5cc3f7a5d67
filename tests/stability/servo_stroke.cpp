#include "servo_stroke.hpp"

#include <algorithm>
#include <cmath>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/servo/offline.hpp>

#include "application.hpp"
#include "stroke.hpp"

namespace stability {
namespace {

using Eigen::Vector3d;

knurl::drivers::Motion motion_of(const Conditions& c, const Vector3d& start) {
    // The hand comes down to the middle of the relief in the first half second; then it only strokes.
    constexpr double step = 1e-3, down = 0.5;  // s
    std::vector<knurl::drivers::MotionRow> rows;
    double x = start.x();
    for (int i = 0; i <= static_cast<int>(std::lround(run_end / step)); ++i) {
        const double t = i * step;
        rows.push_back({.t = t, .position = {x, 0, start.z() * std::max(0.0, 1 - t / down)}});
        x += step * wanted_speed(c, t + step / 2);
    }
    return knurl::drivers::Motion(std::move(rows));
}

}  // namespace

Conditions with_profile(const std::string& name, Conditions c) {
    const knurl::drivers::SimProfile profile = knurl::drivers::sim_profile(name);
    c.mass = profile.mass;
    c.damping = profile.damping;
    c.coulomb = profile.coulomb;
    c.quantum = profile.quantum;
    c.lag = profile.lag;
    c.peak_force = profile.peak_force;
    c.finger = profile.hand.finger_mass;
    c.hand_stiffness = profile.hand.stiffness;
    c.hand_damping = profile.hand.damping;
    return c;
}

Figures servo_stroke(const std::string& name, const Conditions& conditions, double stiffness, unsigned seed,
                     unsigned criteria, bool measure) {
    const Chance chance(seed);
    Conditions c = with_profile(name, conditions);
    c.ridge.shift = chance.place * c.ridge.length;
    Vector3d start(-c.reach + chance.grid_x * c.quantum, 0, 0);
    start.z() = c.ridge.at(start.x()) + chance.grid_z * c.quantum;
    if (c.speed == 0) start.z() += (1 + 4 * chance.drop) * 1e-3;

    knurl::drivers::SimProfile profile = knurl::drivers::sim_profile(name);
    profile.hand.grip = c.grip;
    profile.hand.push = c.push;
    profile.hand.normal_stiffness = c.hand_press;
    knurl::drivers::SimDevice device(profile, motion_of(c, start));
    knurl::servo::ServoOptions options;
    options.rate = c.rate;
    options.silence = false;
    options.start_active = true;
    options.clamp_stiffness = false;
    knurl::servo::Offline servo(device, options);
    knurl::servo::ClaimTerms terms;
    terms.frame.scale = c.world;
    terms.limits = knurl::servo::limits_for(device.link(), c.rate, terms.frame);
    terms.update_interval = c.interval();
    knurl::servo::OfflineClaim& claim = servo.claim(std::move(terms));

    Application application(c, stiffness, chance.phase, seed);
    std::vector<knurl::RepresentationId> there;
    const auto add = [&](const auto& params) { return claim.add(params); };
    const auto update = [&](knurl::RepresentationId id, const auto& params) { claim.update(id, params); };
    put(application.first(start), there, add, update);
    claim.arm();
    Judge judge(c, stiffness, measure);
    const auto cycles = static_cast<long>(std::lround(run_end * c.rate));
    for (long i = 0; i < cycles; ++i) {
        const double t = static_cast<double>(i) / c.rate;
        if (application.due(t)) {
            put(application.answer(), there, add, update);
            claim.commit();
        }
        const knurl::Report& report = servo.step();
        application.read(t, knurl::to_eigen(report.position), knurl::to_eigen(report.slow_velocity));
        const knurl::drivers::SimState& state = device.state();
        judge.add(t, state.position, state.velocity, knurl::to_eigen(report.scene_force), state.motor_work);
        if (report.faults != 0) judge.fault();
        if (report.faults != 0 || (!measure && (judge.figures().broken() & criteria))) break;
    }
    return judge.finish();
}

}  // namespace stability
