#pragma once
// A finger that pushes a body: the servo has the body's surface and the contact, the simulation has the body.
//
// The simulation is one step ahead: its result is played while the next frame is computed, so the surface
// moves continuously from the start to the end of a step. The body responds one frame after the push, and
// such a delay creates energy: a body of mass m that is pushed with stiffness k in frames of T is shaken off
// from k T^2 / m of about 1 on. Two measures prevent that.
//
//   Softer.   The stiffness is at most what the body, with all that it leans on, admits at that place and
//             in that direction (World::give): the requested one for a box that is pressed on the floor, less
//             for a free box.
//   Account.  What the hand has put in through this contact, less what the body has received and what the
//             contact's spring holds. The body receives no more than that: its push is reduced. A surplus beyond
//             a small reserve is discarded, so that it can never return at a bad moment.

#include <knurl/client/client.hpp>
#include <knurl/client/energy_account.hpp>
#include <knurl/reps/shape.hpp>

#include "world.hpp"

namespace bodies {

struct TouchOptions {
    double stiffness = 600;  // N/m
    double damping = 2;      // N s/m, of the skin
    double friction = 0.4;   // of the skin
    // stiffness times the body's give in a frame, at most; 0: the requested stiffness
    double softness = 0.5;
    bool keep_account = true;
    double reserve = 1e-3;  // J
};

class Touch {
  public:
    Touch(std::size_t body, std::uint32_t asset, const TouchOptions& options);

    /// A cycle of the servo, `dt` s after the last one: the finger, and its force.
    void feel(const Vector3d& finger, const Vector3d& velocity,
              const std::optional<knurl::HandFeedback>& feedback, double dt);
    /// Before the simulation's next step of `dt` s, which will be played in `interval` s.
    Push push(const World& world, double dt);
    /// After the step: the shape for the servo.
    knurl::Shape stepped(const World& world, double interval);
    /// The next step is late: the shape stays where the last one ended.
    knurl::Shape rest() const;
    /// Without force while springs hold it.
    void held(bool so);
    /// The body is where no step has moved it: its force fades out, and it is met anew there.
    void jumped();

    /// s for which the old surface still fades. Other changes must not cut that short.
    double fades_for() const;

    std::size_t body() const { return body_; }
    double stiffness() const { return stiffness_; }  // N/m, as last applied
    bool touches() const { return force_.squaredNorm() > 0; }
    const knurl::EnergyAccount& account() const { return account_; }
    std::uint64_t frames() const { return frames_; }
    std::uint64_t short_of() const { return short_of_; }

  private:
    bool there() const { return !held_ && !away_; }
    void leave();
    void settle();
    knurl::Shape shown(knurl::Shape shape) const;
    double admitted(const World& world, double dt) const;
    double affordable(const Vector3d& force, double give, double dt, const Vector3d& speed) const;

    std::size_t body_;
    TouchOptions options_;
    knurl::Shape shape_;
    Pose end_;
    knurl::EnergyAccount account_;
    std::uint64_t frames_ = 0, short_of_ = 0;  // with a force on the body; reduced by the account
    bool held_ = false, away_ = false;         // away: until it is met anew
    double gone_ = 0, played_ = 0;             // s: how long it has been absent; of the newest frame
    // Of the newest cycle.
    Vector3d finger_ = Vector3d::Zero(), velocity_ = Vector3d::Zero(), force_ = Vector3d::Zero();
    double depth_ = 0;                     // m
    Vector3d contact_ = Vector3d::Zero();  // m, and its direction of push: of the newest cycle with a touch
    Vector3d normal_ = Vector3d::UnitZ();
    double stiffness_;  // N/m, as applied
    bool felt_ = false;
    // Since the last frame.
    Vector3d impulse_ = Vector3d::Zero();  // N s, on the hand
    double time_ = 0;
    Push push_;  // of the step under way
};

}  // namespace bodies
