#include "stroke.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <knurl/reps/scene.hpp>
#include <knurl/servo/velocity.hpp>

#include "application.hpp"
#include "passivity.hpp"

namespace stability {
namespace {

using Eigen::Vector3d;

constexpr double longest_step = 100e-6;  // s, of the dynamics

/// A point mass on a lagging actuator, with a hand: the simulation of drivers/, without joints.
class Tip {
  public:
    Tip(const Conditions& c, const Vector3d& start)
        : c_(c),
          steps_(static_cast<int>(std::ceil(c.period() / longest_step - 1e-9))),
          h_(c.period() / steps_),
          follow_(c.lag > 0 ? -std::expm1(-h_ * 2 * M_PI * c.lag) : 1),
          mass_(c.total_mass()),
          spring_(c.grip * c.hand_stiffness, c.grip * c.hand_stiffness, c.grip * c.hand_press),
          pipe_(1 + static_cast<std::size_t>(std::lround(c.delay / h_)), Vector3d::Zero()),
          wanted_(start.x(), start.y(), 0),
          position(start) {}

    /// One cycle of the servo, the force `target` (N) from its beginning. `t` s.
    void advance(double t, const Vector3d& target) {
        const double speed = wanted_speed(c_, t + c_.period() / 2);
        const double pressed = c_.weight + c_.grip * c_.push * std::min(1.0, t / 0.1);
        const double hand_damping = c_.grip * c_.hand_damping;
        for (int i = 0; i < steps_; ++i) {
            pipe_[fill_] = target;
            fill_ = fill_ + 1 == pipe_.size() ? 0 : fill_ + 1;
            exerted_ += follow_ * (pipe_[fill_] - exerted_);
            Vector3d force = exerted_ + spring_.cwiseProduct(wanted_ - position) - c_.damping * velocity;
            force -= hand_damping * (velocity - Vector3d(speed, 0, 0));
            force.z() -= pressed;
            const Vector3d before = velocity;
            velocity += h_ / mass_ * force;
            // Dry friction slows the tip, at most to rest: so it can stick.
            const double fast = velocity.norm();
            if (fast > 0) velocity *= std::max(0.0, 1 - h_ * c_.coulomb / (mass_ * fast));
            position += h_ * velocity;
            wanted_.x() += h_ * speed;
            // In a semi-implicit step, the change of kinetic energy is force times the mean velocity.
            work += h_ * 0.5 * exerted_.dot(before + velocity);
        }
    }

  private:
    const Conditions& c_;
    int steps_;
    double h_, follow_, mass_;    // s, 1, kg
    Vector3d spring_;             // N/m
    std::vector<Vector3d> pipe_;  // forces under way to the actuators
    std::size_t fill_ = 0;
    Vector3d exerted_ = Vector3d::Zero();
    Vector3d wanted_;

  public:
    Vector3d position, velocity = Vector3d::Zero();
    double work = 0;  // J, done by the actuators
};

Vector3d counted(const Vector3d& position, const Vector3d& grid, double quantum) {
    if (quantum == 0) return position;
    const auto round = [quantum](double x, double shift) {
        return quantum * std::nearbyint(x / quantum + shift) - shift * quantum;
    };
    return {round(position.x(), grid.x()), round(position.y(), grid.y()), round(position.z(), grid.z())};
}

}  // namespace

Chance::Chance(unsigned seed) {
    std::mt19937_64 random(seed * 7919u + 17);
    const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    place = share(), phase = share(), grid_x = share(), grid_z = share(), drop = share();
}

Figures stroke(const Conditions& conditions, double stiffness, unsigned seed, unsigned criteria,
               bool measure) {
    const Chance chance(seed);
    Conditions c = conditions;
    c.ridge.shift = chance.place * c.ridge.length;
    Vector3d start(-c.reach, 0, 0);
    start.z() = c.ridge.at(start.x());
    if (c.speed == 0) start.z() += (1 + 4 * chance.drop) * 1e-3;  // dropped from a few millimetres
    Tip tip(c, start);

    Application application(c, stiffness, chance.phase, seed);
    const double automatic = knurl::automatic_fade(c.interval());
    knurl::Scene scene({.representations = 4, .probes = 1},
                       {.max_force = c.peak_force, .period = c.period(), .metre = c.world});
    scene.set_fade({.automatic = automatic, .rise_speed = 0.1});
    std::vector<knurl::RepresentationId> there;
    const auto add = [&](const auto& params) {
        const knurl::RepresentationId id{static_cast<std::uint32_t>(there.size()), 1};
        scene.add(id, params);
        return id;
    };
    const auto update = [&](knurl::RepresentationId id, const auto& params) { scene.update(id, params); };
    put(application.first(start), there, add, update);
    scene.settle();

    knurl::servo::FirstOrderVelocity damping(100), slow(20);
    PassivityController passivity;
    Judge judge(c, stiffness, measure);
    const Vector3d grid(chance.grid_x, 0, chance.grid_z);
    knurl::Probe probe;  // in the world
    Vector3d last = counted(start, grid, c.quantum), slewed = Vector3d::Zero();
    const auto cycles = static_cast<long>(std::lround(run_end * c.rate));
    for (long i = 0; i < cycles; ++i) {
        const double t = static_cast<double>(i) / c.rate;
        const Vector3d here = counted(tip.position, grid, c.quantum);
        const Vector3d raw = (here - last) / c.period();
        last = here;
        damping.add(raw, c.period());
        slow.add(raw, c.period());
        probe.position = c.world * here;
        probe.velocity = c.world * damping.value();
        const auto take = [&] {
            if (application.due(t)) put(application.answer(), there, add, update);
        };
        take();
        application.read(t, here, slow.value());
        if (c.answer == 0) take();
        Vector3d force = scene.evaluate(probe, c.period()).force;
        if (c.method.passivity) force = passivity.act(force, here, c.period());
        if (c.method.slew > 0) {
            const Vector3d change = force - slewed;
            slewed += change * std::min(1.0, c.method.slew * c.period() / std::max(change.norm(), 1e-300));
            force = slewed;
        }
        judge.add(t, tip.position, tip.velocity, force, tip.work);
        if (!tip.position.allFinite()) judge.fault();
        if (!measure && (judge.figures().broken() & criteria)) return judge.figures();
        tip.advance(t, force);
    }
    return judge.finish();
}

}  // namespace stability
