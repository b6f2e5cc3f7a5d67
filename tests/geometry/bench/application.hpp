#pragma once
// An application with the same triangles. At 20 to 1000 Hz it sends the servo a plane or a cap for the
// hand's position, or for the predicted one (runtime/client's predict.hpp). Each update takes effect a whole
// period later, in the servo's scene with its cross-fade.

#include <memory>
#include <vector>

#include <knurl/client/predict.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/reps/scene.hpp>

#include "paths.hpp"

namespace knurl::test {

struct Local {
    bool cap = false;        // else a plane
    double rate = 20;        // Hz
    bool predicted = false;  // Knurl's follow()
};

/// An update, and the cycle from which on it is felt.
struct Said {
    std::size_t felt = 0;
    Faces faces;
};
std::vector<Said> said_along(const Hand& hand, const Mesh& mesh, const Local& how);

/// The servo's scene that receives the updates.
class LocalScene {
  public:
    static constexpr double stiffness = 1000;  // N/m
    static constexpr double period = 1e-3;     // s

    explicit LocalScene(const Local& how);
    void begin(const std::vector<Said>& said);
    /// The force, N, at the cycle after the last.
    Eigen::Vector3d next(const Eigen::Vector3d& hand);

  private:
    template <class R>
    void say(const Faces& faces);

    Local how_;
    Scene scene_;
    Probe probe_;
    const std::vector<Said>* said_ = nullptr;
    std::size_t next_ = 0, cycle_ = 0;
    std::uint32_t there_ = 0;  // representations that have been added
};

}  // namespace knurl::test
