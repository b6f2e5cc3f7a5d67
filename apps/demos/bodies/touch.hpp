#pragma once
// A finger that pushes a body: the servo has the body's surface and the contact, the simulation has the body.
//
// The simulation is one step ahead: what it has computed is played while the next frame is felt, so the
// surface moves without a jump from where the step began to where it ended. The body answers a frame later
// than it was pushed, and such a delay makes energy out of nothing: a body of mass m that is pushed at
// stiffness k in frames of T is shaken off from k T^2 / m of about 1 on. Two things are done about it.
//
//   Softer.   The stiffness is at most what the body, with all that it leans on, admits at that place and
//             in that direction (World::give): the wish for a box that is pressed on the floor, less for one
//             that is free.
//   Account.  What the hand has put in by this contact, less what the body has got and what the contact's
//             spring holds. The body gets no more than that: its push is made smaller. What is left over
//             beyond a small reserve is thrown away, so that no more can ever come back at a bad moment.

#include <knurl/client/client.hpp>
#include <knurl/client/energy_account.hpp>
#include <knurl/reps/shape.hpp>

#include "world.hpp"

namespace bodies {

struct TouchOptions {
    double stiffness = 600;  // N/m
    double damping = 2;      // N s/m, of the skin
    double friction = 0.4;   // of the skin
    // stiffness times what the body gives way in a frame, at most; 0: as stiff as wished
    double softness = 0.5;
    bool keep_account = true;
    double reserve = 1e-3;  // J
};

class Touch {
  public:
    Touch(std::size_t body, std::uint32_t asset, const TouchOptions& options);

    /// A cycle of the servo, `dt` s after the last one that was seen: the finger, and what it felt.
    void feel(const Vector3d& finger, const Vector3d& velocity,
              const std::optional<knurl::HandFeedback>& feedback, double dt);
    /// Before the simulation's next step of `dt` s, which will be played in `interval` s.
    Push push(const World& world, double dt);
    /// After it: what the servo is told.
    knurl::Shape stepped(const World& world, double interval);
    /// The next step is late: where the last one ended, at rest.
    knurl::Shape rest() const;
    /// Not felt while it is held by springs.
    void held(bool so);
    /// It is where no step has taken it: what is felt goes softly, and it is met anew where it is.
    void jumped();

    /// s in which what was felt still goes. What changes beside it is not to cut that short.
    double fades_for() const;

    std::size_t body() const { return body_; }
    double stiffness() const { return stiffness_; }  // N/m, as felt last
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
    std::uint64_t frames_ = 0, short_of_ = 0;  // with a force on the body; that the account made smaller
    bool held_ = false, away_ = false;         // away: until it is met anew
    double gone_ = 0, played_ = 0;             // s, for which it was not there; of the newest frame
    // Of the newest cycle.
    Vector3d finger_ = Vector3d::Zero(), velocity_ = Vector3d::Zero(), force_ = Vector3d::Zero();
    double depth_ = 0;                     // m
    Vector3d contact_ = Vector3d::Zero();  // m, and which way it pushes: of the newest cycle that touched
    Vector3d normal_ = Vector3d::UnitZ();
    double stiffness_;  // N/m, as applied
    bool felt_ = false;
    // Since the last frame.
    Vector3d impulse_ = Vector3d::Zero();  // N s, on the hand
    double time_ = 0;
    Push push_;  // of the step that is played
};

}  // namespace bodies
