#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <knurl/reps/limits.hpp>

#include "corner.hpp"

namespace knurl {

namespace {

using detail::Face;
using Eigen::Vector3d;

// All lengths and forces are at the hand, in metres and newtons of the device.
constexpr double largest_tolerance = 0.5e-3;  // m
constexpr double force_tolerance = 1.0;       // N: the largest error of force by a wrong face
constexpr double forgetting = 0.8;            // per update: about the last five updates count
constexpr double sharp_turn = 0.8;            // rad: a surface that turns by more on the way is not smooth
constexpr double shortest_fit = 0.1e-3;       // m: on a shorter way there is nothing to fit
constexpr double longest_memory = 1.0;        // s: older movements say nothing about the next one

/// t*, shortened so that the hand gets no farther than max_look_ahead.
double look_ahead_time(const Vector3d& velocity, const Lateness& lateness, double metre) {
    const double time = lateness.latency + lateness.interval / 2;
    const double speed = velocity.norm(), most = metre * max_look_ahead;
    return speed * time > most ? most / speed : time;
}

/// A cap of a model that does not state its curvature is a plane.
bool is_plane(const Follower& follower, const Face& face) {
    return follower.rim == 0 || (face.point().curvature == 0 && face.point().curvature2 == 0);
}

/// The plane nearest to the surface along the way, in the mean square: the tangent plane at the middle, moved
/// and tilted by the surface at the ends. Exact where the surface is a cubic.
Face fitted(const Face& middle, const Face& before, const Face& after, double metre) {
    const Vector3d n = middle.normal(), way = after.foot() - before.foot(), along = way - way.dot(n) * n;
    const double length = along.norm();
    const double turn =
        std::acos(std::clamp(std::min(n.dot(before.normal()), n.dot(after.normal())), -1.0, 1.0));
    if (length < metre * shortest_fit || turn > sharp_turn) return middle;
    const double first = n.dot(before.foot() - middle.foot()), last = n.dot(after.foot() - middle.foot());
    SurfacePoint plane = middle.point();
    plane.foot = to_plain(middle.foot() + (first + last) / 6 * n);
    plane.normal = to_plain(n - 0.6 * (last - first) / (length * length) * along);
    return Face(plane, 0);
}

/// Facing opposite sides; a right angle does not count.
bool opposed(const Face& a, const Face& b) {
    return a.normal().dot(b.normal()) < -1e-9;
}

/// Puts each face at the index of the similar face of the last update, so that the sent values change as
/// little as possible.
void keep_order(std::vector<Face>& faces, const std::vector<Face>& last) {
    std::size_t at = 0;
    for (const Face& before : last) {
        const auto like = std::find_if(faces.begin() + static_cast<std::ptrdiff_t>(at), faces.end(),
                                       [&](const Face& face) { return detail::same(face, before); });
        if (like != faces.end()) std::swap(*like, faces[at++]);
    }
}

/// The way v t without its part through the surface: from outside down to the surface, from inside up to it,
/// not further.
Vector3d restrained(const Vector3d& way, const Face& at_hand, double height) {
    const double normal_part = way.dot(at_hand.normal());
    const double allowed =
        height >= 0 ? std::max(normal_part, -height) : std::clamp(normal_part, 0.0, -height);
    return way + (allowed - normal_part) * at_hand.normal();
}

}  // namespace

Vec3 look_ahead(const Vec3& position, const Vec3& velocity, const Lateness& lateness, double metre) noexcept {
    const Vector3d v = to_eigen(velocity);
    return to_plain(to_eigen(position) + v * look_ahead_time(v, lateness, metre));
}

void Trust::observe(double time, const Vec3& position, const Vec3& velocity, double horizon) noexcept {
    // The remembered moment whose distance in time is nearest to the horizon.
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
    detail::Questions questions(model, follower.rim, follower.metre);
    const Vector3d p = to_eigen(hand.position), v = to_eigen(hand.velocity);
    std::vector<Face> last;
    for (const SurfacePoint& face : memory.sent.all()) last.emplace_back(face, follower.rim);

    // The hand is inside, and the nearest face looks away from the face through which it entered: it has
    // passed the middle of a thin part. A nearest point alone cannot tell by which face the hand entered, but
    // the face of the last update can. So the model is queried at the hand's foot on that face.
    Face here = questions.ask(p);
    for (const Face& face : last) {
        if (here.height(p) >= 0 || !opposed(here, face) || detail::is_corner(face, here, p, questions))
            continue;
        result.kept_side = true;
        here = questions.ask_aside(p - face.height(p) * face.normal());
        if (opposed(here, face)) here = face;
        break;
    }
    const double height = here.height(p);
    // Along the surface: a velocity that a contact stops does not show where the hand will go.
    const Vector3d along = v - v.dot(here.normal()) * here.normal();
    memory.trust.observe(hand.time, hand.position, to_plain(along), lateness.latency + lateness.interval / 2);
    result.trust = memory.trust.factor();

    const double most = follower.metre * largest_tolerance;
    const double tolerance = follower.stiffness > 0
                                 ? std::min(most, follower.newton * force_tolerance / follower.stiffness)
                                 : most;
    const double time = result.trust * look_ahead_time(v, lateness, follower.metre);
    const double landing_time = std::min(result.trust * lateness.latency, time);
    const Vector3d landing = p + v * landing_time;
    std::vector<Face> faces{here};
    double depth = 0;  // m, at most 0: the depth of the landing in the model itself
    if (time > 0 && !v.isZero()) {
        const Face there = questions.ask(landing);
        const double landing_height = there.height(landing);
        // Beyond the middle of a thin part the model is no reference; the face on this side is.
        const bool other_face = landing_height < 0 && opposed(there, here);
        depth = std::min(other_face ? here.height(landing) : landing_height, 0.0);
        for (const double share : std::array{1.0, 0.5, 0.25}) {
            const Face ahead = questions.ask(p + restrained(v * (time * share), here, height));
            if (opposed(ahead, here) || ahead.height(landing) < depth - tolerance) continue;
            faces[0] = ahead;
            result.look_ahead = share;
            break;
        }
        // A wall that the hand reaches before the next update acts is sought above the floor on which the
        // hand presses.
        const Vector3d end = p + v * (2 * time - landing_time);
        questions.ask(end +
                      std::max(0.0, follower.metre * detail::beside - here.height(end)) * here.normal());
    }
    std::vector<Face> candidates = questions.answers();
    candidates.insert(candidates.end(), last.begin(), last.end());
    detail::add_corner(faces, candidates, landing, tolerance, questions);

    if (faces.size() == 1 && result.look_ahead > 0 && is_plane(follower, faces[0])) {
        // The update acts until the next one has faded in.
        const double middle = result.look_ahead * time;
        const double felt =
            result.look_ahead * result.trust * (lateness.interval + automatic_fade(lateness.interval));
        const double half = std::min(middle, felt / 2);
        const Face before = questions.ask_aside(p + restrained(v * (middle - half), here, height));
        const Face after = questions.ask_aside(p + restrained(v * (middle + half), here, height));
        const Face plane = fitted(faces[0], before, after, follower.metre);
        if (plane.height(landing) >= depth - tolerance) faces[0] = plane;
    }

    keep_order(faces, last);
    for (const Face& face : faces) result.faces.face[result.faces.count++] = face.point();
    memory.sent = result.faces;
    result.undersampled =
        2 * along.norm() * lateness.interval * detail::sharpest(questions.answers(), faces, follower.metre) >
        1;
    result.asked = questions.asked();
    return result;
}

}  // namespace knurl
