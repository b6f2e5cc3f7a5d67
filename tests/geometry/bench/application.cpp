#include "application.hpp"

#include <cmath>

#include <knurl/geometry/proxy.hpp>

namespace knurl::test {
namespace {

using Eigen::Vector3d;

/// The nearest point of all triangles, with a normal interpolated between the corners' as for rendering.
SurfaceModel nearest_of(const Mesh& mesh) {
    return [&mesh](const Vec3& near) {
        Proxy proxy;
        proxy.phase = Proxy::Phase::touching;
        proxy.at[0] = near.x, proxy.at[1] = near.y, proxy.at[2] = near.z;
        Work work;
        adopt(mesh, proxy, {near.x, near.y, near.z}, work);
        Foot foot;
        foot.point = {proxy.at[0], proxy.at[1], proxy.at[2]};
        foot.face = proxy.face;
        return SurfacePoint{to_plain(foot.point), to_plain(shaded_normal(mesh, foot))};
    };
}

/// Out of the hand's reach.
SurfacePoint far_below(SurfacePoint face) {
    face.foot = to_plain(to_eigen(face.foot) - 1e3 * to_eigen(face.normal));
    return face;
}

}  // namespace

std::vector<Said> said_along(const Hand& hand, const Mesh& mesh, const Local& how) {
    const SurfaceModel plain = nearest_of(mesh), model = how.cap ? curved(plain) : plain;
    const double interval = 1 / how.rate;
    // The velocity's low-pass filter, of 20 Hz.
    const double share = LocalScene::period / (LocalScene::period + 1 / (2 * M_PI * 20));
    const auto at = [&](std::size_t i) { return Vector3d(hand[i][0], hand[i][1], hand[i][2]); };
    std::vector<Said> all;
    FollowMemory memory;
    Vector3d slow = Vector3d::Zero();
    double next = 0;  // s
    for (std::size_t i = 0; i < hand.size(); ++i) {
        const double now = static_cast<double>(i) * LocalScene::period;
        if (i > 0) slow += share * ((at(i) - at(i - 1)) / LocalScene::period - slow);
        if (now < next - 1e-9) continue;
        Said said;
        said.felt = i == 0 ? 0 : i + static_cast<std::size_t>(std::lround(interval / LocalScene::period));
        if (how.predicted) {
            said.faces =
                follow_surface(model, {.time = now, .position = to_plain(at(i)), .velocity = to_plain(slow)},
                               {.latency = interval, .interval = interval},
                               {.stiffness = LocalScene::stiffness, .rim = how.cap ? Cap{}.rim : 0}, memory)
                    .faces;
        } else {
            said.faces.face[0] = model(to_plain(at(i)));
            said.faces.count = 1;
        }
        all.push_back(said);
        next += interval;
    }
    return all;
}

LocalScene::LocalScene(const Local& how) : how_(how), scene_({.representations = 4, .probes = 1}, {}) {
    scene_.set_fade({.automatic = automatic_fade(1 / how.rate)});
}

template <class R>
void LocalScene::say(const Faces& faces) {
    for (std::uint32_t i = 0; i < std::max(faces.count, there_); ++i) {
        R params;
        params.stiffness = stiffness;
        place(params, i < faces.count ? faces.face[i] : far_below(faces.face[0]));
        (void)(i < there_ ? scene_.update({i, 1}, params) : scene_.add({i, 1}, params));
    }
    there_ = std::max(there_, faces.count);
}

void LocalScene::begin(const std::vector<Said>& said) {
    scene_.clear();
    there_ = 0;
    said_ = &said;
    next_ = cycle_ = 0;
    probe_ = {};
}

Vector3d LocalScene::next(const Vector3d& hand) {
    probe_.velocity = cycle_ == 0 ? Vector3d::Zero() : Vector3d((hand - probe_.position) / period);
    probe_.smooth_velocity = probe_.velocity;
    probe_.position = hand;
    while (next_ < said_->size() && (*said_)[next_].felt <= cycle_) {
        const Faces& faces = (*said_)[next_++].faces;
        if (how_.cap)
            say<Cap>(faces);
        else
            say<Plane>(faces);
    }
    if (cycle_++ == 0) scene_.settle();
    return scene_.evaluate(probe_, period).force;
}

}  // namespace knurl::test
