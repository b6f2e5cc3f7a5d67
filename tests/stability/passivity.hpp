#pragma once
// Passivity observer and controller (Hannaford & Ryu, IEEE Trans. Robotics and Automation 18 (2002)), in
// series with the whole wrench: a method of this sweep, not of the servo.

#include <algorithm>

#include <Eigen/Core>

namespace stability {

class PassivityController {
  public:
    /// The force of this cycle, with a damper that removes the energy that the wall has given in excess.
    Eigen::Vector3d act(const Eigen::Vector3d& force, const Eigen::Vector3d& position, double dt) {
        constexpr double most = 0.5;       // kg: alpha <= most / dt
        constexpr double too_slow = 1e-3;  // m/s: below, the encoder says nothing about velocity
        if (!known_) last_position_ = position;
        known_ = true;
        const Eigen::Vector3d step = position - last_position_;
        last_position_ = position;
        energy_ -= last_force_.dot(step);
        if (force.isZero()) energy_ = std::max(energy_, 0.0);  // out of contact there is no debt
        last_force_ = force;
        const Eigen::Vector3d velocity = step / dt;
        if (energy_ < 0 && velocity.norm() > too_slow)
            last_force_ -= std::min(-energy_ / (velocity.squaredNorm() * dt), most / dt) * velocity;
        return last_force_;
    }

  private:
    double energy_ = 0;  // J taken from the hand; negative: given to it
    Eigen::Vector3d last_force_ = Eigen::Vector3d::Zero(), last_position_ = Eigen::Vector3d::Zero();
    bool known_ = false;
};

}  // namespace stability
