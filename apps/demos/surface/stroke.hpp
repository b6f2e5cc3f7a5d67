#pragma once
// Where the simulated hand wants to go: down onto the relief, to and fro over its ridges and valleys, and a
// rest.
//
//        north
//     ,----------->.      five rows, joined by half circles, at constant speed; the path runs `press` below
//     `<-----------'      the relief's broad shape, so that the hand's spring towards it presses on the surface
//     ,----------->.

#include <filesystem>
#include <vector>

#include "terrain.hpp"

namespace surface {

struct StrokeOptions {
    double speed = 0.10;         // m/s
    double press = 9e-3;         // m below the broad shape: 1.8 N with a hand of 200 N/m
    double half_width = 60e-3;   // m along x, from the middle to a row's end; smaller on a smaller relief
    double half_length = 40e-3;  // m along y, from the middle to the first row
    int rows = 5;
    double approach = 0.6;    // s from `clearance` above the surface down to the path
    double clearance = 5e-3;  // m
    double speed_up = 0.2;    // s for acceleration, and for deceleration
    double rest = 1.0;        // s at the end, pressing
    double step = 5e-3;       // s between rows of the file
    double breadth = 8e-3;    // m, standard deviation of the Gaussian that gives the broad shape
};

struct Stroke {
    struct Row {
        double t = 0;                                        // s
        Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, the hand's world
    };
    std::vector<Row> rows;
    double begin = 0;    // s, end of the approach
    double rest_at = 0;  // s, start of the rest
    double end = 0;      // s
};

Stroke make_stroke(const Terrain& terrain, const StrokeOptions& options);

/// `t,x,y,z` in s and m, as `knurld --hand` plays it. Throws std::runtime_error if the file cannot be
/// written.
void write_stroke(const Stroke& stroke, const std::filesystem::path& file);

}  // namespace surface
