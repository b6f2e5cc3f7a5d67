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

/// World, servo and coupling in step, cycle by cycle.
class TrialRun {
  public:
    TrialRun(World& world, const Script& script, const TrialOptions& options)
        : world_(world),
          script_(script),
          options_(options),
          hand_(options.device, script.motion(), options.clamp),
          energy_before_(world.energy()) {
        std::vector<std::uint32_t> assets;
        for (const Body& body : world.bodies()) assets.push_back(hand_.send(skin_of(body)));
        if (options.force_in_loop > 0)
            loop_.emplace(hand_, options.force_in_loop);
        else
            coupled_.emplace(hand_, world, assets, options.coupled, 1 / options.rate);
        for (std::uint32_t i = 0; i < options.coupled.fingers.size(); ++i)
            hand_.place_probe(i, {.offset = knurl::to_plain(options.coupled.fingers[i]), .radius = 0});
        hand_.commit();
    }

    bool over() const {
        const double seconds = options_.seconds > 0 ? options_.seconds : script_.end();
        return hand_.now() >= seconds || trial_.faults != 0;
    }

    /// One cycle of the servo, and the frame of the simulation that is due in it.
    Moment step() {
        const knurl::Report& report = hand_.step();
        const double now = hand_.now();
        note(report);
        if (coupled_) {
            coupled_->feel(report, 1e-3);
            take_and_let_go(now);
            if (coupled_->watch(now) != Coupled<OfflineHand>::Frames::on_time) hand_.commit();
        }
        disturb(now);
        const bool stopped = now >= options_.stop_at && now < options_.stop_at + options_.stop_for;
        if (!stopped && !world_.lost() && now >= next_frame_) frame(report, now);
        return {.t = now,
                .report = report,
                .truth = hand_.truth(),
                .put_in = coupled_ ? coupled_->account().hand : 0,
                .stiffness = coupled_ ? coupled_->stiffness() : options_.force_in_loop};
    }

    Trial finish() {
        if (coupled_) {
            trial_.account = coupled_->account();
            trial_.short_of = coupled_->short_of();
            trial_.jumps = coupled_->jumps();
        }
        trial_.gained = world_.energy() - energy_before_;
        trial_.motor_work = hand_.truth().motor_work;
        return trial_;
    }

  private:
    void note(const knurl::Report& report) {
        const Vector3d force = knurl::to_eigen(report.scene_force);
        if (last_force_) trial_.jump = std::max(trial_.jump, (force - *last_force_).norm());
        last_force_ = force;
        trial_.faults |= report.faults;
    }

    /// The script's events that are due.
    void take_and_let_go(double now) {
        for (; event_ < script_.events().size() && now >= script_.events()[event_].t; ++event_) {
            if (script_.events()[event_].take) {
                coupled_->take(world_, now);
                hand_.commit();
            } else {
                coupled_->let_go(now);
            }
        }
    }

    /// A reset and an engine error, once each, if the options ask for them.
    void disturb(double now) {
        if (options_.reset_at >= 0 && now >= options_.reset_at && !std::exchange(reset_, true))
            energy_before_ += world_.reset();
        if (options_.kick_at >= 0 && now >= options_.kick_at && !std::exchange(kicked_, true))
            world_.kick(options_.kicked, options_.kick);
    }

    void frame(const knurl::Report& report, double now) {
        const double dt = 1 / options_.rate;
        while (next_frame_ <= now) next_frame_ += options_.slower * dt;
        const Orders orders = coupled_ ? coupled_->orders(world_, now)
                                       : loop_->orders(world_, knurl::to_eigen(report.position));
        world_.step(dt, orders.pushes, orders.pulls);
        if (coupled_) coupled_->show(world_, now);
        hand_.commit();
        ++trial_.frames;
    }

    World& world_;
    const Script& script_;
    const TrialOptions& options_;
    OfflineHand hand_;
    std::optional<Coupled<OfflineHand>> coupled_;  // this, or
    std::optional<ForceLoop> loop_;                // this
    double energy_before_;                         // J, of the bodies
    double next_frame_ = 0;                        // s
    std::size_t event_ = 0;                        // the script's next one
    bool reset_ = false, kicked_ = false;
    std::optional<Vector3d> last_force_;
    Trial trial_;
};

}  // namespace

Trial run_trial(World& world, const Script& script, const TrialOptions& options,
                const std::function<void(const Moment&)>& each) {
    TrialRun run(world, script, options);
    while (!run.over()) {
        const Moment moment = run.step();
        if (each) each(moment);
    }
    return run.finish();
}

}  // namespace bodies
