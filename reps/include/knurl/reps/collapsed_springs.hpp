#pragma once

/// @file
/// Many springs of one probe as one: with no rest length each is linear in the anchor and in the point where
/// it is attached, so their sum needs only sums made when they change. With o a local origin, a the anchors,
/// b the points on the probe, k:
///
///     K = sum k,  A = sum k (a - o),  B = sum k b,  M = sum k b (a - o)^T
///     F = A - K (p - o) - R B,   torque = axial(R M) - (R B) cross (p - o),   axial(x y^T) = x cross y

#include <array>
#include <cstdint>

#include <knurl/reps/probe.hpp>
#include <knurl/reps/spring.hpp>
#include <knurl/reps/wrench.hpp>

namespace knurl {

/// Many springs of one probe, evaluated as one. The head of this file has the formula.
class CollapsedSprings {
  public:
    /// True: this (prepared) spring can be one of them at the moment. It has no rest length and no damping,
    /// and nothing moves.
    static bool takes(const Spring& spring, const Spring::State& state) noexcept {
        return spring.rest_length == 0 && spring.damping == 0 && state.rest_length == 0 &&
               !(state.remaining > 0);
    }

    /// Removes all.
    void clear() noexcept { *this = {}; }
    /// Adds a prepared spring whose application's end is at `anchor_now` (m, world frame). `weight` (0 to 1)
    /// scales its stiffness.
    void add(const Spring& spring, const Vec3& anchor_now, double weight = 1) noexcept;
    /// How many there are.
    std::uint32_t count() const noexcept { return count_; }
    /// Sum K of their stiffnesses (N/m).
    double stiffness() const noexcept { return stiffness_; }

    /// Wrench about the probe's position; neither force nor torque is clamped.
    Wrench evaluate(const Probe& probe) const noexcept;
    /// True: some are attached elsewhere than at the probe's position.
    bool turns() const noexcept { return turns_; }

  private:
    double stiffness_ = 0;                                // N/m, K
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();    // m, the first anchor: coordinates stay small
    Eigen::Vector3d anchors_ = Eigen::Vector3d::Zero();   // N, A
    Eigen::Vector3d attached_ = Eigen::Vector3d::Zero();  // N, B, in the probe's frame
    std::array<Eigen::Vector3d, 3> moments_ = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                               Eigen::Vector3d::Zero()};  // N m, the columns of M
    std::uint32_t count_ = 0;
    bool turns_ = false;  // one of them is not attached at the probe's position
};

}  // namespace knurl
