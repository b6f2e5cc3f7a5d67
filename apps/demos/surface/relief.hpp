#pragma once
// Turns an elevation model into a relief under the hand: the scales, and the sentence that states them.

#include <optional>
#include <string>

#include "elevation.hpp"
#include "terrain.hpp"

namespace surface {

struct ReliefOptions {
    double cell = 0.5e-3;          // m in the hand's world per cell of the model
    double exaggeration = 2;       // of heights against the horizontal scale
    double smoothing = 3e-3;       // m in the hand's world, standard deviation of a Gaussian; 0: none
    double default_range = 10e-3;  // m from lowest to highest, for a model without a scale
    std::optional<double> metres_per_count = {}, metres_per_cell = {};  // override the file's
};

inline constexpr double greatest_range = 60e-3;  // m, largest height of a relief

struct Relief {
    HeightGrid grid;        // centred: the middle of its heights lies at z = 0
    std::string statement;  // "0.5 mm per cell of 83 m (1 : 166 062), heights x 2, ..."
};

/// z = elevation * (cell / metres per cell) * exaggeration. Throws std::runtime_error if the relief is flat,
/// or higher than `greatest_range`.
Relief make_relief(const ElevationModel& model, const ReliefOptions& options);

}  // namespace surface
