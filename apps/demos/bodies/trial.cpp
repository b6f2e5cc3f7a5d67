#include "trial.hpp"

#include <utility>

#include <knurl/reps/constant_force.hpp>

namespace bodies {

namespace {

/// The usual way: the engine's loop computes the contact's force and sends it.
class ForceLoop {
  public:
    ForceLoop(OfflineHand& hand, double stiffness)
        : force_(hand.add(knurl::ConstantForce{.recovery = 0})), stiffness_(stiffness) {}
    Orders orders(const World& world, const Vector3d& hand) {
        Orders orders;
        knurl::ConstantForce sent{.recovery = 0};
        for (std::size_t i = 0; i < world.bodies().size(); ++i) {
            Vector3d surface;
            if (world.distance(i, hand, &surface) >= 0) continue;
            const Vector3d force = stiffness_ * (surface - hand);
            sent.force = knurl::to_plain(knurl::to_eigen(sent.force) + force);
            orders.pushes.push_back({.body = i, .force = -force, .point = surface});
        }
        force_.set(sent);
        return orders;
    }

  private:
    OfflineHand::There<knurl::ConstantForce> force_;
    double stiffness_;
};

}  // namespace

// NOLINTNEXTLINE(readability-function-cognitive-complexity): a trial's timetable, in order of time
Trial run_trial(World& world, const Script& script, const TrialOptions& options,
                const std::function<void(const Moment&)>& each) {
    OfflineHand hand(options.device, script.motion(), options.clamp);
    std::vector<std::uint32_t> assets;
    for (const Body& body : world.bodies()) assets.push_back(hand.send(skin_of(body)));
    std::optional<Coupled<OfflineHand>> coupled;
    std::optional<ForceLoop> loop;
    if (options.force_in_loop > 0)
        loop.emplace(hand, options.force_in_loop);
    else
        coupled.emplace(hand, world, assets, options.coupled, 1 / options.rate);
    for (std::uint32_t i = 0; i < options.coupled.fingers.size(); ++i)
        hand.place_probe(i, {.offset = knurl::to_plain(options.coupled.fingers[i]), .radius = 0});
    hand.commit();

    Trial trial;
    const double dt = 1 / options.rate;
    double before = world.energy();
    bool reset = false, kicked = false;
    const double seconds = options.seconds > 0 ? options.seconds : script.end();
    double next = 0;
    std::size_t event = 0;
    std::optional<Vector3d> last;
    while (hand.now() < seconds && trial.faults == 0) {
        const knurl::Report& report = hand.step();
        const double now = hand.now();
        if (coupled) coupled->feel(report, 1e-3);
        const Vector3d force = knurl::to_eigen(report.scene_force);
        if (last) trial.jump = std::max(trial.jump, (force - *last).norm());
        last = force;
        trial.faults |= report.faults;
        for (; coupled && event < script.events().size() && now >= script.events()[event].t; ++event)
            if (script.events()[event].take)
                coupled->take(world, now), hand.commit();
            else
                coupled->let_go(now);
        const bool stopped = now >= options.stop_at && now < options.stop_at + options.stop_for;
        if (coupled && coupled->watch(now) != Coupled<OfflineHand>::Frames::on_time) hand.commit();
        if (options.reset_at >= 0 && now >= options.reset_at && !reset) {
            before += world.reset();
            reset = true;
        }
        if (options.kick_at >= 0 && now >= options.kick_at && !std::exchange(kicked, true))
            world.kick(options.kicked, options.kick);
        if (!stopped && !world.lost() && now >= next) {
            while (next <= now) next += options.slower * dt;
            const Orders orders =
                coupled ? coupled->orders(world, now) : loop->orders(world, knurl::to_eigen(report.position));
            world.step(dt, orders.pushes, orders.pulls);
            if (coupled) coupled->show(world, now);
            hand.commit();
            ++trial.frames;
        }
        if (each)
            each({.t = now,
                  .report = report,
                  .truth = hand.truth(),
                  .put_in = coupled ? coupled->account().hand : 0,
                  .stiffness = coupled ? coupled->stiffness() : options.force_in_loop});
    }
    if (coupled) {
        trial.account = coupled->account();
        trial.short_of = coupled->short_of();
        trial.jumps = coupled->jumps();
    }
    trial.gained = world.energy() - before;
    trial.motor_work = hand.truth().motor_work;
    return trial;
}

}  // namespace bodies
