#pragma once
// A device on the bench: cycles in which a trial gives the wrench and observes the motion. If the device runs
// away, the effort is zero from then on, and also after the end.

#include <utility>
#include <vector>

#include <knurl/reps/wrench.hpp>
#include <knurl/servo/velocity.hpp>

#include "device_trial.hpp"

namespace knurl::cli {

/// The state in one cycle. Device frame.
struct Moment {
    double t = 0;  // s since this part began
    drivers::JointSample sample;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // for devices that sense it
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s, first order 100 Hz
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();       // rad/s, likewise
    drivers::ReadStatus status = drivers::ReadStatus::stale;
    double lateness = 0, transfer = 0;  // s; transfer is the last cycle's
};

/// The rotation from a to b as a rotation vector, rad.
Eigen::Vector3d turn_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

class Bench {
  public:
    Bench(drivers::Device& device, const TrialOptions& options);
    ~Bench();
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;

    /// Runs cycles for so long; `exert` returns the wrench at the tip. It may end the part by returning
    /// false.
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
    /// As RestTrial::round_trip. Each answer is awaited, so that none belongs to another order.
    std::vector<double> round_trips(int count);
    /// Moves gently back to `home`; at least for so long, and until the tip hardly moves.
    void settle(double seconds, const Moment& home);

    const Moment& moment() const { return moment_; }
    const drivers::LinkConfig& link() const { return device_.link(); }
    const TrialOptions& options() const { return options_; }
    bool known() const { return known_; }
    /// The effect of one count of the coarsest joint at the tip: m, rad.
    std::pair<double, double> resolution() const;

  private:
    drivers::Nanoseconds clock() const;
    double wait();
    void read();
    drivers::Nanoseconds next(drivers::Nanoseconds begin);  // waits and reads; returns when the read began
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
