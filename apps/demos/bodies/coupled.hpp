#pragma once
// A hand in a tray of bodies: everything between the servo and the simulation.
//
//     Coupled coupled(hand, world, assets, options, dt);
//     in every cycle of the servo   coupled.feel(report, seconds);
//                                   coupled.watch(now);
//     in every frame                coupled.step(world, dt, orders);      // or in a thread of its own
//                                   coupled.show(world, now);
//                                   hand.commit();
//
// From the servo it needs add(), and from the handles set() and feedback(): a knurl::Claim, or a servo in
// this process.

#include <functional>

#include <knurl/client/frame_watch.hpp>
#include <knurl/reps/shape.hpp>
#include <knurl/reps/spring.hpp>

#include "hold.hpp"
#include "touch.hpp"

namespace bodies {

struct CoupledOptions {
    TouchOptions touch;
    HoldOptions hold;
    std::vector<Vector3d> fingers = {Vector3d::Zero()};  // m, where they are in the hand's frame
    double reach = 0.015;                                // m, within which the hand can take a body
};

/// Input of the simulation's next step.
struct Orders {
    std::vector<Push> pushes = {};
    std::vector<Pull> pulls = {};
};

template <class Hand>
class Coupled {
  public:
    using Frames = knurl::FrameWatch::State;

    /// `dt`: s of simulated time per frame.
    Coupled(Hand& hand, const World& world, const std::vector<std::uint32_t>& assets,
            const CoupledOptions& options, double dt)
        : options_(options), dt_(dt), frames_(dt), hold_(options.hold) {
        for (std::size_t body = 0; body < world.bodies().size(); ++body) {
            seen_.push_back(world.after(body));
            for (std::uint32_t finger = 0; finger < options.fingers.size(); ++finger) {
                Touch touch(body, assets[body], options.touch);
                const knurl::Shape shape = touch.stepped(world, 1);
                touching_.push_back({touch, finger, hand.add(shape, knurl::AddOptions{.probe = finger})});
            }
        }
        for (const knurl::Spring& spring : hold_.told(0)) springs_.push_back(hand.add(spring));
    }

    // The whole coupling: input from the hand, orders to the simulation, updates to the servo, supervision.

    /// A cycle of the servo, `dt` s after the last one.
    void feel(const knurl::Report& report, double dt) {
        position_ = knurl::to_eigen(report.position);
        const Vector3d velocity = knurl::to_eigen(report.velocity),
                       spin = knurl::to_eigen(report.angular_velocity);
        for (Touching& t : touching_) {
            const Vector3d arm = knurl::to_eigen(report.orientation) * options_.fingers[t.finger];
            t.touch.feel(position_ + arm, velocity + spin.cross(arm), t.shape.feedback(), dt);
        }
        Hold::SpringFeedback feedback;
        for (std::size_t i = 0; i < feedback.size(); ++i) feedback[i] = springs_[i].feedback();
        hold_.feel(report, feedback);
    }
    /// For the simulation's next step.
    Orders orders(const World& world, double now) {
        look_for_jumps(world, now);
        Orders orders{.pushes = {}, .pulls = hold_.pulls(world)};
        for (Touching& t : touching_) orders.pushes.push_back(t.touch.push(world, dt_));
        return orders;
    }
    /// Takes over the results of the step.
    void show(const World& world, double now) {
        frames_.frame(now);
        for (std::size_t body = 0; body < seen_.size(); ++body) {
            seen_[body] = world.after(body);
            if (world.leapt(body) || world.lost() == body) jumped(body, now);
        }
        tell_touched([&](Touch& touch) { return touch.stepped(world, interval()); });
        hold_.stepped(world, interval());
        if (hold_.slips()) let_go(now);
        tell_springs(now);
    }
    /// If the next frame is late, all bodies rest where the last one ended; if none comes, the held body is
    /// released.
    Frames watch(double now) {
        const Frames state = frames_.watch(now);
        if (state == Frames::on_time) return state;
        tell_touched([](const Touch& touch) { return touch.rest(); });
        if (state == Frames::stopped && held()) let_go(now);
        tell_springs(now);
        return state;
    }
    /// Finds bodies that no step has moved to their place: after a reset, for example. Their force does not
    /// step, and the jump is no work. (show() finds a jump within a step, or to a place that is not finite.)
    void look_for_jumps(const World& world, double now) {
        for (std::size_t body = 0; body < seen_.size(); ++body) {
            if (!world.after(body).is_near(seen_[body])) jumped(body, now);
        }
    }

