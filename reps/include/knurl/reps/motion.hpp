#pragma once

#include <cstdint>

namespace knurl {

/// Since when a surface moves on from where it was placed: it has gone velocity x time.
struct Motion {
    double time = 0;  // s
    // 1: it stays where it is in this cycle, as in the one that placed it. The scene says so, too, in a
    // silence through which it holds.
    std::uint64_t placed = 0;
};

/// A surface that is placed anew has not moved on yet.
inline void place(Motion& motion) noexcept {
    motion = {.time = 0, .placed = 1};
}

inline void move_on(Motion& motion, double dt) noexcept {
    if (!(dt > 0)) return;
    if (motion.placed == 0) motion.time += dt;
    motion.placed = 0;
}

}  // namespace knurl
