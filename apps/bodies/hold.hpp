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

#include <array>

#include <knurl/client/client.hpp>

#include "account.hpp"
#include "world.hpp"

namespace bodies {

struct HoldOptions {
    double stiffness = 100;  // N/m, of each spring
    double damping = 1;      // of each, as a share of the critical one of the body on all of them
    double arm = 0.02;       // m, from the hand to where each is attached
    double credit = 5e-3;    // J
    double patience = 0.5;   // s without a step until the springs go
    double fade = 0.2;       // s in which they go
};

class Hold {
  public:
    static constexpr std::size_t springs = 4;
    using Felts = std::array<std::optional<knurl::Felt>, springs>;

    explicit Hold(const HoldOptions& options) : options_(options) {
        for (auto* vectors : {&on_body_, &ends_, &points_, &forces_}) vectors->fill(Vector3d::Zero());
    }

    /// The body as it is, with the hand as it was felt last: no force as yet.
    void take(const World& world, std::size_t body);
    void let_go(double now);
    std::optional<std::size_t> held() const { return body_; }
    /// Its springs have gone for want of steps: it is to be let go, and taken anew.
    bool abandoned(double now) const { return body_ && now > stepped_ + options_.patience + options_.fade; }

    /// A cycle of the servo.
    void feel(const knurl::Report& report, const Felts& felts);
    /// For the simulation's next step of `dt` s, which will be played in `interval` s.
    std::vector<Pull> pulls(const World& world, double dt, double interval);
    /// After it.
    void stepped(const World& world, double interval, double now);
    /// What the servo is told. After `patience` without a step they fade.
    std::array<knurl::Spring, springs> told(double now);

    const Account& account() const { return account_; }

  private:
    Vector3d arm(std::size_t spring) const;  // m, in the hand's frame
    double faded(double now) const;

    HoldOptions options_;
    std::optional<std::size_t> body_;
    std::array<Vector3d, springs> on_body_ = {},
                                  ends_ = {};  // m, in the body's frame; in the world, of the step
    double move_ = 0;                          // s, that the servo takes to go there
    double stepped_ = 0, fades_from_ = -1;     // s
    Vector3d position_ = Vector3d::Zero(), velocity_ = Vector3d::Zero(), spin_ = Vector3d::Zero();
    Quaterniond orientation_ = Quaterniond::Identity();
    std::array<Vector3d, springs> points_, forces_;
    bool felt_ = false, first_ = false;
    double share_ = 1;  // of the stiffness, that the account pays for
    Account account_;
};

}  // namespace bodies
