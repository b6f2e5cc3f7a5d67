#include "face.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <knurl/client/error.hpp>
#include <knurl/reps/describe.hpp>

namespace knurl::detail {

namespace {

using Eigen::Vector3d;

constexpr double shortest_chord = 1e-4;  // m, between feet, to tell a curvature from their normals

Cap cap_at(const SurfacePoint& point, double rim) {
    Cap cap{.rim = rim};
    place(cap, point);
    return cap;
}

void require_face(const SurfacePoint& answer, const Vec3& at) {
    const Cap cap = cap_at(answer, 0);
    const Verdict verdict = kinds()[kind_of<Cap>].validate(&cap);
    if (!verdict)
        throw Error(Error::Kind::bad_parameters,
                    fmt::format("follow: at ({}, {}, {}) m the model answers foot ({}, {}, {}), normal ({}, "
                                "{}, {}), curvatures {} and {}; {}",
                                at.x, at.y, at.z, answer.foot.x, answer.foot.y, answer.foot.z,
                                answer.normal.x, answer.normal.y, answer.normal.z, answer.curvature,
                                answer.curvature2, describe(verdict, kind_of<Cap>, "")));
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

Face Questions::ask(const Vector3d& point) {
    ++asked_;
    const SurfacePoint answer = model_(to_plain(point));
    require_face(answer, to_plain(point));
    const Face face(answer, rim_);
    sharpest_ = std::max(sharpest_, sharper_of(answer));
    if (asked_ == 1) first_foot_ = face.foot(), first_normal_ = face.normal();
    const double chord = (face.foot() - first_foot_).norm();
    if (chord > shortest_chord)
        sharpest_ = std::max(sharpest_, (face.normal() - first_normal_).norm() / chord);
    return face;
}

}  // namespace knurl::detail
