// Planes that change under the hand: with a cross-fade, with another change during a fade, and by the update
// rules `paper` and `last_depth`.

#include "plane_scenes.hpp"

using namespace judge;
using knurl::Plane;

namespace {

/// One change of a set: some planes updated, some removed, one added.
struct Change {
    std::vector<Plane> before, after;
    Real time = 0;  // s, the longest recovery of the planes that changed

    Change(Rng& rng, Scene& scene, Case& c, const PlaneScene& s, Real automatic, bool at_once) {
        before = s.planes;
        const auto recovery = [&] {
            const double T = at_once ? 0 : rng.of(-1, 0, 0.002, 0.01, 0.3);
            time = std::max(time, T < 0 ? automatic : Real(T));
            return T;
        };
        for (std::uint32_t i = 0; i < before.size(); ++i) {
            switch (rng.between(0, 3)) {
                case 0: {  // it changes a little, or altogether
                    Plane next = before[i];
                    next.normal = knurl::to_plain(knurl::to_eigen(next.normal) +
                                                  rng.scale(1e-6, 0.5) * rng.direction());
                    next.offset += s.size * rng.scale(1e-6, 1) * rng.uniform(-1, 1);
                    next.recovery = recovery();
                    c.require(bool(scene.update({i, 1}, next)), "updated");
                    after.push_back(next);
                    break;
                }
                case 1: {  // it is removed, with the recovery of its own parameters
                    time =
                        std::max(time, Real(before[i].recovery < 0 ? automatic : Real(before[i].recovery)));
                    c.require(bool(scene.remove({i, 1})), "removed");
                    break;
                }
                default:
                    after.push_back(before[i]);
            }
        }
        if (rng.one_in(2)) {
            Plane more{.normal = knurl::to_plain(rng.direction()), .stiffness = before[0].stiffness};
            more.offset = knurl::to_eigen(more.normal).dot(s.probe) + s.size * rng.uniform(-1, 0.5);
            more.recovery = recovery();
            c.require(bool(scene.add({15, 1}, more)), "added");
            after.push_back(more);
        }
    }
};

struct ExpectedForce {
    exact::V force;
    Real depth, scale, sharpness, give;
};
ExpectedForce felt(const std::vector<Plane>& planes, const Vector& probe, const Limits& limits) {
    const exact::V p = real(probe);
    const exact::Push push = exact::push(touches_of(planes, p, 0, 0, limits.max_stiffness), {});
    return {exact::capped(push.force, limits.max_force), exact::length(push.dx),
            push.stiffness * std::max(reach_of(planes, p, push), exact::length(p)), push.sharpness,
            push.give};
}

}  // namespace

TEST(Planes, AnyChangeIsFadedFromTheOldSetToTheNew) {
    run("planes, cross-faded", 15'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s;
        do s = any_planes(rng);
        while (s.planes.size() > 8);
        const bool rises = rng.one_in(2), at_once = rng.one_in(8);
        for (Plane& p : s.planes) {
            p.stiffness = rises ? 800 : rng.of(200, 800, 1500, 2500);
            p.recovery = at_once ? 0 : rng.of(0, 0.004);
        }
        Limits limits;
        if (rng.one_in(4)) limits.max_force = rng.uniform(0.1, 10);
        const Real automatic = rng.of(0.01, 0.003);
        Scene scene({16, 1}, limits);
        scene.set_fade({.automatic = static_cast<double>(automatic), .rise_speed = rises ? 0.1 : infinity});
        add_all(c, scene, s.planes);
        scene.settle();
        scene.evaluate(at(s.probe), any_step(rng));
        const Change change(rng, scene, c, s, automatic, at_once);
        Real T = change.time, elapsed = 0;
        for (int i = 0; i < 5; ++i) {
            s.probe += (i == 0 ? 0 : rng.scale(1e-6, 0.1)) * s.size * rng.direction();
            const ExpectedForce before = felt(change.before, s.probe, limits),
                                after = felt(change.after, s.probe, limits);
            if (before.give != 0 || after.give != 0)
                return c.skip();  // contradictions have a test of their own
            if (i == 0 && rises && T > 0) T = std::max(T, (after.depth - before.depth) / 0.1L);
            const double dt = any_step(rng);
            elapsed += dt;
            const Real share = T > 0 ? std::min(Real(1), elapsed / T) : 1;
            // The recovery of a rising surface depends on the depths, whose error is rounding / width.
            c.compare(scene.evaluate(at(s.probe), dt).force, (1 - share) * before.force + share * after.force,
                      std::max(before.scale, after.scale), std::min(before.sharpness, after.sharpness));
        }
    });
}

