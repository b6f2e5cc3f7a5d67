#pragma once
// A supervisor alone, over three straight axes.

#include <knurl/servo/supervisor.hpp>

#include "core_support.hpp"

namespace knurl::servo::testing {

struct Gate {
    static constexpr double dt = 1e-3;
    PuppetDevice device;
    SupervisorLimits limits;
    Supervisor supervisor{device.link_, limits};
    drivers::Jacobian jacobian = drivers::Jacobian::Identity();
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    int armed = 1;
    Supervised last;

    Gate() = default;
    explicit Gate(const SupervisorLimits& stated, const PuppetDevice& puppet = PuppetDevice())
        : device(puppet), limits(stated), supervisor(device.link_, limits) {}

    const Supervised& step(const Eigen::Vector3d& force = Eigen::Vector3d::Zero(),
                           const Eigen::Vector3d& torque = Eigen::Vector3d::Zero()) {
        last = supervisor.supervise({force, torque}, position, velocity, jacobian, 6, armed, dt);
        return last;
    }
    void steps(int n, const Eigen::Vector3d& force = Eigen::Vector3d::Zero()) {
        for (int i = 0; i < n; ++i) step(force);
    }
    /// Until it is in that state; fails the test after 10 s.
    void until(DeviceState state, const Eigen::Vector3d& force = Eigen::Vector3d::Zero()) {
        for (int i = 0; i < 10'000 && supervisor.state() != state; ++i) step(force);
        ASSERT_EQ(supervisor.state(), state);
    }
    /// Active, with that force reached within the slew gate.
    void activate(const Eigen::Vector3d& force = Eigen::Vector3d::Zero()) {
        ASSERT_EQ(supervisor.arm(true, 0), protocol::RefusalReason::none);
        until(DeviceState::active, force);
    }
};

inline bool zero(const Supervised& out) {
    for (const double effort : out.efforts)
        if (effort != 0) return false;
    return out.sent.force.isZero(0) && out.sent.torque.isZero(0);
}

}  // namespace knurl::servo::testing
