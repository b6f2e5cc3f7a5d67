#include "application.hpp"

#include <algorithm>

namespace stability {

using Eigen::Vector3d;

Application::Application(const Conditions& conditions, double stiffness, double phase)
    : conditions_(conditions),
      stiffness_(stiffness),
      model_([&ridge = conditions.ridge](const knurl::Vec3& near) {
          const Ridge::Foot foot = ridge.foot(knurl::to_eigen(near));
          return knurl::SurfacePoint{.foot = knurl::to_plain(foot.point),
                                     .normal = knurl::to_plain(foot.normal),
                                     .curvature = foot.curvature,
                                     .axis = {foot.normal.z(), 0, -foot.normal.x()}};
      }),
      next_read_(conditions.rate_is_servos ? 0 : phase * conditions.interval()) {}

Answer Application::first(const Vector3d& p) {
    return solve(0, p, Vector3d::Zero());
}

void Application::read(double t, const Vector3d& p, const Vector3d& slow_velocity) {
    if (under_way_ || t + 1e-9 < next_read_) return;
    answer_ = solve(t, p, slow_velocity);
    next_read_ += conditions_.rate_is_servos ? conditions_.period() : conditions_.interval();
    due_ = t + conditions_.answer;
    under_way_ = true;
}

bool Application::due(double t) {
    if (!under_way_ || t + 1e-9 < due_) return false;
    under_way_ = false;
    return true;
}

Answer Application::solve(double t, const Vector3d& p, const Vector3d& velocity) {
    const Method& method = conditions_.method;
    if (method.kind == Method::Kind::force) {
        const Ridge::Foot foot = conditions_.ridge.foot(p);
        const double size = std::min(stiffness_ * std::max(0.0, -foot.height), conditions_.peak_force);
        return knurl::ConstantForce{.force = knurl::to_plain(size * foot.normal),
                                    .recovery = method.recovery};
    }
    knurl::Cap cap{
        .stiffness = stiffness_, .damping = conditions_.virtual_damping, .recovery = method.recovery};
    knurl::Plane plane{.stiffness = stiffness_,
                       .damping = conditions_.virtual_damping,
                       .recovery = method.recovery,
                       .update = method.update};
    const bool curved = method.kind == Method::Kind::cap;
    knurl::SurfacePoint face = model_(knurl::to_plain(p));
    if (method.predicted) {
        // The first cycle that evaluates an answer is the next one after it came.
        const double latency = std::max(conditions_.answer, conditions_.period());
        const knurl::HandNow hand{
            .time = t, .position = knurl::to_plain(p), .velocity = knurl::to_plain(velocity)};
        face = knurl::follow_surface(model_, hand, {.latency = latency, .interval = conditions_.interval()},
                                     {.stiffness = stiffness_, .rim = curved ? cap.rim : 0}, memory_)
                   .faces.face[0];
    }
    knurl::place(cap, face);
    knurl::place(plane, face);
    return curved ? Answer(cap) : Answer(plane);
}

}  // namespace stability
