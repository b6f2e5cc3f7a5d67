#pragma once
// One answer of a model as the servo would feel it.

#include <vector>

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

/// A model asked point by point.
class Questions {
  public:
    /// A metre of the device is `metre` in the model's world.
    Questions(const SurfaceModel& model, double rim, double metre = 1)
        : model_(model), rim_(rim), metre_(metre) {}

    /// Throws knurl::Error if the model answers with what is no face.
    Face ask(const Eigen::Vector3d& point);
    /// The same, of a place where the hand is and will not be: not among the answers.
    Face ask_aside(const Eigen::Vector3d& point);

    const std::vector<Face>& answers() const { return answers_; }
    std::uint32_t asked() const { return asked_; }
    double metre() const { return metre_; }

  private:
    const SurfaceModel& model_;
    double rim_, metre_;
    std::uint32_t asked_ = 0;
    std::vector<Face> answers_;
};

/// 1/m: the largest curvature that a model told, or that its normals tell by turning from the first answer
/// to another; but not on the way from one of the faces that are sent to another of them.
double sharpest(const std::vector<Face>& answers, const std::vector<Face>& sent, double metre);

}  // namespace knurl::detail
