#pragma once
// How hard an atom may be pulled in a frame, before the next one shows the effect.

#include <cstddef>
#include <cstdint>
#include <limits>

namespace dock {

/// Two bounds. The simulation must not get too hot: a force does work on the way of a frame, and all of it
/// may become motion, 3/2 k for each atom. Half of the margin is kept, since the way is only an estimate. And
/// in a periodic box the way must stay recognisable: an atom that moves half an edge in a frame may as well
/// have moved the other way.
class PullBound {
  public:
    explicit PullBound(double greatest_temperature,
                       double box = std::numeric_limits<double>::infinity() /* A, its edge */)
        : greatest_(greatest_temperature), box_(box) {}
    void hold() { frames_ = 0; }  // another atom: nothing is known about it
    struct Frame {
        double temperature = 0;  // K; NaN: unknown, so no bound
        std::size_t atoms = 0;
        int steps = 1;      // to the next frame
        double way = 0;     // A for 1 kcal/mol/A in a frame, as measured
        double pushed = 0;  // kcal/mol/A: sent last, acts from now on
    };
    /// kcal/mol/A for the frame after the next.
    double force(const Frame& frame);

  private:
    double greatest_;           // K
    double box_;                // A
    std::uint64_t frames_ = 0;  // of this hold
    double usual_steps_ = 0;    // during the measurement of the way
};

}  // namespace dock
