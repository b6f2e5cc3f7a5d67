#pragma once
// A held body: four springs between points about the hand and points of the body, the corners of a
// tetrahedron, so that the body is carried and turned.
//
// Each spring exists twice. The servo's pulls the hand, in every cycle, towards the point's path in the
// body's step. The simulation's, with a damper, pulls the body, in every part of a step, towards the hand's
// extrapolated path. So each side has the force of its own motion without delay, and knows the other's motion
// one frame late. The damper removes the energy of that delay. An account bounds the rest: what the hand has
// put in, less what the body has received and what the springs hold. With more debt than `credit` both
// springs pull less, and with twice as much not at all: the body falls, but never gains energy. A body that
// comes to rest in debt cannot repay: it is released, without debt.

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
    double fade = 0.2;       // s in which they fade out
};

class Hold {
  public:
    static constexpr std::size_t springs = 4;
    using SpringFeedback = std::array<std::optional<knurl::HandFeedback>, springs>;

    explicit Hold(const HoldOptions& options) : options_(options) {
        for (auto* vectors : {&on_body_, &ends_, &points_, &forces_}) vectors->fill(Vector3d::Zero());
    }

    /// Takes the body as it is, with the hand as last seen: no force yet. A previous hold that still fades
    /// continues into this one.
    void take(const World& world, std::size_t body);
    void let_go(double now);
    std::optional<std::size_t> held() const { return body_; }
    /// The account covers no force, and never will: the body has come to rest, and its energy is gone.
    bool slips() const { return slips_; }

    /// A cycle of the servo.
    void feel(const knurl::Report& report, const SpringFeedback& feedback);
    /// For the simulation's next step.
    std::vector<Pull> pulls(const World& world);
    /// After the step, which is played in `interval` s.
    void stepped(const World& world, double interval);
    /// The springs for the servo. Released springs fade.
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
    double move_ = 0;     // s, the time in which the servo moves the ends there
    double let_go_ = -1;  // s, time of release; below 0: never
    Vector3d position_ = Vector3d::Zero(), velocity_ = Vector3d::Zero(), spin_ = Vector3d::Zero();
    Quaterniond orientation_ = Quaterniond::Identity();
    bool softly_ = false;    // it was taken while another hold faded
    double soft_until_ = 0;  // s
    // of the springs: share sent last; N, the largest remaining force of one
    double there_ = 0, remains_ = 0;
    std::array<Vector3d, springs> points_, forces_;
    bool felt_ = false, slips_ = false;
    double share_ = 1;  // of the stiffness, as the account covers
    knurl::EnergyAccount account_;
    std::uint64_t frames_ = 0, short_of_ = 0;  // frames with a hold; those in which the account made the
                                               // springs softer
};

}  // namespace bodies
