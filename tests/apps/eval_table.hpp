#pragma once
// `knurl eval` as a function: a scene and a motion in, forces out.

#include <array>
#include <string>
#include <vector>

#include "program.hpp"

namespace knurl::test {

struct Row {
    double t = 0;
    std::array<double, 3> x = {}, f = {}, torque = {}, p = {};
};

struct Evaluated {
    std::vector<Row> rows;
    std::string csv;      // as written
    std::string remarks;  // standard error
};

/// Fails the test if the program fails.
Evaluated eval(const std::string& scene, const std::string& motion,
               const std::vector<std::string>& more = {});

/// The probe rests at (0, 0, z) for `seconds`.
std::string rest_at(double z, double seconds);
/// The probe goes straight from (0, 0, z0) to (0, 0, z1) in `seconds`.
std::string press(double z0, double z1, double seconds);

}  // namespace knurl::test
