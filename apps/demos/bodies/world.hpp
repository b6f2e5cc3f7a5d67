#pragma once
// A tray with rigid bodies, in Bullet. Metres, kilograms and seconds here. Bullet gets larger lengths, since
// its margins and thresholds suit things of half a metre, not of three centimetres.

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace bodies {

using Eigen::Quaterniond;
using Eigen::Vector3d;

struct Body {
    enum class Form { box, ball };
    std::string name;
    Form form = Form::box;
    Vector3d half = Vector3d::Constant(0.02);  // m, of a box; a ball's radius is half.x()
    double mass = 0.1;                         // kg
    Vector3d position = Vector3d::Zero();      // m
    double friction = 0.5;                     // Bullet multiplies it by the floor's, 1, or the other body's
};

struct Tray {
    double floor = -0.05;  // m, its height
    double reach = 0.11;   // m, from the middle to its four walls
};

struct Pose {
    Vector3d position = Vector3d::Zero();
    Quaterniond orientation = Quaterniond::Identity();
    bool is_one() const { return position.allFinite() && std::abs(orientation.norm() - 1) < 1e-3; }
    /// Within a tenth of a millimetre, and the corresponding angle at a body's edge.
    bool is_near(const Pose& other) const {
        return (position - other.position).norm() < 1e-4 &&
               orientation.angularDistance(other.orientation) < 5e-3;
    }
};

/// A force (N) at a point (m) of a body for the length of a step.
struct Push {
    std::size_t body = 0;
    Vector3d force = Vector3d::Zero(), point = Vector3d::Zero();
};

/// A spring and a damper from a point of a body to one that moves.
struct Pull {
    std::size_t body = 0;
    Vector3d on_body = Vector3d::Zero();                               // m, in its frame
    Vector3d towards = Vector3d::Zero(), velocity = Vector3d::Zero();  // m, m/s, when the step begins
    double stiffness = 0, damping = 0;                                 // N/m, N s/m
};

class World {
  public:
    /// Throws std::runtime_error for an invalid body.
    World(std::vector<Body> bodies, const Tray& tray = {}, double gravity = 9.81);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// One step of `dt` (s), in parts of 1/480 s at most, with these forces.
    void step(double dt, const std::vector<Push>& pushes, const std::vector<Pull>& pulls = {});

    /// Returns all bodies to their first places, at rest. Returns the energy that they gain (J).
    double reset();

    const std::vector<Body>& bodies() const { return bodies_; }
    const Tray& tray() const { return tray_; }
    double pulled() const { return pulled_; }  // J, that the pulls of the newest step gave to bodies
    std::uint64_t steps() const { return steps_; }
    double last_dt() const { return dt_; }                         // s
    Pose before(std::size_t body) const { return before_[body]; }  // the newest step
    Pose after(std::size_t body) const { return after_[body]; }
    /// In the newest step a point moved faster than any body does by itself: it has jumped.
    bool leapt(std::size_t body) const;
    /// The body for which the engine returned an invalid place. It stays at its last valid place, and further
    /// steps are meaningless.
    std::optional<std::size_t> lost() const { return lost_; }
    /// Simulates an engine error: sets the body's velocity (m/s).
    void kick(std::size_t body, const Vector3d& velocity);
    /// The velocity of the newest step, from `before` to `after`.
    Vector3d velocity(std::size_t body) const;          // m/s
    Vector3d angular_velocity(std::size_t body) const;  // rad/s
    /// Velocity of that point of the body at the end of the step (m/s).
    Vector3d speed_at(std::size_t body, const Vector3d& point) const;

    /// Speed per impulse at that point (m/s for 1 N s), including all that the body lies on and leans on,
    /// without friction: 0 for a box that is pressed on the floor.
    double mobility(std::size_t body, const Vector3d& point, const Vector3d& direction) const;
    /// The displacement in a step of `dt` (m for each N).
    double give(std::size_t body, const Vector3d& point, const Vector3d& direction, double dt) const;
    /// Of all bodies, kinetic and of height over the floor, after the newest step (J).
    double energy() const;
    /// Distance of the point from the body (m; below 0: inside), and the nearest point of its surface.
    double distance(std::size_t body, const Vector3d& point, Vector3d* nearest = nullptr) const;

  private:
    struct Engine;
    std::vector<Body> bodies_;
    Tray tray_;
    double gravity_, dt_ = 0, pulled_ = 0;
    std::uint64_t steps_ = 0;
    std::vector<Pose> first_, before_, after_;
    std::optional<std::size_t> lost_;
    std::unique_ptr<Engine> engine_;
};

/// Three boxes and a ball of 50 to 500 g.
std::vector<Body> usual_bodies();

/// The surface of a body about its middle, as triangles, outwards.
struct Skin {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};
Skin skin_of(const Body& body);

}  // namespace bodies
