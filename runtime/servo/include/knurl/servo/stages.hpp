#pragma once

/// @file
/// The stages of the supervisor that remember something between cycles. Each is a few numbers and one rule,
/// and can be tested against its closed form.

#include <array>
#include <cstddef>

#include <knurl/reps/wrench.hpp>

namespace knurl::servo {

/// Mean power over a sliding window, kept in 25 parts: exact to a part's length, and no running sum that
/// drifts.
class PowerMeter {
  public:
    /// `window`: its length (s).
    explicit PowerMeter(double window) noexcept : part_time_(window / static_cast<double>(parts)) {}

    /// Adds `work` (J) done in `dt` (s).
    void add(double work /* J */, double dt /* s */) noexcept;
    /// Mean power over the last whole parts (W).
    double mean() const noexcept { return mean_; }
    /// Forgets all.
    void reset() noexcept;

    /// What is remembered between cycles, for an input log's keyframe (state_words.hpp).
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(work_, next_, filling_work_, filling_time_, mean_);
        next_ %= parts;  // a file may say anything
    }

  private:
    static constexpr std::size_t parts = 25;
    double part_time_;
    std::array<double, parts> work_ = {};  // J
    std::size_t next_ = 0;
    double filling_work_ = 0, filling_time_ = 0;
    double mean_ = 0;
};

/// Work put into the hand since contact began: Hannaford & Ryu 2002, the observer alone. In contact = force
/// is sent.
class PassivityObserver {
  public:
    /// Adds the `work` (J) of the last cycle: sent force times displacement since then. `contact`: a force
    /// was being sent.
    void add(double work, bool contact) noexcept { work_ = contact ? work_ + work : 0; }
    /// Work put into the hand (J); 0 while the hand has paid for it.
    double generated() const noexcept { return work_ > 0 ? work_ : 0; }
    /// As of PowerMeter.
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(work_);
    }

  private:
    double work_ = 0;
};

/// Lets the wrench change by no more than slew x dt in a cycle: a fault gate far out of reach of contact.
class SlewGate {
  public:
    /// Largest rates of force (N/s) and torque (N m/s).
    SlewGate(double force_slew /* N/s */, double torque_slew /* N m/s */) noexcept
        : force_slew_(force_slew), torque_slew_(torque_slew) {}

    /// Clips the wrench; true: it changed it.
    bool clip(Wrench& wanted, double dt) noexcept;
    /// Time for which it has clipped in a row (s).
    double clipped_for() const noexcept { return clipped_for_; }
    /// The last wrench was zero.
    void restart_from_zero() noexcept;
    /// As of PowerMeter.
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(last_.force, last_.torque, clipped_for_);
    }

  private:
    double force_slew_, torque_slew_;
    Wrench last_;
    double clipped_for_ = 0;
};

/// I^2 t. heat' = ((F/continuous)^2 - heat)/tau, and heat stays at 1 or below: above `full_until` the allowed
/// force goes down from the peak towards the continuous force. tau is such that a cold motor may give the
/// peak for `time`: continuous^2/peak^2 = 1 - exp(-time/tau).
class ThermalLimit {
  public:
    /// Heat up to which the peak force is allowed (1).
    static constexpr double full_until = 0.9;

    /// Peak and continuous force (N), and how long a cold motor may give the peak (s).
    ThermalLimit(double peak, double continuous, double time) noexcept;
    /// Force that is allowed now (N).
    double allowed() const noexcept;
    /// Adds `dt` (s) of this force (N).
    void add(double force, double dt) noexcept;
    /// Heat, 0 to 1.
    double heat() const noexcept { return heat_; }
    /// Time constant tau (s).
    double time_constant() const noexcept { return tau_; }
    /// As of PowerMeter.
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(heat_);
    }

  private:
    double peak_, continuous_, tau_;
    double heat_ = 0;
};

}  // namespace knurl::servo
