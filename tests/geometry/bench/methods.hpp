#pragma once
// Methods to render one relief for one hand, cycle by cycle. Each has its own state, as the servo would keep
// it.

#include <memory>
#include <string>
#include <vector>

#include "application.hpp"
#include "relief.hpp"

namespace knurl::test {

/// What holds the hand back, or the hand itself.
struct ProxyPoint {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    bool touches = false;
};

class Method {
  public:
    explicit Method(std::string called) : name(std::move(called)) {}
    virtual ~Method() = default;
    /// Begins a new hand, of that number.
    virtual void begin(std::size_t hand, const Eigen::Vector3d& first) = 0;
    virtual ProxyPoint step(const Eigen::Vector3d& hand) = 0;

    std::string name;
    double rate = 0;         // Hz, of the application; 0: there is none
    bool predicted = false;  // by Knurl's client library
};

/// One relief in all forms that the methods need.
struct Shapes {
    explicit Shapes(const Relief& relief);
    Mesh mesh;
    HeightField field;
};

using Methods = std::vector<std::unique_ptr<Method>>;
/// The walk and the active set.
Methods walkers(const Shapes& shapes);
/// The walk, the active set, the height field and, if it was found at build time, Embree.
Methods whole_surfaces(const Relief& relief, const Shapes& shapes);
/// The servo's scene with the mesh; and with planes and caps that are sent at 20, 60, 200 and 1000 Hz, with
/// and without prediction. The application's updates are computed here.
Methods in_a_scene(const Shapes& shapes, const std::vector<Hand>& hands);

}  // namespace knurl::test
