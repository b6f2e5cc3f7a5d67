#pragma once
// The path of a simulated hand around an unknown thing: three times around it, in three planes through its
// middle, pressing.

#include <string>
#include <vector>

#include <Eigen/Core>

#include <knurl/geometry/mesh.hpp>

namespace feel {

struct StrokeOptions {
    double speed = 0.1;       // m/s
    double press = 6e-3;      // m, below the smoothed outline
    double clearance = 0.01;  // m, height from which it comes down
};

struct Row {
    double t = 0;                                        // s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, the mesh's frame
};

std::vector<Row> make_stroke(const knurl::Mesh& mesh, const StrokeOptions& options);

/// `t,x,y,z`, moved by `offset` (m): as `knurld --hand` plays it.
void write_stroke(const std::string& path, const std::vector<Row>& rows, const Eigen::Vector3d& offset);

}  // namespace feel
