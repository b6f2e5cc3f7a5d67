#include "face.hpp"

#include <algorithm>
#include <cmath>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/reps/describe.hpp>

namespace knurl::detail {

namespace {

using Eigen::Vector3d;

constexpr double shortest_chord = 1e-4;  // m at the hand, the least distance of feet to get a curvature from
                                         // their normals
constexpr double shortest_turn = 0.1;    // rad, between normals that belong to different faces

Cap cap_at(const SurfacePoint& point, double rim) {
    Cap cap{.rim = rim};
    place(cap, point);
    return cap;
}

void require_face(const SurfacePoint& answer, const Vec3& at) {
    const Cap cap = cap_at(answer, 0);
    const Verdict verdict = kinds()[kind_of<Cap>].validate(&cap);
    if (!verdict)
        throw Error(
            Error::Kind::bad_parameters,
            detail::format("follow: at ({}, {}, {}) m the model answers foot ({}, {}, {}), normal ({}, "
                           "{}, {}), curvatures {} and {}; {}",
                           at.x, at.y, at.z, answer.foot.x, answer.foot.y, answer.foot.z, answer.normal.x,
                           answer.normal.y, answer.normal.z, answer.curvature, answer.curvature2,
                           describe(verdict, kind_of<Cap>, "")));
}

double sharper_of(const SurfacePoint& point) {
    const double first = std::abs(point.curvature);
    return point.axis == Vec3{} ? first : std::max(first, std::abs(point.curvature2));
}

}  // namespace

Face::Face(const SurfacePoint& point, double rim)
    : point_(point), cap_(prepared(cap_at(point, rim), Limits{})) {
    point_.normal = cap_.normal;
}

double Face::height(const Vector3d& at) const {
    Cap::State still;
    Probe probe;
    probe.position = at;
    return contact(cap_, still, probe, 0).height;
}

Face Questions::ask_aside(const Vector3d& point) {
    ++asked_;
    const SurfacePoint answer = model_(to_plain(point));
    require_face(answer, to_plain(point));
    return Face(answer, rim_);
}

Face Questions::ask(const Vector3d& point) {
    answers_.push_back(ask_aside(point));
    return answers_.back();
}

double sharpest(const std::vector<Face>& answers, const std::vector<Face>& sent, double metre) {
    const auto is_sent = [&](const Face& answer) {
        return std::any_of(sent.begin(), sent.end(), [&](const Face& face) {
            return (answer.normal() - face.normal()).norm() < shortest_turn;
        });
    };
    double result = 0;
    for (const Face& answer : answers) {
        result = std::max(result, sharper_of(answer.point()));
        if (sent.size() > 1 && is_sent(answers.front()) && is_sent(answer)) continue;
        const double chord = (answer.foot() - answers.front().foot()).norm();
        // The other side of a thin part is no curvature of this face.
        if (chord > metre * shortest_chord && answer.normal().dot(answers.front().normal()) >= 0)
            result = std::max(result, (answer.normal() - answers.front().normal()).norm() / chord);
    }
    return result;
}

}  // namespace knurl::detail
