#include "closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include <knurl/reps/scene.hpp>

namespace closed_loop {

using namespace knurl;

namespace {

constexpr int steps = 10;  // of the dynamics in a cycle
constexpr double h = dt / steps;

/// The mass, its actuators and its hand.
class Tip {
  public:
    Tip(const Hand& hand, const Path& path) : hand_(hand), path_(path), position(path(0)) {}

    void advance(double t, const Vector3d& target) {
        const double follow = hand_.lag > 0 ? -std::expm1(-h * 2 * std::numbers::pi * hand_.lag) : 1;
        const Vector3d to = path_(t), speed = (path_(t + dt) - to) / dt;
        const Vector3d reference = hand_.damped_to_path ? speed : Vector3d(Vector3d::Zero());
        for (int i = 0; i < steps; ++i) {
            exerted_ += follow * (target - exerted_);
            const Vector3d wanted = to + i * h * speed;
            Vector3d force = exerted_ + hand_.grip.cwiseProduct(wanted - position);
            force -= hand_.damping * (velocity - reference) + hand_.device_damping * velocity;
            force.z() -= hand_.push;
            velocity += h / hand_.mass * force;
            const double fast = velocity.norm();
            if (fast > 0) velocity *= std::max(0.0, 1 - h * hand_.coulomb / (hand_.mass * fast));
            position += h * velocity;
        }
    }

  private:
    const Hand& hand_;
    const Path& path_;
    Vector3d exerted_ = Vector3d::Zero();

  public:
    Vector3d position, velocity = Vector3d::Zero();
};

double world_stiffness(const Run& how) {
    return how.stiffness * how.newton / how.metre;
}

/// The same surface in the world.
Model in_world(const Model& model, double metre) {
    return [=](const Vec3& near) {
        SurfacePoint point = model(to_plain(to_eigen(near) / metre));
        point.foot = to_plain(metre * to_eigen(point.foot));
        point.curvature /= metre;
        point.curvature2 /= metre;
        return point;
    };
}

/// The representations of one follower in the servo's scene, as the library keeps them.
class FollowedScene {
  public:
    explicit FollowedScene(const Run& how)
        : how_(how),
          scene_({.representations = 4, .probes = 1},
                 {.max_force = how.newton * how.hand.peak_force, .metre = how.metre, .newton = how.newton}) {
        scene_.set_fade({.automatic = 0.2 * lateness.interval, .rise_speed = 0.1});
    }

    void set(const Faces& faces) {
        for (std::uint32_t i = 0; i < max_faces; ++i) {
            const RepresentationId id{i, 1};
            if (i >= faces.count) {
                if (there_[i]) scene_.remove(id);
                there_[i] = false;
            } else if (how_.rim > 0) {
                put(id, Cap{.rim = how_.rim, .stiffness = world_stiffness(how_)}, faces.face[i]);
            } else {
                put(id, Plane{.stiffness = world_stiffness(how_)}, faces.face[i]);
            }
        }
    }
    void settle() { scene_.settle(); }
    Vector3d force(const Vector3d& p) {
        Probe probe;
        probe.position = how_.metre * p;
        return scene_.evaluate(probe, dt).force / how_.newton;
    }

  private:
    template <class R>
    void put(RepresentationId id, R params, const SurfacePoint& face) {
        place(params, face);
        if (there_[id.slot])
            scene_.update(id, params);
        else
            scene_.add(id, params);
        there_[id.slot] = true;
    }

    const Run& how_;
    Scene scene_;
    std::array<bool, max_faces> there_{};
};

Vector3d counted(const Vector3d& p, double quantum) {
    return quantum > 0 ? Vector3d(quantum * (p / quantum).array().round()) : p;
}

}  // namespace

Outcome run(const Run& how, const Model& model, const Path& path, const Truth& truth) {
    struct Update {
        int lands;
        Faces faces;
    };
    std::deque<Update> on_their_way;
    FollowMemory memory;
    Tip tip(how.hand, path);
    FollowedScene felt(how);
    const Model world = in_world(model, how.metre);
    const auto there = [&](const Vector3d& v) { return to_plain(how.metre * v); };
    felt.set({.face = {world(there(tip.position))}, .count = 1});
    felt.settle();
    Vector3d last = counted(tip.position, how.hand.quantum), slow = Vector3d::Zero();
    Vector3d before = Vector3d::Zero();
    Outcome outcome;
    double squares = 0;
    int updates = 0, judged = 0;
    const int first = static_cast<int>(std::lround(how.phase / dt));
    const int cycles = static_cast<int>(std::lround(how.seconds / dt));
    for (int cycle = 0; cycle < cycles; ++cycle) {
        const double t = cycle * dt;
        const Vector3d p = counted(tip.position, how.hand.quantum);
        // as in the report
        slow += ((p - last) / dt - slow) * (1 - std::exp(-2 * std::numbers::pi * 20 * dt));
        last = p;
        if (cycle >= first && (cycle - first) % update_cycles == 0) {
            Faces next{.face = {}, .count = 1};
            if (how.way == Way::safe) {
                const Followed followed = follow_surface(
                    world, {.time = t, .position = there(p), .velocity = there(slow)}, lateness,
                    {.stiffness = world_stiffness(how),
                     .rim = how.rim,
                     .metre = how.metre,
                     .newton = how.newton},
                    memory);
                next = followed.faces;
                outcome.full_share += followed.look_ahead == 1 ? 1 : 0;
                outcome.cornered += next.count > 1 ? 1 : 0;
                outcome.undersampled += followed.undersampled ? 1 : 0;
                outcome.asked += followed.asked;
            } else {
                next.face[0] = how.way == Way::none
                                   ? world(there(p))
                                   : world(look_ahead(there(p), there(slow), lateness, how.metre));
            }
            ++updates;
            on_their_way.push_back({cycle + latency_cycles, next});
        }
        if (!on_their_way.empty() && on_their_way.front().lands == cycle) {
            felt.set(on_their_way.front().faces);
            on_their_way.pop_front();
        }
        const Vector3d force = felt.force(p);
        if (t >= how.judged_from) {
            const SurfacePoint foot = model(to_plain(tip.position));
            const Vector3d n = to_eigen(foot.normal).normalized();
            const double depth = std::max(0.0, n.dot(to_eigen(foot.foot) - tip.position));
            const Vector3d right = truth ? truth(tip.position)
                                         : Vector3d(std::min(how.stiffness * depth, how.hand.peak_force) * n);
            squares += (force - right).squaredNorm();
            ++judged;
            outcome.deepest = std::max(outcome.deepest, truth ? right.norm() / how.stiffness : depth);
            outcome.largest_side = std::max(outcome.largest_side, std::abs(force.x()));
            outcome.largest_step = std::max(outcome.largest_step, (force - before).norm());
        }
        before = force;
        tip.advance(t, force);
        outcome.lowest = outcome.lowest.cwiseMin(tip.position);
        outcome.highest = outcome.highest.cwiseMax(tip.position);
    }
    outcome.rms_error = std::sqrt(squares / std::max(judged, 1));
    outcome.end = tip.position;
    for (double* mean : {&outcome.full_share, &outcome.cornered, &outcome.undersampled, &outcome.asked})
        *mean /= std::max(updates, 1);
    return outcome;
}

}  // namespace closed_loop
