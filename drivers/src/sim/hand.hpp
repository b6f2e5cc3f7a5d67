#pragma once
// The simulated hand: its wanted place, and the force that it exerts to get there.

#include <array>
#include <cstdint>
#include <optional>

#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

struct HandForce {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N on the tip
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m
};

class Hand {
  public:
    /// `rest`: its place without a motion; with a motion it rests at the motion's first row.
    Hand(const SimHand& figures, std::optional<Motion> motion, const MotionSample& rest, std::uint64_t seed);

    void begin(double t) noexcept;  // s: the motion plays from its start
    void rest(double t) noexcept;   // back to the start, if it is not there

    /// Its wanted place at t; times must not go back.
    MotionSample wanted(double t) noexcept;
    HandForce force(double t, const MotionSample& wanted, const MotionSample& tip) const noexcept;

    void set_grip(double grip) noexcept { figures_.grip = grip; }
    double grip() const noexcept { return figures_.grip; }

  private:
    static constexpr int tremor_tones = 3;
    struct Tone {
        double frequency, phase;  // rad/s, rad
    };

    void leave_from(const MotionSample& here) noexcept;
    double push_level(double t) const noexcept;

    SimHand figures_;
    std::optional<Motion> motion_;
    MotionSample rest_;
    bool plays_ = false;
    double changed_at_ = 0;   // s, of the last begin or rest
    double push_before_ = 0;  // push level at that time
    std::size_t hint_ = 0;
    // The remaining offset to its place at the last change: fades over return_time.
    Eigen::Vector3d away_ = Eigen::Vector3d::Zero();    // m
    Eigen::Vector3d turned_ = Eigen::Vector3d::Zero();  // rad, rotation vector
    std::array<std::array<Tone, tremor_tones>, 3> tremor_;
};

}  // namespace knurl::drivers
