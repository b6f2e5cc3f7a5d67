#pragma once
// A body that is held: four springs between points about the hand and points of the body, the corners of a
// tetrahedron, so that it is carried and turned.
//
// There are two of each spring. The servo's pulls the hand, at every cycle, towards where the body's step
// takes that point; the simulation's, with a damper, pulls the body, in every part of a step, towards where
// the hand goes. Each side so has the force of its own motion without delay, and knows the other's a frame
// late, as it was and moving on. The damper makes up for what that delay stirs up, and an account bounds what
// it cannot: what the hand has put in, less what the body has got and what the springs hold. With more debt
// than `credit` both pull less, and with twice as much not at all: the body falls, but never by itself.
// Where it comes to rest it has nothing left of what it owes, and nothing to pay with: it is let go, without debt.

#include <array>

#include <knurl/client/client.hpp>
#include <knurl/client/energy_account.hpp>
#include <knurl/reps/spring.hpp>

#include "world.hpp"

namespace bodies {

struct HoldOptions {
    double stiffness = 100;  // N/m, of each spring
    double damping = 1;      // of each, as a share of the critical one of the body on all of them
    double arm = 0.02;       // m, from the hand to where each is attached
    double credit = 5e-3;    // J
    double fade = 0.2;       // s in which they go
};

class Hold {
  public:
    static constexpr std::size_t springs = 4;
    using SpringFeedback = std::array<std::optional<knurl::HandFeedback>, springs>;

    explicit Hold(const HoldOptions& options) : options_(options) {
        for (auto* vectors : {&on_body_, &ends_, &points_, &forces_}) vectors->fill(Vector3d::Zero());
    }

    /// The body as it is, with the hand as it was felt last: no force as yet. What still fades of a hold
    /// before that goes over into it.
    void take(const World& world, std::size_t body);
    void let_go(double now);
    std::optional<std::size_t> held() const { return body_; }
    /// The account pays for nothing, and never will: the body has come to rest, and what it got is gone.
    bool slips() const { return slips_; }

    /// A cycle of the servo.
    void feel(const knurl::Report& report, const SpringFeedback& feedback);
    /// For the simulation's next step.
    std::vector<Pull> pulls(const World& world);
    /// After it. The step is played in `interval` s.
    void stepped(const World& world, double interval);
    /// What the servo is told. What was let go fades.
    std::array<knurl::Spring, springs> told(double now);

    const knurl::EnergyAccount& account() const { return account_; }
    std::uint64_t frames() const { return frames_; }
    std::uint64_t short_of() const { return short_of_; }

  private:
    Vector3d arm(std::size_t spring) const;  // m, in the hand's frame

    HoldOptions options_;
    std::optional<std::size_t> body_;
    // m, in the body's frame; in the world, of the step
    std::array<Vector3d, springs> on_body_ = {}, ends_ = {};
    double move_ = 0;     // s, that the servo takes to go there
    double let_go_ = -1;  // s, when; below 0: never
    Vector3d position_ = Vector3d::Zero(), velocity_ = Vector3d::Zero(), spin_ = Vector3d::Zero();
    Quaterniond orientation_ = Quaterniond::Identity();
    bool softly_ = false;    // it is taken while something fades
    double soft_until_ = 0;  // s
    // of the springs: share that was told last; N, the most that is felt of one
    double there_ = 0, remains_ = 0;
    std::array<Vector3d, springs> points_, forces_;
    bool felt_ = false, slips_ = false;
    double share_ = 1;  // of the stiffness, that the account pays for
    knurl::EnergyAccount account_;
    std::uint64_t frames_ = 0, short_of_ = 0;  // that held; with springs that the account made softer
};

}  // namespace bodies
