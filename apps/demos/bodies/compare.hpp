#pragma once
// How stiff a contact with a simulated body may be before it shakes. Compares the usual way, with the force
// computed in the engine's own loop, with a surface that the servo renders at its own rate.

#include <string>
#include <vector>

namespace bodies {

struct Stiffest {
    /// N/m: the largest requested stiffness that is stable, and the mean measured stiffness then; 0: none.
    struct Surface {
        double wish = 0, felt = 0;
    };
    std::string what;    // what is done to which body
    double in_loop = 0;  // N/m
    Surface as_wished, held_to;
    double most = 0;  // N/m, the largest stiffness that was tried
};

/// At this frame rate, on the virtual clock, so results are reproducible. as_wished: surfaces of the
/// requested stiffness; held_to: as in the program, no stiffer than the body admits (TouchOptions::softness).
std::vector<Stiffest> compare(double rate);

}  // namespace bodies
