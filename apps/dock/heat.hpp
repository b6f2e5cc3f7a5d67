#pragma once
// How hard an atom may be pulled so that the simulation is not too hot before the force can be changed.

#include <cstddef>
#include <cstdint>

namespace dock {

/// A force does its own work on the way that it makes in a frame, and all of that may become motion, 3/2 k
/// for each atom. Half of what there is room for is kept: the way is learnt, and another one next time.
class HeatBound {
  public:
    explicit HeatBound(double greatest_temperature) : greatest_(greatest_temperature) {}
    void hold() { frames_ = 0; }  // another atom: nothing is known of it
    struct Frame {
        double temperature = 0;  // K
        std::size_t atoms = 0;
        int steps = 1;      // to the next frame
        double way = 0;     // A for 1 kcal/mol/A in a frame, as learnt from those before
        double pushed = 0;  // kcal/mol/A: sent last, acts from now on
    };
    /// kcal/mol/A for the frame after the next.
    double force(const Frame& frame);

  private:
    double greatest_;           // K
    std::uint64_t frames_ = 0;  // of this hold
    double usual_steps_ = 0;    // while the way was learnt
};

}  // namespace dock
