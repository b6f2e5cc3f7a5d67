#pragma once
// What stable means: one definition for every method, rate and device, in figures and thresholds.
//
//   jump   largest change of the force within 1 ms                              <= 1 N
//   rise   the same, where the force grew (as the paper reads it)               <= 1 N
//   kick   largest speed of the tip away from the true surface                  <= 0.3 m/s
//   cycle  half of peak to peak of its height in the last half second, at rest       <  0.1 mm
//   power  mean power that the force gave the hand from touch to end            <= 0.1 W
//
// Forces are the scene's, before actuators. Judged from 1 s (the first touch is over) to the end at 8 s.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "conditions.hpp"

namespace stability {

enum Criteria : unsigned { jump = 1, rise = 2, kick = 4, cycle = 8, power = 16 };
inline constexpr unsigned strict = jump | kick | cycle | power;
inline constexpr unsigned as_the_paper = rise;
inline constexpr unsigned every = jump | rise | kick | cycle | power;

struct Figures {
    double jump = 0, rise = 0;  // N
    double kick = 0;            // m/s
    double cycle = 0;           // m
    double power = 0;           // W
    double error = 0;  // N, root mean square of rendered - true force over the stroke; only where measured
    double peak = 0;   // N

    /// Criteria that these figures break.
    unsigned broken() const;
    void worst_of(const Figures& other);
};

class Judge {
  public:
    /// `measure`: also the force error, at `stiffness`, which needs the foot in every cycle.
    Judge(const Conditions& conditions, double stiffness, bool measure);

    /// One cycle of the servo: true position and velocity of the tip, the scene's force, and the work that
    /// the actuators have done since the start (J).
    void add(double t, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
             const Eigen::Vector3d& force, double work);
    /// A fault of the supervisor, or a surface that was never touched: nothing is stable after it.
    void fault();

    /// So far; `power` and `cycle` are known only at the end.
    const Figures& figures() const { return figures_; }
    Figures finish();

  private:
    const Conditions& conditions_;
    double stiffness_;
    bool measure_;
    Figures figures_;
    std::vector<Eigen::Vector3d> last_;  // forces of the last millisecond, a ring
    std::size_t next_ = 0, known_ = 0;
    double share_ = 1;  // of 1 ms that one step of the ring is worth
    double lowest_ = 0, highest_ = 0;
    bool resting_ = false, begun_ = false;
    double work_at_start_ = 0, work_ = 0;
    double squares_ = 0;
    std::size_t measured_ = 0;
};

}  // namespace stability
