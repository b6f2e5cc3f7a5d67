#pragma once
// A mesh in Embree 3, with its two queries: the first face of a segment, and the nearest point of all faces.
// This is not a proxy: it has no memory of the hand's path, so it jumps through thin parts and over ridges.

#include <vector>

#include <Eigen/Dense>
#include <embree3/rtcore.h>

#include "generators.hpp"

namespace knurl::test {

class EmbreeScene {
  public:
    explicit EmbreeScene(const MadeMesh& shape)
        : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)), triangles_(shape.triangles) {
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        corners_.reserve(shape.vertices.size());
        auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, 12, shape.vertices.size()));
        for (const auto& p : shape.vertices) {
            corners_.emplace_back(float(p[0]), float(p[1]), float(p[2]));
            for (const double x : p) *v++ = float(x);
        }
        auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, shape.triangles.size()));
        for (const auto& corners : shape.triangles)
            for (const auto i : corners) *t++ = i;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    ~EmbreeScene() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }

    float sweep(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit ray{};
        const Eigen::Vector3d d = to - from;
        ray.ray.org_x = float(from.x()), ray.ray.org_y = float(from.y()), ray.ray.org_z = float(from.z());
        ray.ray.dir_x = float(d.x()), ray.ray.dir_y = float(d.y()), ray.ray.dir_z = float(d.z());
        ray.ray.tfar = 1;
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray);
        return ray.ray.tfar;
    }

    struct Nearest {
        float distance = 0.02f;  // m; the initial value limits the search
        unsigned triangle = RTC_INVALID_GEOMETRY_ID;
        Eigen::Vector3f point = Eigen::Vector3f::Zero();
    };
    /// Of all faces, within 2 cm.
    Nearest nearest(const Eigen::Vector3d& at) const {
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        Asked asked{this, at.cast<float>(), {}};
        RTCPointQuery query{};
        query.x = float(at.x()), query.y = float(at.y()), query.z = float(at.z());
        query.radius = asked.nearest.distance;
        rtcPointQuery(scene_, &query, &context, &EmbreeScene::see, &asked);
        return asked.nearest;
    }
    /// Not of unit length.
    Eigen::Vector3f normal(unsigned triangle) const {
        const auto& t = triangles_[triangle];
        return (corners_[t[1]] - corners_[t[0]]).cross(corners_[t[2]] - corners_[t[0]]);
    }

  private:
    struct Asked {
        const EmbreeScene* me;
        Eigen::Vector3f at;
        Nearest nearest;
    };
    // The nearest point of a triangle (Ericson, "Real-Time Collision Detection"), in float as Embree itself.
    static bool see(RTCPointQueryFunctionArguments* args) {
        Asked& asked = *static_cast<Asked*>(args->userPtr);
        const auto& t = asked.me->triangles_[args->primID];
        const Eigen::Vector3f &a = asked.me->corners_[t[0]], &b = asked.me->corners_[t[1]],
                              &c = asked.me->corners_[t[2]];
        const Eigen::Vector3f ab = b - a, ac = c - a, ap = asked.at - a, bp = asked.at - b, cp = asked.at - c;
        const float d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
                    d6 = ac.dot(cp);
        const float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
        Eigen::Vector3f x;
        if (d1 <= 0 && d2 <= 0) {
            x = a;
        } else if (d3 >= 0 && d4 <= d3) {
            x = b;
        } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
            x = a + ab * (d1 / (d1 - d3));
        } else if (d6 >= 0 && d5 <= d6) {
            x = c;
        } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
            x = a + ac * (d2 / (d2 - d6));
        } else if (va <= 0 && d4 >= d3 && d5 >= d6) {
            x = b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
        } else {
            const float sum = va + vb + vc;
            x = a + ab * (vb / sum) + ac * (vc / sum);
        }
        const float distance = (asked.at - x).norm();
        if (!(distance < args->query->radius)) return false;
        args->query->radius = distance;
        asked.nearest = {distance, args->primID, x};
        return true;
    }

    RTCDevice device_;
    RTCScene scene_;
    std::vector<Eigen::Vector3f> corners_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace knurl::test
