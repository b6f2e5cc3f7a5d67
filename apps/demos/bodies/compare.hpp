#pragma once
// How stiff a contact with a simulated body may be before it shakes: with the force computed in the engine's
// own loop and sent, as it is usually done, and with the body's surface felt at the servo's rate.

#include <string>
#include <vector>

namespace bodies {

struct Stiffest {
    /// N/m, the stiffest wish that is stable, and what was felt of it, as a mean; 0: none.
    struct Surface {
        double wish = 0, felt = 0;
    };
    std::string what;    // is done to which body
    double in_loop = 0;  // N/m
    Surface as_wished, held_to;
    double most = 0;  // N/m, the stiffest that was tried
};

/// At so many frames a second, on the virtual clock: twice the same. As_wished: surfaces as stiff as wished;
/// held_to: as the program does it, no stiffer than the body admits (TouchOptions::softness).
std::vector<Stiffest> compare(double rate);

}  // namespace bodies
