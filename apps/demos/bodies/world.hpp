#pragma once
// A tray with rigid bodies in it, in Bullet. Metres, kilograms and seconds here; Bullet sees everything
// larger, since its margins and thresholds are made for things of half a metre, not of three centimetres.

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
    double friction = 0.5;  // Bullet multiplies it by that of the floor, 1, or of the other body
};

struct Tray {
    double floor = -0.05;  // m, its height
    double reach = 0.11;   // m, from the middle to its four walls
};

struct Pose {
    Vector3d position = Vector3d::Zero();
    Quaterniond orientation = Quaterniond::Identity();
    bool is_one() const { return position.allFinite() && std::abs(orientation.norm() - 1) < 1e-3; }
    /// Within a tenth of a millimetre and what that is at a body's edge.
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
    /// Throws std::runtime_error for a body that makes no sense.
    World(std::vector<Body> bodies, const Tray& tray = {}, double gravity = 9.81);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// One step of `dt` (s), in parts of 1/480 s at most, with these forces.
    void step(double dt, const std::vector<Push>& pushes, const std::vector<Pull>& pulls = {});

    /// All is where it was at first, at rest. The energy that this gave them (J).
    double reset();

    const std::vector<Body>& bodies() const { return bodies_; }
    const Tray& tray() const { return tray_; }
    double pulled() const { return pulled_; }  // J, given to bodies by the pulls of the newest step
    std::uint64_t steps() const { return steps_; }
    double last_dt() const { return dt_; }                         // s
    Pose before(std::size_t body) const { return before_[body]; }  // the newest step
    Pose after(std::size_t body) const { return after_[body]; }
    /// The newest step took a point of it faster than anything goes here by itself: it has jumped.
    bool leapt(std::size_t body) const;
    /// Of which the engine said a place that is no number: it stays where it was before that, and no step
    /// after it means anything.
    std::optional<std::size_t> lost() const { return lost_; }
    /// As if something in the engine had gone wrong: that is its velocity now (m/s).
    void kick(std::size_t body, const Vector3d& velocity);
    /// With which the newest step took it from `before` to `after`.
    Vector3d velocity(std::size_t body) const;          // m/s
    Vector3d angular_velocity(std::size_t body) const;  // rad/s
    /// Of that point of the body at the end of the step (m/s).
    Vector3d speed_at(std::size_t body, const Vector3d& point) const;

    /// How much faster a unit of impulse at that point makes that point (m/s for 1 N s), with what the body
    /// lies on and leans on, all of it without friction: 0 for a box that is pressed on the floor.
    double mobility(std::size_t body, const Vector3d& point, const Vector3d& direction) const;
    /// How far that goes in a step of `dt` (m for each N).
    double give(std::size_t body, const Vector3d& point, const Vector3d& direction, double dt) const;
    /// Of all bodies, kinetic and of height over the floor, after the newest step (J).
    double energy() const;
    /// How far outside of the body that point is (m; below 0: inside), and where the nearest point of its
    /// surface.
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
