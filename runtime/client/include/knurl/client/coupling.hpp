#pragma once

/// @file
/// A hand and a body that somebody else computes, through a spring: the servo has the spring, the simulation
/// the body, and a frame now and then is all that goes between.
///
///     knurl::Coupling coupling(options);                // 5 mm for 1 A, 0.7 N for 1 kcal/mol/A, 200 N/m
///     auto spring = hand.add(coupling.spring());        // no force until it holds
///     coupling.hold(body.position, report.position);
///     while (simulation.runs()) {
///         for (auto report = hand.next_report(1ms); report; report = hand.next_report(0ms))
///             coupling.feel(*report, spring.feedback());
///         if (auto frame = simulation.frame()) body.push(coupling.frame(frame->position, now()));
///         if (coupling.watch(now()) == knurl::Coupling::State::stopped) body.push({});
///         spring.set(coupling.spring());
///         hand.commit();
///     }
///
/// What is difficult here is the frame's age. The force that a frame answers acts on the body a frame later,
/// on a body that has moved meanwhile; the spring's end follows later still. Both make energy out of nothing,
/// most of it at low rates. So the coupling keeps an account: what the hand has put in, less what the body
/// has got. The spring's end is put no farther from the hand than that the spring stores what is in the
/// account, and the body is pulled as by the spring where it will be, not where it was. A body that moves by
/// itself (heat) can pull the hand with what is in the account, and no more.
///
/// Plain arithmetic: it knows no claim and no clock, and any number of them may share a hand. Several springs
/// on one hand (attached beside its middle) are one Coupling each, if each holds a body of its own; what
/// holds one body by several needs one account of all (knurl-bodies is an example, of the same parts).

#include <optional>

#include <Eigen/Core>

#include <knurl/client/client.hpp>
#include <knurl/client/energy_account.hpp>
#include <knurl/client/frame_watch.hpp>
#include <knurl/reps/spring.hpp>

namespace knurl {

/// What one of the simulation's units is at the hand.
struct CouplingScale {
    /// One of the simulation's units of length (m).
    double length = 1;
    /// One of the simulation's units of force (N).
    double force = 1;
};

/// How hand and body are coupled.
struct CouplingOptions {
    /// The simulation's units.
    CouplingScale scale = {};
    /// Stiffness of the spring in the claim's world (N/m).
    double stiffness = 200;
    /// Expected time between frames (s); measured from the fifth on.
    double interval = 0.02;
    /// Frames that pass between a force and the first frame since which it acts.
    int frames_late = 0;
    /// Largest force on the body, in the simulation's units.
    double greatest_force = 1e30;
    /// Largest speed of the spring's end, at the hand (m/s): 0.25 m/s at 200 N/m is 0.05 N in a cycle of 1
    /// ms.
    double greatest_speed = 0.25;
    /// Time in which the spring's end moves to a new place (s), at most; with more frequent frames as long as
    /// a frame.
    double longest_move = 0.2;
    /// The hand's energy (J) that is kept for the body's restlessness; what is beyond is lost.
    double reserve = 0.01;
    /// False: the end goes wherever the body is, with whatever force.
    bool keep_account = true;
    /// A simulation has stopped after so many usual intervals without a frame, and half a second at least.
    double patience = 5;
    /// Time in which the spring then fades (s).
    double fade = 0.5;
    /// Metres of the claim's world that one metre of the device is (Claim::limits()). `greatest_speed` and
    /// `reserve` are in units of the device; `stiffness` and `scale` in those of the claim's world.
    double metre = 1;
    /// Newtons of the claim's world that one newton of the device is; as `metre`.
    double newton = 1;
};

/// A hand and a body that somebody else computes, through a spring. Plain arithmetic, without a claim or a
/// clock; the head of this file says how it is used.
class Coupling {
  public:
    /// Whether the body is held.
    enum class State {
        /// Nothing is held (any more: the spring fades).
        idle,
        /// The body is held, and frames come as they should.
        holding,
        /// The next frame is overdue: the spring's end has arrived and waits.
        late,
        /// No frames come: the spring fades, and comes back with the first frame after that.
        stopped,
    };

