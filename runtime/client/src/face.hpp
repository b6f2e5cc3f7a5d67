#pragma once
// One answer of a model, as the servo would render it.

#include <vector>

#include <knurl/client/predict.hpp>

namespace knurl::detail {

class Face {
  public:
    /// A rim of 0 gives the tangent plane. The point must be valid; its normal may have any length.
    Face(const SurfacePoint& point, double rim);

    const SurfacePoint& point() const { return point_; }  // unit normal
    Eigen::Vector3d foot() const { return to_eigen(cap_.foot); }
    Eigen::Vector3d normal() const { return to_eigen(cap_.normal); }
    /// m, signed: as the servo's own function computes it.
    double height(const Eigen::Vector3d& at) const;

  private:
    SurfacePoint point_;
    Cap cap_;
};

/// Queries a model point by point and keeps its answers.
class Questions {
  public:
    /// `metre`: a metre of the device in the model's world.
    Questions(const SurfaceModel& model, double rim, double metre = 1)
        : model_(model), rim_(rim), metre_(metre) {}

    /// Throws knurl::Error if the model's answer is not a valid face.
    Face ask(const Eigen::Vector3d& point);
    /// The same at a place where the hand is but will not be; not kept among the answers.
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

/// 1/m: the largest curvature that the model states, or that the turn of the normals between answers shows.
/// Turns from one of the sent faces to another do not count.
double sharpest(const std::vector<Face>& answers, const std::vector<Face>& sent, double metre);

}  // namespace knurl::detail
