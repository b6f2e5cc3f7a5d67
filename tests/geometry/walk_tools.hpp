#pragma once
// A proxy on a mesh, of which every cycle is checked: all results are finite, and the work is within its
// limits.

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>
#include <knurl/geometry/proxy.hpp>

#include "generators.hpp"

namespace knurl::test {

inline Triangles view(const MadeMesh& shape) {
    return {.vertices = shape.vertices, .triangles = shape.triangles};
}
/// Without `unite` faces that cross are not cut, and the walk has to handle them.
inline std::unique_ptr<Mesh> build(const MadeMesh& shape, bool exact = true, bool unite = true) {
    return std::make_unique<Mesh>(view(shape),
                                  MeshBuild{.exact = exact, .budget = std::size_t{1} << 30, .unite = unite});
}

class Finger {
  public:
    explicit Finger(const Mesh& mesh, double radius = 0) : mesh_(&mesh), radius_(radius) {}

    /// Moves the hand there. True: the proxy touches.
    bool to(const Eigen::Vector3d& hand) {
        work = {};
        foot = {};
        const bool touches = follow(*mesh_, proxy, hand, radius_, foot, work);
        EXPECT_LE(work.faces, max_walk_faces);
        EXPECT_LE(work.nodes, max_nodes);
        EXPECT_LE(work.sweeps, max_sweeps);
        EXPECT_LE(work.pieces, max_sweeps * max_pieces);
        EXPECT_LE(work.fans, max_fans + max_fan);
        EXPECT_LE(work.tangles, max_tangles);
        if (touches) {
            EXPECT_TRUE(foot.point.allFinite() && foot.normal.allFinite());
            EXPECT_NEAR(foot.normal.norm(), 1, 1e-9);
            EXPECT_GE(foot.depth, 0);
            EXPECT_LT(foot.face, mesh_->faces());
        }
        return touches;
    }
    bool to(double x, double y, double z) { return to(Eigen::Vector3d(x, y, z)); }
    bool to(const std::array<double, 3>& p) { return to(Eigen::Vector3d(p[0], p[1], p[2])); }
    /// Moves in steps, the first of which ends one step after `from`.
    bool along(const Eigen::Vector3d& from, const Eigen::Vector3d& end, int steps) {
        bool touches = false;
        for (int i = 1; i <= steps; ++i) touches = to(from + (end - from) * (double(i) / steps));
        return touches;
    }

    Proxy proxy;
    Foot foot;
    Work work;

  private:
    const Mesh* mesh_;
    double radius_;
};

}  // namespace knurl::test
