#pragma once
// Run time against error of the delta's forward solution: its start, the number of Newton steps, and the
// speed of the hand.

#include <string>
#include <vector>

namespace knurl::drivers {

struct DeltaPoint {
    static constexpr int until_settled = -1;  // `steps`: until nothing changes
    std::string start;                        // "three spheres", "last pose", "last pose moved on", "centre"
    double speed = 0;                         // m/s of the hand, at 1 kHz
    int steps = 0;                            // of Newton's method; 0: the start is the answer
    double ns = 0;                            // a call with the Jacobian, median of interleaved blocks
    double worst = 0, median = 0;             // m, error of the position
    bool knurl = false;                       // what Delta::forward does
};

std::vector<DeltaPoint> delta_run_time_against_error();

}  // namespace knurl::drivers
