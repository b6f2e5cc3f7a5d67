#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include <knurl/client/error.hpp>
#include <knurl/client/predict.hpp>

namespace knurl {

namespace {

using Eigen::Vector3d;

constexpr double largest_tolerance = 0.5e-3;  // m
constexpr double force_tolerance = 1.0;       // N: the kick that a wrong plane may add
constexpr double shortest_normal = 1e-6;
constexpr double forgetting = 0.8;      // per update: about the last five count
constexpr double longest_memory = 1.0;  // s: what is older says nothing about the next movement

struct TangentPlane {
    Vector3d foot, normal;
    double height(const Vector3d& point) const { return normal.dot(point - foot); }
};

SurfacePoint plain(const TangentPlane& plane) {
    return {.foot = to_plain(plane.foot), .normal = to_plain(plane.normal)};
}

TangentPlane ask(const SurfaceModel& model, const Vector3d& point, std::uint32_t& asked) {
    ++asked;
    const SurfacePoint answer = model(to_plain(point));
    const Vector3d foot = to_eigen(answer.foot), normal = to_eigen(answer.normal);
    const double length = normal.norm();
    if (!foot.allFinite() || !std::isfinite(length) || length < shortest_normal)
        throw Error(
            Error::Kind::bad_parameters,
            fmt::format("follow: at ({}, {}, {}) m the model answers foot ({}, {}, {}), normal ({}, {}, {}); "
                        "give finite numbers and a normal that is not zero",
                        point.x(), point.y(), point.z(), foot.x(), foot.y(), foot.z(), normal.x(), normal.y(),
                        normal.z()));
    return {.foot = foot, .normal = normal / length};
}

/// t*, shortened so that the hand does not get further than max_look_ahead.
double look_ahead_time(const Vector3d& velocity, const Lateness& lateness) {
    const double time = lateness.latency + lateness.interval / 2;
    const double speed = velocity.norm();
    return speed * time > max_look_ahead ? max_look_ahead / speed : time;
}

/// The way v t without its part through the surface: from outside down to it, from inside up to it, no
/// further.
Vector3d restrained(const Vector3d& way, const TangentPlane& at_hand, double height) {
    const double normal_part = way.dot(at_hand.normal);
    const double allowed =
        height >= 0 ? std::max(normal_part, -height) : std::clamp(normal_part, 0.0, -height);
    return way + (allowed - normal_part) * at_hand.normal;
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

Followed follow_surface(const SurfaceModel& model, const HandNow& hand, const Lateness& lateness,
                        double stiffness, FollowMemory& memory) {
    Followed result;
    const Vector3d p = to_eigen(hand.position), v = to_eigen(hand.velocity);
    const TangentPlane here = ask(model, p, result.asked);
    const double height = here.height(p);
    // Along the surface: what a contact stops says nothing about where a hand wants to go.
    const Vector3d along = v - v.dot(here.normal) * here.normal;
    memory.trust.observe(hand.time, hand.position, to_plain(along), lateness.latency + lateness.interval / 2);
    result.trust = memory.trust.factor();

    // A hand inside, nearest to a face that looks the other way than the one it came in by, has passed the
    // middle of something thin. Nearest points forget where it came from; the last plane does not.
    if (memory.known && height < 0 && here.normal.dot(to_eigen(memory.plane.normal)) < 0) {
        result.plane = memory.plane;
        result.kept_side = true;
        return result;
    }

    const auto accept = [&](const TangentPlane& plane, double share) {
        result.plane = plain(plane);
        result.look_ahead = share;
        memory.plane = result.plane;
        memory.known = true;
        return result;
    };

    const double time = result.trust * look_ahead_time(v, lateness);
    if (time <= 0 || v.isZero()) return accept(here, 0);

    const Vector3d landing = p + v * std::min(result.trust * lateness.latency, time);
    const TangentPlane there = ask(model, landing, result.asked);
    const double landing_height = there.height(landing);
    // Past the middle of something thin the model is no measure; the face on this side is.
    const bool other_face = landing_height < 0 && there.normal.dot(here.normal) < 0;
    const double depth = std::min(other_face ? here.height(landing) : landing_height, 0.0);
    const double tolerance =
        stiffness > 0 ? std::min(largest_tolerance, force_tolerance / stiffness) : largest_tolerance;

    for (const double share : std::array{1.0, 0.5, 0.25}) {
        const TangentPlane ahead = ask(model, p + restrained(v * (time * share), here, height), result.asked);
        if (ahead.normal.dot(here.normal) >= 0 && ahead.height(landing) >= depth - tolerance)
            return accept(ahead, share);
    }
    return accept(here, 0);
}

}  // namespace knurl
