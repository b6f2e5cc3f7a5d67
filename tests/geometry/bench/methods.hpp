#pragma once
// Ways to feel one relief under one hand, cycle by cycle: each from its own state, as the servo would keep
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
    /// A new hand, that of this number.
    virtual void begin(std::size_t hand, const Eigen::Vector3d& first) = 0;
    virtual ProxyPoint step(const Eigen::Vector3d& hand) = 0;

    std::string name;
    double rate = 0;         // Hz, of the application; 0: none is asked
    bool predicted = false;  // by Knurl's client library
};

/// One relief, in all the forms that it is asked in.
struct Shapes {
    explicit Shapes(const Relief& relief);
    Mesh mesh;
    HeightField field;
};

using Methods = std::vector<std::unique_ptr<Method>>;
/// The walk and the active set.
Methods walkers(const Shapes& shapes);
/// Those, the height field and, where it was there to be built with, Embree.
Methods whole_surfaces(const Relief& relief, const Shapes& shapes);
/// What the servo's scene makes of the mesh; and of planes and caps told at 20, 60, 200 and 1000 Hz,
/// predicted and not. What the application says is computed here.
Methods in_a_scene(const Shapes& shapes, const std::vector<Hand>& hands);

}  // namespace knurl::test
