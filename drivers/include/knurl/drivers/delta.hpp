#pragma once

/// @file
/// Stamper's delta: three legs that let a platform slide along x, y and z but never turn (Novint Falcon).

#include <array>
#include <numbers>

#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// Figures of the mechanism, in the letters of R. E. Stamper, "A Three Degree of Freedom Parallel Manipulator
/// with Only Translational Degrees of Freedom", University of Maryland 1997. Leg i stands in a plane turned
/// by leg[i] about z; in it u points outwards, w along z, and v across. Each crank of length a turns by theta
/// from u towards w; at its end hangs a parallelogram of length b between two bars of length d and e.
struct DeltaTable {
    /// Where each leg stands about z (rad).
    std::array<double, 3> leg = {};
    /// From the base's centre to a crank's axis, along u (m).
    double r = 0;
    /// From the base's centre to a crank's axis, along v (m).
    double s = 0;
    /// Length of the crank (m).
    double a = 0;
    /// Length of the parallelogram (m).
    double b = 0;
    /// From the platform's centre to a leg's end, along u (m).
    double c = 0;
    /// Length of one bar between the parallelogram and its hinge (m).
    double d = 0;
    /// Length of the other bar between the parallelogram and its hinge (m).
    double e = 0;
    /// From the platform's centre to a leg's end, along v (m).
    double f = 0;
    /// The delta's own frame in the device frame.
    Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
};

/// The Novint Falcon. Its own frame (base at the identity): z points from its body to the hand and is 0.125 m
/// in the middle of its workspace, y up. Figures as in libnifalcon's kinematics; nothing was measured here.
inline DeltaTable falcon_delta() {
    constexpr double degrees = std::numbers::pi / 180;
    return {.leg = {105 * degrees, -15 * degrees, -135 * degrees},
            .r = 0.040,
            .s = -0.02309,
            .a = 0.060,
            .b = 0.1025,
            .c = 0.01443,
            .d = 0.01125,
            .e = 0.01125,
            .f = -0.025};
}
/// z of the middle of the Falcon's workspace in its own frame (m).
inline constexpr double falcon_centre = 0.125;
/// The same in the frame of the device, real or simulated: origin in the middle of its workspace, x from its
/// body to the hand, z up.
inline DeltaTable falcon_in_device_frame() {
    DeltaTable table = falcon_delta();
    table.base.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    table.base.translation() = -falcon_centre * Eigen::Vector3d::UnitX();
    return table;
}
/// Radians per count of the Falcon's encoders: 320 lines x 4, geared by 0.110 m / 0.01425 m.
inline constexpr double falcon_radians_per_count = 2 * std::numbers::pi / (320 * 4) * 0.01425 / 0.110;
/// Angle of a homed axis at count 0 (rad).
inline constexpr double falcon_zero = 35 * std::numbers::pi / 180;

/// Joints are the three cranks' angles theta. With h = sqrt(b^2 - v^2) and L = d + e + h, a leg is closed
/// where
///     (u - a cos theta)^2 + (w - a sin theta)^2 = L^2,
/// so that the platform lies on three tori. That has no closed form to solve for the platform. With v small
/// beside b they are nearly spheres of radius b + d + e, and those have one: it is off by 1 mm as a mean
/// and 3 mm at most over the Falcon's workspace. `forward` begins there and takes Newton steps, two or three
/// until nothing changes and one evaluation more for the Jacobian: no memory of the pose before, so the same
/// joints give the same bits, and it cannot drift into the mechanism's other assembly. drivers/README.md
/// compares it with starts from the last pose.
class Delta final : public Mechanism {
  public:
    /// Most Newton steps; the worst seen are 4.
    static constexpr int most_steps = 8;
    /// A shorter step ends the iteration, as a share of b + d + e (1).
    static constexpr double enough = 1e-13;
    /// Least |n1||n2||n3| (1); below it "the legs do not hold the platform".
    static constexpr double singular = 1e-3;

    /// Throws std::runtime_error: lengths that are not finite, not positive (a, b) or longer than 10 m, two
    /// legs at the same angle.
    explicit Delta(const DeltaTable& table);

    /// Three.
    int joints() const noexcept override { return 3; }

    /// False if a joint is not finite, the legs do not meet, or they do not hold the platform (singular).
    bool forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept override;

    /// The cranks that bring the platform to a position in the device frame (m), each bent outwards. False,
    /// and joints as they were, if a leg does not reach. Closed form, Stamper section 3.
    bool inverse(const Eigen::Vector3d& position, std::span<double, 3> joints) const noexcept;

    /// a (cos theta, sin theta) of each leg (m).
    using Cranks = std::array<Eigen::Vector2d, 3>;
    /// The cranks' ends. This and the following are the parts of `forward`, to compare them; positions are in
    /// the delta's own frame.
    Cranks cranks(std::span<const double, 3> joints) const noexcept;
    /// Where three spheres of radius b + d + e about the cranks' ends meet; if they do not, the point nearest
    /// to it in their plane of symmetry. Closed form.
    Eigen::Vector3d three_spheres(const Cranks& ends) const noexcept;
    /// One Newton step from `position`: what is to be added to it, and J = d(position)/d(theta) there. False
    /// if a leg is not defined there or the three do not hold the platform.
    bool step(const Cranks& ends, const Eigen::Vector3d& position, Eigen::Vector3d& change,
              Eigen::Matrix3d& jacobian) const noexcept;

  private:
    struct Leg {
        double cosine, sine;  // of its angle about z
    };
    double a_, b_, bars_, enough_;  // m; bars_ = d + e; enough_ the step that ends it
    double outwards_, across_;      // m, c - r and f - s: only these differences matter
    double side_;                   // +1 or -1: on which side of the cranks' ends the platform hangs
    std::array<Leg, 3> legs_;
    Eigen::Matrix3d base_rotation_;
    Eigen::Vector3d base_position_;
};

}  // namespace knurl::drivers