    /// The energy account.
    using Account = EnergyAccount;
    /// How often something happened since the beginning.
    struct Counts {
        /// Frames.
        std::uint64_t frames = 0;
        /// Frames whose force greatest_force had to bound.
        std::uint64_t bounded = 0;
        /// Frames in which the account could not pay for the whole way to the body.
        std::uint64_t short_of = 0;
        /// Jumps of the body, farther than it can move; they do not count as work.
        std::uint64_t jumps = 0;
        /// Times that the simulation stopped.
        std::uint64_t stops = 0;
    };

    /// Throws Error for options that make no sense.
    explicit Coupling(const CouplingOptions& options);

    /// The body is where the hand is, from now on, as far as the hand can tell: no force until one of them
    /// moves, and the whole stiffness after 50 ms. The spring of a hold before fades first: meanwhile the
    /// state is `stopped`.
    void hold(const Vec3& body, const Vec3& hand);
    /// The spring fades. `now`: s, of the clock of frame().
    void let_go(double now);

    /// Largest force on the body from the next frame on, in the simulation's units; 0: it is left alone.
    void bound(double greatest_force) { options_.greatest_force = greatest_force; }
    /// To be called with each report and the spring's feedback in it; of two different cycles nothing is
    /// taken. `attach`: as in Spring.
    void feel(const Report& report, const std::optional<HandFeedback>& feedback, const Vec3& attach = {});
    /// A frame of the simulation: the body is at this place. Returns the force to push it with from now on,
    /// in the simulation's units. `now`: s, of any clock, the same as for watch(). Throws Error for a place
    /// that is not finite.
    Vec3 frame(const Vec3& body, double now);
    /// A frame that came with newer ones behind it: the force that was sent last acts on, and is not replaced
    /// for this frame.
    void superseded(const Vec3& body);
    /// To be called before each spring(), also while nothing is held: the spring's end then goes with the
    /// hand. `now`: s.
    State watch(double now);
    /// The spring, for Handle<Spring>::set.
    Spring spring() const;

    /// A place of the simulation in the hand's world (m).
    Vec3 to_hand(const Vec3& body) const;
    /// A place of the hand's world (m) in the simulation.
    Vec3 to_simulation(const Vec3& hand) const;
    /// The simulation's energy (force times length) that one joule of the hand is.
    double energy_scale() const { return 1 / (options_.scale.force * options_.scale.length); }

    /// The energy account of all that was ever held (J).
    const Account& account() const { return account_; }
    /// How often something happened since the beginning.
    const Counts& counts() const { return counts_; }
    /// The state as of the last call.
    State state() const { return state_; }
    /// Usual time between frames (s).
    double interval() const { return frames_.interval(); }
    /// How far a force moves the body in a frame (m/N).
    double compliance() const { return compliance_; }

  private:
    void begin();
    void fade_from(double now);
    bool still_fades() const;
    void park();
    std::optional<Eigen::Vector3d> moved_to(const Vec3& body);
    void measure_compliance(const Eigen::Vector3d& force, const Eigen::Vector3d& way);
    void move_end(const Eigen::Vector3d& body, double now);
    Eigen::Vector3d answer(const Eigen::Vector3d& body);

    CouplingOptions options_;
    State state_ = State::idle;
    Account account_;
    Counts counts_;
    Eigen::Vector3d hand_origin_ = Eigen::Vector3d::Zero(), body_origin_ = Eigen::Vector3d::Zero();
    // The hand's side, of the newest cycle.
    Eigen::Vector3d hand_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
    double stiffness_;  // N/m as applied
    bool felt_ = false;
    // The body's side: force_[0] acts on the way to the next frame, the last one was sent last.
    std::optional<Eigen::Vector3d> body_;
    Eigen::Vector3d sent_[3] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    double compliance_ = 0, force_square_ = 0, force_way_ = 0;
    double stray_ = 0;  // m: rms of what the compliance does not explain of the body's way
    FrameWatch frames_;
    int superseded_ = 0;
    std::uint64_t held_frames_ = 0;
    double faded_from_ = 0, fading_ = 0;
    Vec3 end_;                                              // of the spring: where it is sent,
    Eigen::Vector3d moved_from_ = Eigen::Vector3d::Zero();  // from there,
    double moved_at_ = 0, move_time_ = 0;                   // s: since then, in that time
    bool begins_ = false;                                   // held, and no frame has moved the end yet
    double begun_at_ = 0;                                   // s
};

}  // namespace knurl
