#pragma once
// A device on the bench: cycles in which a trial says what it shall exert and sees what it does. Nothing is
// exerted when it runs away, nor afterwards.

#include <utility>
#include <vector>

#include <knurl/reps/wrench.hpp>
#include <knurl/servo/velocity.hpp>

#include "device_trial.hpp"

namespace knurl::cli {

/// What one cycle knows. Device frame.
struct Moment {
    double t = 0;  // s since this part began
    drivers::JointSample sample;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // of devices that sense it
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s, first order 100 Hz
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();       // rad/s, likewise
    drivers::ReadStatus status = drivers::ReadStatus::stale;
    double lateness = 0, transfer = 0;  // s; transfer is the last cycle's
};

/// The turn that takes a to b: its axis times its angle, rad.
Eigen::Vector3d turn_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

class Bench {
  public:
    Bench(drivers::Device& device, const TrialOptions& options);
    ~Bench();
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;

    /// Cycles for so long; `exert` says what the tip feels. It may end the part by returning false.
    template <class Exert>
    void run(double seconds, Exert exert) {
        const drivers::Nanoseconds begin = now_;
        const auto cycles = std::llround(seconds * options_.rate);
        for (long long i = 0; i < cycles; ++i) {
            const drivers::Nanoseconds before = next(begin);
            Wrench wanted;
            const bool go_on = exert(std::as_const(moment_), wanted);
            write(wanted, before);
            if (!go_on) return;
        }
    }
    /// As RestTrial::round_trip. Each is waited for, so that no answer is another order's.
    std::vector<double> round_trips(int count);
    /// Back to where it was at `home`, gently; at least for so long, and until it hardly moves.
    void settle(double seconds, const Moment& home);

    const Moment& moment() const { return moment_; }
    const drivers::LinkConfig& link() const { return device_.link(); }
    const TrialOptions& options() const { return options_; }
    bool known() const { return known_; }
    /// What one count of its coarsest joint is at the tip: m, rad.
    std::pair<double, double> resolution() const;

  private:
    drivers::Nanoseconds clock() const;
    double wait();
    void read();
    drivers::Nanoseconds next(drivers::Nanoseconds begin);  // waits and reads; returns when it began to read
    void write(const Wrench& wanted, drivers::Nanoseconds began);

    drivers::Device& device_;
    const TrialOptions& options_;
    drivers::Nanoseconds period_, now_;
    Moment moment_;
    drivers::TipPose pose_;
    drivers::Jacobian jacobian_ = drivers::Jacobian::Zero();
    servo::FirstOrderVelocity filter_{100}, turning_{100};
    bool known_ = false;
};

}  // namespace knurl::cli