TEST(Planes, AChangeInTheMiddleOfAnotherGoesOnFromThePresentForce) {
    run("planes, a fade overtaken", 8'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s;
        do s = any_planes(rng);
        while (s.planes.size() > 7);
        Scene scene({16, 1}, {});
        scene.set_fade({.automatic = 0.01, .rise_speed = infinity});
        add_all(c, scene, s.planes);
        scene.settle();
        exact::V force = felt(s.planes, s.probe, {}).force;
        Real scale = felt(s.planes, s.probe, {}).scale, sharpness = 1;
        scene.evaluate(at(s.probe), 1e-3);
        std::vector<Plane> planes = s.planes;
        for (std::uint32_t i = 0; i < 3; ++i) {  // the hand is at rest, so the old set's force is constant
            const ExpectedForce before = felt(planes, s.probe, {});
            planes.push_back(
                {.normal = knurl::to_plain(rng.direction()), .stiffness = 1000, .recovery = 0.01});
            planes.back().offset =
                knurl::to_eigen(planes.back().normal).dot(s.probe) + s.size * rng.uniform(-1, 0.5);
            c.require(bool(scene.add({12 + i, 1}, planes.back())), "added");
            const ExpectedForce after = felt(planes, s.probe, {});
            if (before.give != 0 || after.give != 0) return c.skip();
            scale = std::max({scale, after.scale, before.scale});
            sharpness = std::min({sharpness, before.sharpness, after.sharpness});
            const exact::V old = force;
            Real elapsed = 0;
            for (int j = rng.between(1, 3); j > 0; --j) {
                const double dt = rng.of(0, 1e-6, 1e-3, 0.004);
                elapsed += dt;
                const Real share = std::min(Real(1), elapsed / 0.01L);
                force = (1 - share) * old + share * after.force;
                c.compare(scene.evaluate(at(s.probe), dt).force, force, scale, sharpness);
            }
        }
    });
}

TEST(Planes, RecoverAfterThePaperAndWithTheLastDepth) {
    run("planes, paper's recovery", 12'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s;
        do s = any_planes(rng);
        while (s.planes.size() > 8);
        std::vector<Real> lowered(s.planes.size(), 0), elapsed(s.planes.size(), 0), start(s.planes.size(), 0);
        for (Plane& p : s.planes) {
            p.update = rng.one_in(2) ? knurl::PlaneUpdate::paper : knurl::PlaneUpdate::last_depth;
            p.recovery = rng.of(-1, 0, 0.002, 0.02);
        }
        const auto time_of = [](const Plane& p) { return p.recovery < 0 ? Real(0.05L) : Real(p.recovery); };
        Scene scene({16, 1}, {});
        add_all(c, scene, s.planes);
        scene.settle();
        scene.evaluate(at(s.probe), any_step(rng));
        for (int round = 0; round < 3; ++round) {
            std::vector<Plane> next = s.planes;
            std::vector<bool> changed(next.size());
            for (std::uint32_t i = 0; i < next.size(); ++i) {
                if (!(changed[i] = rng.one_in(2))) continue;
                next[i].offset += s.size * rng.uniform(-0.3, 1) * knurl::to_eigen(next[i].normal).norm();
                c.require(bool(scene.update({i, 1}, next[i])), "updated");
            }
            for (int j = rng.between(1, 3); j > 0; --j) {
                s.probe += rng.scale(1e-6, 0.1) * s.size * rng.direction();
                const double dt = any_step(rng);
                std::vector<exact::Touch> touches;
                for (std::size_t i = 0; i < next.size(); ++i) {
                    exact::Touch t = touch_of(next[i], real(s.probe));
                    const Real T = time_of(next[i]);
                    if (changed[i]) {
                        const Real depth = std::max(Real(0), -t.height);
                        const Real was = -(touch_of(s.planes[i], real(s.probe)).height + lowered[i]);
                        const bool last = next[i].update == knurl::PlaneUpdate::last_depth;
                        start[i] = depth > 0 && last ? depth - std::max(Real(0), was) : depth;
                        elapsed[i] = 0;
                    }
                    elapsed[i] += dt;
                    lowered[i] = T > 0 ? start[i] * std::max(Real(0), 1 - elapsed[i] / T) : 0;
                    t.height += lowered[i];
                    touches.push_back(t);
                }
                changed.assign(next.size(), false);
                s.planes = next;
                const Real reach = reach_of(next, real(s.probe), {});
                const exact::Push want = exact::push(touches, {});
                if (want.give != 0) return c.skip();
                c.compare(scene.evaluate(at(s.probe), dt).force, want.force,
                          1000 * std::max(reach, exact::length(want.dx)), want.sharpness);
            }
        }
    });
}
