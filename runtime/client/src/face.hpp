#pragma once
// One answer of a model as the servo would feel it.

#include <knurl/client/predict.hpp>

namespace knurl::detail {

class Face {
  public:
    /// With a rim of 0 the tangent plane. The point is a legal one, its normal of any length.
    Face(const SurfacePoint& point, double rim);

    const SurfacePoint& point() const { return point_; }  // unit normal
    Eigen::Vector3d foot() const { return to_eigen(cap_.foot); }
    Eigen::Vector3d normal() const { return to_eigen(cap_.normal); }
    /// m, signed: as the servo's own function has it.
    double height(const Eigen::Vector3d& at) const;

  private:
    SurfacePoint point_;
    Cap cap_;
};

/// A model asked point by point, and what its answers say about how sharply the surface curves.
class Questions {
  public:
    Questions(const SurfaceModel& model, double rim) : model_(model), rim_(rim) {}

    /// Throws knurl::Error if the model answers with what is no face.
    Face ask(const Eigen::Vector3d& point);
    std::uint32_t asked() const { return asked_; }
    /// 1/m: the largest that the model told, or that the normals of its answers tell.
    double sharpest() const { return sharpest_; }

  private:
    const SurfaceModel& model_;
    double rim_;
    std::uint32_t asked_ = 0;
    double sharpest_ = 0;
    Eigen::Vector3d first_foot_ = Eigen::Vector3d::Zero(), first_normal_ = Eigen::Vector3d::Zero();
};

}  // namespace knurl::detail
