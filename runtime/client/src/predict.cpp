#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "face.hpp"

namespace knurl {

namespace {

using detail::Face;
using Eigen::Vector3d;

constexpr double largest_tolerance = 0.5e-3;  // m
constexpr double force_tolerance = 1.0;       // N: the kick that a wrong face may add
constexpr double forgetting = 0.8;            // per update: about the last five count
constexpr double longest_memory = 1.0;        // s: what is older says nothing about the next movement

/// t*, shortened so that the hand does not get further than max_look_ahead.
double look_ahead_time(const Vector3d& velocity, const Lateness& lateness) {
    const double time = lateness.latency + lateness.interval / 2;
    const double speed = velocity.norm();
    return speed * time > max_look_ahead ? max_look_ahead / speed : time;
}

/// The way v t without its part through the surface: from outside down to it, from inside up to it, no
/// further.
Vector3d restrained(const Vector3d& way, const Face& at_hand, double height) {
    const double normal_part = way.dot(at_hand.normal());
    const double allowed =
        height >= 0 ? std::max(normal_part, -height) : std::clamp(normal_part, 0.0, -height);
    return way + (allowed - normal_part) * at_hand.normal();
}

}  // namespace

Vec3 look_ahead(const Vec3& position, const Vec3& velocity, const Lateness& lateness) noexcept {
    const Vector3d v = to_eigen(velocity);
    return to_plain(to_eigen(position) + v * look_ahead_time(v, lateness));
}

void Trust::observe(double time, const Vec3& position, const Vec3& velocity, double horizon) noexcept {
    // Of the remembered moments the one whose distance in time is nearest to the horizon.
    const std::size_t known = std::min<std::size_t>(count_, samples_.size());
    const Sample* past = nullptr;
    for (std::size_t i = 0; i < known; ++i) {
        const auto distance = [&](const Sample& s) { return std::abs(time - s.time - horizon); };
        if (past == nullptr || distance(samples_[i]) < distance(*past)) past = &samples_[i];
    }
    if (past != nullptr && time > past->time && time - past->time < longest_memory) {
        const Vector3d expected = to_eigen(past->velocity) * (time - past->time);
        explained_ = forgetting * explained_ + expected.dot(to_eigen(position) - to_eigen(past->position));
        expected_ = forgetting * expected_ + expected.squaredNorm();
    }
    samples_[count_++ % samples_.size()] = {.time = time, .position = position, .velocity = velocity};
}

double Trust::factor() const noexcept {
    return expected_ > 0 ? std::clamp(explained_ / expected_, 0.0, 1.0) : 1.0;
}

void place(Plane& plane, const SurfacePoint& face) noexcept {
    plane.normal = face.normal;
    plane.offset = to_eigen(face.normal).dot(to_eigen(face.foot));
}

void place(Cap& cap, const SurfacePoint& face) noexcept {
    cap.foot = face.foot;
    cap.normal = face.normal;
    cap.curvature = face.curvature;
    cap.curvature2 = face.curvature2;
    cap.axis = face.axis;
}

Followed follow_surface(const SurfaceModel& model, const HandNow& hand, const Lateness& lateness,
                        const Follower& follower, FollowMemory& memory) {
    Followed result;
    detail::Questions questions(model, follower.rim);
    const Vector3d p = to_eigen(hand.position), v = to_eigen(hand.velocity);
    const Face here = questions.ask(p);
    const double height = here.height(p);
    // Along the surface: what a contact stops says nothing about where a hand wants to go.
    const Vector3d along = v - v.dot(here.normal()) * here.normal();
    memory.trust.observe(hand.time, hand.position, to_plain(along), lateness.latency + lateness.interval / 2);
    result.trust = memory.trust.factor();

    const auto answer = [&] {
        result.asked = questions.asked();
        result.undersampled = 2 * along.norm() * lateness.interval * questions.sharpest() > 1;
        return result;
    };
    const auto accept = [&](const Face& face, double share) {
        result.look_ahead = share;
        result.faces.face[0] = face.point();
        result.faces.count = 1;
        memory.sent = result.faces;
        return answer();
    };

    // A hand inside, nearest to a face that looks the other way than the one it came in by, has passed the
    // middle of something thin. Nearest points forget where it came from; the last face does not.
    if (memory.sent.count > 0 && height < 0 && here.normal().dot(to_eigen(memory.sent.face[0].normal)) < 0) {
        result.faces = memory.sent;
        result.kept_side = true;
        return answer();
    }

    const double time = result.trust * look_ahead_time(v, lateness);
    if (time <= 0 || v.isZero()) return accept(here, 0);

    const Vector3d landing = p + v * std::min(result.trust * lateness.latency, time);
    const Face there = questions.ask(landing);
    const double landing_height = there.height(landing);
    // Past the middle of something thin the model is no measure; the face on this side is.
    const bool other_face = landing_height < 0 && there.normal().dot(here.normal()) < 0;
    const double depth = std::min(other_face ? here.height(landing) : landing_height, 0.0);
    const double tolerance = follower.stiffness > 0
                                 ? std::min(largest_tolerance, force_tolerance / follower.stiffness)
                                 : largest_tolerance;

    for (const double share : std::array{1.0, 0.5, 0.25}) {
        const Face ahead = questions.ask(p + restrained(v * (time * share), here, height));
        if (ahead.normal().dot(here.normal()) >= 0 && ahead.height(landing) >= depth - tolerance)
            return accept(ahead, share);
    }
    return accept(here, 0);
}

}  // namespace knurl
