#include <utility>

#include <Eigen/Eigenvalues>

#include <knurl/client/predict.hpp>

namespace knurl {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double edge = 0.3;      // rad between two normals
constexpr double shortest = 0.2;  // share of a step by which the foot must move with the query

}  // namespace

SurfaceModel curved(SurfaceModel model, double step) {
    return [model = std::move(model), step](const Vec3& near) {
        SurfacePoint point = model(near);
        const Vector3d foot = to_eigen(point.foot), normal = to_eigen(point.normal).normalized();
        const Vector3d a = normal.unitOrthogonal(), b = normal.cross(a);
        // The change of the normal along the surface: dn = -S ds, S symmetric, its eigenvalues the principal
        // curvatures (do Carmo, Differential Geometry of Curves and Surfaces, 3-2; here a hollow is
        // positive).
        Matrix2d turning;
        for (int i = 0; i < 2; ++i) {
            const Vector3d along = i == 0 ? a : b;
            const SurfacePoint beside = model(to_plain(foot + step * along));
            const Vector3d turn = to_eigen(beside.normal).normalized() - normal;
            const double way = along.dot(to_eigen(beside.foot) - foot);
            if (!(way > shortest * step && turn.norm() < edge)) return point;
            turning.col(i) = -Vector2d(a.dot(turn), b.dot(turn)) / way;
        }
        const Eigen::SelfAdjointEigenSolver<Matrix2d> principal(0.5 * (turning + turning.transpose()));
        const Vector2d first = principal.eigenvectors().col(0);
        point.curvature = principal.eigenvalues()[0];
        point.curvature2 = principal.eigenvalues()[1];
        point.axis = to_plain(first.x() * a + first.y() * b);
        return point;
    };
}

}  // namespace knurl