    /// Takes the nearest body within reach; false: there is none. Takes hold at once, not with the next
    /// frame: until then the hand would move, and its force would step.
    bool take(const World& world, double now) {
        std::optional<std::size_t> nearest;
        double least = options_.reach;
        for (std::size_t i = 0; i < world.bodies().size(); ++i)
            if (const double away = world.distance(i, position_); away < least) nearest = i, least = away;
        if (!nearest) return false;
        hold_.take(world, *nearest);
        for (Touching& t : touching_) t.touch.held(t.touch.body() == *nearest);
        tell_springs(now);
        return true;
    }
    void let_go(double now) {
        hold_.let_go(now);
        for (Touching& t : touching_) t.touch.held(false);
    }

    std::optional<std::size_t> held() const { return hold_.held(); }
    /// s in which a frame is played: the measured interval, if that is longer than the simulated time. A
    /// small difference is ignored, since cycles and frames do not begin together.
    double interval() const { return frames_.interval() > 1.02 * dt_ ? frames_.interval() : dt_; }
    std::uint64_t jumps() const { return jumps_; }
    /// N/m of the stiffest touched surface; 0: none is touched.
    double stiffness() const {
        double most = 0;
        for (const Touching& t : touching_)
            if (t.touch.touches()) most = std::max(most, t.touch.stiffness());
        return most;
    }
    knurl::EnergyAccount account() const { return sum(&Hold::account, &Touch::account); }
    std::uint64_t pushed() const {
        return sum(&Hold::frames, &Touch::frames);
    }  // frames with a force on a body
    std::uint64_t short_of() const {
        return sum(&Hold::short_of, &Touch::short_of);
    }  // those of them in which the account bounded the force

  private:
    struct Touching {
        Touch touch;
        std::uint32_t finger;
        decltype(std::declval<Hand&>().add(knurl::Shape{})) shape;
    };
    auto sum(auto of_hold, auto of_touch) const {
        auto all = (hold_.*of_hold)();
        for (const Touching& t : touching_) all += (t.touch.*of_touch)();
        return all;
    }
    void jumped(std::size_t body, double now) {
        if (held() == body) let_go(now);
        for (Touching& t : touching_)
            if (t.touch.body() == body) t.touch.jumped();
        ++jumps_;
    }
    /// All surfaces of a probe share one fade, so setting one at once would end the fade of another.
    void tell_touched(auto shape_of) {
        std::vector<knurl::Shape> shapes;
        double fade = 0;
        for (Touching& t : touching_) {
            shapes.push_back(shape_of(t.touch));
            fade = std::max(fade, t.touch.fades_for());
        }
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            shapes[i].recovery = fade;
            touching_[i].shape.set(shapes[i]);
        }
    }
    void tell_springs(double now) {
        const auto told = hold_.told(now);
        for (std::size_t i = 0; i < told.size(); ++i) springs_[i].set(told[i]);
    }

    CoupledOptions options_;
    double dt_;
    knurl::FrameWatch frames_;
    Hold hold_;
    std::vector<Touching> touching_;
    std::vector<decltype(std::declval<Hand&>().add(knurl::Spring{}))> springs_;
    std::vector<Pose> seen_;  // in the newest frame
    std::uint64_t jumps_ = 0;
    Vector3d position_ = Vector3d::Zero();
};

}  // namespace bodies
