#pragma once

#include <cstdint>

namespace knurl {

/// Since when a surface moves on from where it was placed: it has gone velocity x time.
struct Motion {
    /// Time for which it has moved on (s).
    double time = 0;
    /// 1: it stays where it is in this cycle, as in the one that placed it. The scene sets it, too, in a
    /// silence through which the surface holds.
    std::uint64_t placed = 0;
};

/// A surface that is placed anew has not moved on yet.
inline void place(Motion& motion) noexcept {
    motion = {.time = 0, .placed = 1};
}

/// Advances by `dt` (s); 0: no change.
inline void move_on(Motion& motion, double dt) noexcept {
    if (!(dt > 0)) return;
    if (motion.placed == 0) motion.time += dt;
    motion.placed = 0;
}

}  // namespace knurl
