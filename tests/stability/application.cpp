#include "application.hpp"

#include <algorithm>

namespace stability {

using Eigen::Vector3d;

namespace {

constexpr knurl::SurfacePoint nowhere{.foot = {0, 0, -1e6}, .normal = {0, 0, 1}};  // all are above it

}  // namespace

Application::Application(const Conditions& conditions, double stiffness, double phase, unsigned seed)
    : Application(
          conditions, stiffness, phase,
          [&ridge = conditions.ridge](const knurl::Vec3& near) {
              const Ridge::Foot foot = ridge.foot(knurl::to_eigen(near));
              return knurl::SurfacePoint{.foot = knurl::to_plain(foot.point),
                                         .normal = knurl::to_plain(foot.normal),
                                         .curvature = foot.curvature,
                                         .axis = {foot.normal.z(), 0, -foot.normal.x()}};
          },
          seed) {}

Application::Application(const Conditions& conditions, double stiffness, double phase,
                         knurl::SurfaceModel model, unsigned seed)
    : conditions_(conditions),
      stiffness_(stiffness),
      model_([device = std::move(model), metre = conditions.world](const knurl::Vec3& near) {
          knurl::SurfacePoint point = device(knurl::to_plain(knurl::to_eigen(near) / metre));
          point.foot = knurl::to_plain(metre * knurl::to_eigen(point.foot));
          point.curvature /= metre;
          point.curvature2 /= metre;
          return point;
      }),
      next_read_(conditions.rate_is_servos ? 0 : phase * conditions.interval()),
      seed_(seed) {}

Answer Application::first(const Vector3d& p) {
    return solve(0, p, Vector3d::Zero());
}

void Application::read(double t, const Vector3d& p, const Vector3d& slow_velocity) {
    using knurl::bridge::proxy::Way;
    Seen hand{t, p, slow_velocity};
    if (conditions_.remote) {
        reports_.send(conditions_.network, seed_, Way::back, t, hand, false);
        reports_.arrive(t);
    }
    if (under_way_ || t + 1e-9 < next_read_) return;
    if (conditions_.remote) {
        if (!reports_.newest()) return;
        hand = *reports_.newest();
    }
    Answer answer = solve(hand.t, hand.position, hand.slow_velocity);
    if (conditions_.remote)
        thought_ = {hand.t, std::move(answer)};
    else
        answer_ = std::move(answer);
    next_read_ += conditions_.rate_is_servos ? conditions_.period() : conditions_.interval();
    due_ = t + conditions_.answer;
    under_way_ = true;
}

bool Application::due(double t) {
    const bool ready = under_way_ && t + 1e-9 >= due_;
    if (ready) under_way_ = false;
    return conditions_.remote ? arrive(t, ready) : ready;
}

/// What the servo has of it by now; `ready`: it has just made another one.
bool Application::arrive(double t, bool ready) {
    if (ready) answers_.send(conditions_.network, seed_, knurl::bridge::proxy::Way::forth, t, thought_, true);
    if (!answers_.arrive(t)) return false;
    answer_ = answers_.newest()->answer;
    ages_[aged_++ % remembered] = t - answers_.newest()->seen;
    return true;
}

/// From a report to the use of what it led to, as the client library knows it. (It learns it one way back
/// later.)
double Application::latency() const {
    // The first cycle that evaluates an answer is the next one after it came.
    const double local = std::max(conditions_.answer, conditions_.period());
    if (!conditions_.remote || aged_ == 0) return local + 2 * conditions_.network.delay;
    std::array<double, remembered> sorted = ages_;
    const auto known = static_cast<std::ptrdiff_t>(std::min(aged_, remembered));
    std::nth_element(sorted.begin(), sorted.begin() + known / 2, sorted.begin() + known);
    return std::max(local, sorted[static_cast<std::size_t>(known / 2)]);
}

Answer Application::solve(double t, const Vector3d& p, const Vector3d& velocity) {
    const Method& method = conditions_.method;
    if (method.kind == Method::Kind::force) {
        const Ridge::Foot foot = conditions_.ridge.foot(p);
        const double size = std::min(stiffness_ * std::max(0.0, -foot.height), conditions_.peak_force);
        return {
            knurl::ConstantForce{.force = knurl::to_plain(size * foot.normal), .recovery = method.recovery}};
    }
    // From here on all is the world's.
    const double metre = conditions_.world, stiffness = stiffness_ / metre;
    const double damping = conditions_.virtual_damping / metre;
    const knurl::Cap cap{.stiffness = stiffness, .damping = damping, .recovery = method.recovery};
    const knurl::Plane plane{
        .stiffness = stiffness, .damping = damping, .recovery = method.recovery, .update = method.update};
    const bool curved = method.kind == Method::Kind::cap;
    knurl::Faces faces{.face = {}, .count = 1};
    if (method.predicted) {
        const knurl::HandNow hand{
            .time = t, .position = knurl::to_plain(metre * p), .velocity = knurl::to_plain(metre * velocity)};
        faces = knurl::follow_surface(
                    model_, hand, {.latency = latency(), .interval = conditions_.interval()},
                    {.stiffness = stiffness, .rim = curved ? cap.rim : 0, .metre = metre}, memory_)
                    .faces;
    } else {
        faces.face[0] = model_(knurl::to_plain(metre * p));
    }
    most_faces_ = std::max<std::size_t>(most_faces_, faces.count);
    Answer answer;
    for (std::size_t i = 0; i < most_faces_; ++i) {
        const knurl::SurfacePoint face = i < faces.count ? faces.face[i] : nowhere;
        const auto placed = [&face](auto params) -> Representation {
            knurl::place(params, face);
            return params;
        };
        answer.push_back(curved ? placed(cap) : placed(plane));
    }
    return answer;
}

}  // namespace stability
