#pragma once

#include <cstdint>

namespace knurl {

/// Since when a surface moves on from where it was placed: it has gone velocity x time.
struct Motion {
    double time = 0;           // s
    std::uint64_t placed = 0;  // 1: in the cycle that placed it, where it is as it was said to be
};

}  // namespace knurl
