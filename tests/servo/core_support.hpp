#pragma once
// An ordinary servo on the virtual clock, with a device that the test moves.

#include <gtest/gtest.h>

#include <knurl/servo/offline.hpp>

#include "puppet_device.hpp"

namespace knurl::servo::testing {

/// An ordinary servo (silence, ramps, supervisor), as knurld runs it, on the virtual clock.
inline ServoOptions live_options(double rate = 1000) {
    ServoOptions options;
    options.rate = rate;
    return options;
}

inline void run(Offline& servo, int cycles) {
    for (int i = 0; i < cycles; ++i) servo.step();
}

inline Eigen::Vector3d vec(const Vec3& v) {
    return to_eigen(v);
}

}  // namespace knurl::servo::testing
