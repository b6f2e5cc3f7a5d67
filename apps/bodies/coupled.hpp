#pragma once
// A hand in a tray of bodies: all that goes between the servo and the simulation.
//
//     Coupled coupled(hand, world, assets, options);
//     in every cycle of the servo   coupled.feel(report, seconds);
//     in every frame                coupled.step(world, dt, interval);    // or in a thread of its own
//                                   coupled.show(world, interval, now);
//                                   hand.commit();
//
// Of the servo it needs add(), and of what add() gives set() and felt(): a knurl::Claim, or a servo in this
// process.

#include <functional>

#include "hold.hpp"
#include "touch.hpp"

namespace bodies {

struct CoupledOptions {
    TouchOptions touch;
    HoldOptions hold;
    std::vector<Vector3d> fingers = {Vector3d::Zero()};  // m, where they are in the hand's frame
    double reach = 0.015;                                // m, of the hand that takes
};

/// What the simulation's next step is to do.
struct Orders {
    std::vector<Push> pushes = {};
    std::vector<Pull> pulls = {};
};

template <class Hand>
class Coupled {
  public:
    Coupled(Hand& hand, const World& world, const std::vector<std::uint32_t>& assets,
            const CoupledOptions& options)
        : options_(options), hold_(options.hold) {
        for (std::size_t body = 0; body < world.bodies().size(); ++body)
            for (std::uint32_t finger = 0; finger < options.fingers.size(); ++finger) {
                Touch touch(body, assets[body], options.touch);
                const knurl::Shape shape = touch.stepped(world, 1);
                touching_.push_back({touch, finger, hand.add(shape, knurl::Use{.probe = finger})});
            }
        for (const knurl::Spring& spring : hold_.told(0)) springs_.push_back(hand.add(spring));
    }

    /// A cycle of the servo, `dt` s after the last one.
    void feel(const knurl::Report& report, double dt) {
        position_ = knurl::to_eigen(report.position);
        const Vector3d velocity = knurl::to_eigen(report.velocity),
                       spin = knurl::to_eigen(report.angular_velocity);
        for (Touching& t : touching_) {
            const Vector3d arm = knurl::to_eigen(report.orientation) * options_.fingers[t.finger];
            t.touch.feel(position_ + arm, velocity + spin.cross(arm), t.shape.felt(), dt);
        }
        Hold::Felts felts;
        for (std::size_t i = 0; i < felts.size(); ++i) felts[i] = springs_[i].felt();
        hold_.feel(report, felts);
    }
    /// For the simulation's next step of `dt` s, which will be played in `interval` s.
    Orders orders(const World& world, double dt, double interval) {
        Orders orders{.pushes = {}, .pulls = hold_.pulls(world, dt, interval)};
        for (Touching& t : touching_) orders.pushes.push_back(t.touch.push(world, dt));
        return orders;
    }
    /// What it has computed.
    void show(const World& world, double interval, double now) {
        for (Touching& t : touching_) t.shape.set(t.touch.stepped(world, interval));
        hold_.stepped(world, interval, now);
        wait_with_springs(now);
    }
    /// It is late, or has stopped: all rests where its step ended.
    void wait(double now) {
        for (Touching& t : touching_) t.shape.set(t.touch.rest());
        wait_with_springs(now);
    }

    /// The nearest body within reach; false: there is none.
    bool take(const World& world) {
        std::optional<std::size_t> nearest;
        double least = options_.reach;
        for (std::size_t i = 0; i < world.bodies().size(); ++i)
            if (const double away = world.distance(i, position_); away < least) nearest = i, least = away;
        if (!nearest) return false;
        hold_.take(world, *nearest);
        for (Touching& t : touching_) t.touch.felt_at_all(t.touch.body() != *nearest);
        return true;
    }
    void let_go(double now) {
        hold_.let_go(now);
        for (Touching& t : touching_) t.touch.felt_at_all(true);
    }

    std::optional<std::size_t> held() const { return hold_.held(); }
    Account account() const {
        Account sum = hold_.account();
        for (const Touching& t : touching_) sum += t.touch.account();
        return sum;
    }

  private:
    struct Touching {
        Touch touch;
        std::uint32_t finger;
        decltype(std::declval<Hand&>().add(knurl::Shape{})) shape;
    };
    void wait_with_springs(double now) {
        if (hold_.abandoned(now)) let_go(now);
        const auto told = hold_.told(now);
        for (std::size_t i = 0; i < told.size(); ++i) springs_[i].set(told[i]);
    }

    CoupledOptions options_;
    Hold hold_;
    std::vector<Touching> touching_;
    std::vector<decltype(std::declval<Hand&>().add(knurl::Spring{}))> springs_;
    Vector3d position_ = Vector3d::Zero();
};

}  // namespace bodies
