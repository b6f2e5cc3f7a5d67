#pragma once
// A hand and a body that somebody else computes, through a spring: the servo has the spring, the simulation
// the body, and a frame now and then is all that goes between.
//
//     knurl::Coupling coupling(options);                // 5 mm for 1 A, 0.7 N for 1 kcal/mol/A, 200 N/m
//     auto spring = hand.add(coupling.spring());        // no force until it holds
//     coupling.hold(body.position, report.position);
//     while (simulation.runs()) {
//         for (auto report = hand.next_report(1ms); report; report = hand.next_report(0ms))
//             coupling.feel(*report, spring.feedback());
//         if (auto frame = simulation.frame()) body.push(coupling.frame(frame->position, now()));
//         if (coupling.watch(now()) == knurl::Coupling::State::stopped) body.push({});
//         spring.set(coupling.spring());
//         hand.commit();
//     }
//
// What is difficult here is the frame's age. The force that a frame answers acts on the body a frame later,
// on a body that has moved meanwhile; the spring's end follows later still. Both make energy out of nothing,
// most of it at low rates. So the coupling keeps an account: what the hand has put in, less what the body has
// got. The spring's end is put no farther from the hand than that the spring stores what is in the account,
// and the body is pulled as by the spring where it will be, not where it was. A body that moves by itself
// (heat) can pull the hand with what is in the account, and no more.
//
// Plain arithmetic: it knows no claim and no clock, and any number of them may share a hand. Several springs
// on one hand (attached beside its middle) are one Coupling each, if each holds a body of its own; what holds
// one body by several needs one account of all (knurl-bodies is an example, of the same parts).

#include <optional>

#include <Eigen/Core>

#include <knurl/client/client.hpp>
#include <knurl/client/energy_account.hpp>
#include <knurl/client/frame_watch.hpp>

namespace knurl {

/// What one of the simulation's units is in the hand.
struct CouplingScale {
    double length = 1;  // m
    double force = 1;   // N
};

struct CouplingOptions {
    CouplingScale scale = {};
    double stiffness = 200;        // N/m, of the spring in the claim's world
    double interval = 0.02;        // s between frames as expected; measured from the fifth on
    int frames_late = 0;           // frames that pass between a force and the first frame since which it acts
    double greatest_force = 1e30;  // of the simulation's units, on the body
    double greatest_speed =
        0.25;                   // m/s, of the hand, of the spring's end: at 200 N/m 0.05 N in a cycle of 1 ms
    double longest_move = 0.2;  // s; a more frequent frame's move takes as long as the frame
    double reserve = 0.01;      // J of the hand's that are kept for the body's restlessness; the rest is lost
    bool keep_account = true;   // false: the end goes wherever the body is, with whatever force
    double patience = 5;        // usual intervals, and half a second at least, until a simulation has stopped
    double fade = 0.5;          // s in which the spring then goes
    // Of the claim's world, that one of the device's is (Claim::limits()): greatest_speed and reserve mean the
    // hand, in metres and joules of the device; `stiffness` and `scale` are the claim's world's.
    double metre = 1, newton = 1;
};

class Coupling {
  public:
    enum class State {
        idle,     // holds nothing (any more: the spring fades)
        holding,  // frames come as they should
        late,     // the next frame is overdue: the end has arrived and waits
        stopped,  // nothing comes: the spring fades, and comes back with the first frame after that
    };

    using Account = EnergyAccount;  // of all that was ever held
    struct Counts {
        std::uint64_t frames = 0;
        std::uint64_t bounded = 0;   // with a force that greatest_force had to bound
        std::uint64_t short_of = 0;  // in which the account could not pay for the whole way to the body
        std::uint64_t jumps = 0;     // of the body, farther than it goes; not counted as work
        std::uint64_t stops = 0;
    };

    /// Throws knurl::Error for what makes no sense.
    explicit Coupling(const CouplingOptions& options);

    /// The body is where the hand is, from now on, as far as the hand can tell: no force until one of them
    /// moves, and the whole stiffness after 50 ms. What fades of a hold before fades first: meanwhile it is
    /// `stopped`.
    void hold(const Vec3& body, const Vec3& hand);
    void let_go(double now);  // the spring fades

    /// Of the force on the body from the next frame on, in the simulation's units; 0: it is left alone.
    void bound(double greatest_force) { options_.greatest_force = greatest_force; }
    /// A cycle of the servo, and what was felt of the spring; of two different cycles nothing is taken.
    /// `attach`: as in Spring.
    void feel(const Report& report, const std::optional<HandFeedback>& feedback, const Vec3& attach = {});
    /// A frame: the body is there. What to push it with from now on, in the simulation's units. `now`: s, of
    /// any clock that watch() is asked by as well. Throws knurl::Error for a place that is no number.
    Vec3 frame(const Vec3& body, double now);
    /// A frame that came with newer ones behind it: what was sent last acts on, and is not replaced for this.
    void superseded(const Vec3& body);
    /// To be called before each spring(), also while nothing is held: the spring's end then goes with the
    /// hand.
    State watch(double now);
    /// For Handle<Spring>::set.
    Spring spring() const;

    Vec3 to_hand(const Vec3& body) const;  // places
    Vec3 to_simulation(const Vec3& hand) const;
    /// Of the simulation's energy, force times length, in a joule of the hand's.
    double energy_scale() const { return 1 / (options_.scale.force * options_.scale.length); }

    const Account& account() const { return account_; }
    const Counts& counts() const { return counts_; }
    State state() const { return state_; }
    double interval() const { return frames_.interval(); }  // s between frames, usually
    double compliance() const { return compliance_; }       // m/N: how far a force moves the body in a frame

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
