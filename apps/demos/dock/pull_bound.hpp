#pragma once
// How hard an atom may be pulled in a frame, before the next one says what became of it.

#include <cstddef>
#include <cstdint>
#include <limits>

namespace dock {

/// So hard that the simulation does not get too hot: a force does its own work on the way that it makes in a
/// frame, and all of that may become motion, 3/2 k for each atom. Half of what there is room for is kept: the
/// way is learnt, and another one next time. And so hard that one can tell where the atom went: in a periodic
/// box, one that goes half an edge in a frame may as well have gone the other way.
class PullBound {
  public:
    explicit PullBound(double greatest_temperature,
                       double box = std::numeric_limits<double>::infinity() /* A, its edge */)
        : greatest_(greatest_temperature), box_(box) {}
    void hold() { frames_ = 0; }  // another atom: nothing is known of it
    struct Frame {
        double temperature = 0;  // K; NaN: not told, so it bounds nothing
        std::size_t atoms = 0;
        int steps = 1;      // to the next frame
        double way = 0;     // A for 1 kcal/mol/A in a frame, as learnt from those before
        double pushed = 0;  // kcal/mol/A: sent last, acts from now on
    };
    /// kcal/mol/A for the frame after the next.
    double force(const Frame& frame);

  private:
    double greatest_;           // K
    double box_;                // A
    std::uint64_t frames_ = 0;  // of this hold
    double usual_steps_ = 0;    // while the way was learnt
};

}  // namespace dock
