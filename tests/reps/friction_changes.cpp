// Friction while its contact changes: corners appear and vanish, a line turns, laws are mixed anew. Its step
// per cycle stays below the bound stated in friction.hpp.

#include "friction_tools.hpp"
#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

/// The allowed step per cycle, computed from the inputs only.
class StepBound {
  public:
    struct Cycle {
        FrictionLaw law;
        Tangent tangent;
        Rubbing rubbing;
        double dt = 0;
        bool lets_go = false;  // by its law
    };

    Real step(const Cycle& now) {
        const Real n = now.rubbing.normal_force;
        const Real holds = now.law.static_ * n, slides = now.law.dynamic * n;
        const Real cone = std::max(holds, slides);
        const Vector relative = now.rubbing.velocity - now.rubbing.surface_velocity;
        const Real viscous = std::min<Real>(n, now.law.viscous * relative.norm());
        Real most = std::numeric_limits<Real>::infinity();
        if (any_) {
            const Cycle& last = last_;
            const Real n0 = last.rubbing.normal_force;
            const Real cone0 = std::max(last.law.static_, last.law.dynamic) * n0;
            const Vector relative0 = last.rubbing.velocity - last.rubbing.surface_velocity;
            const Real viscous0 = std::min<Real>(n0, last.law.viscous * relative0.norm());
            const Vector moved =
                now.rubbing.position - last.rubbing.position - now.dt * now.rubbing.surface_velocity;
            const Real k = std::max(now.law.stiffness, last.law.stiffness);
            const bool turns = now.tangent.dimensions == 2 && last.tangent.dimensions == 2;
            const Real turned = turns ? now.tangent.normal.cross(last.tangent.normal).norm() : 0;
            // The tip's motion.
            most = k * moved.norm() + now.law.viscous * (relative - relative0).norm();
            // The law and the normal force.
            most += std::abs(cone - cone0) + std::abs(slides - last.law.dynamic * n0) + std::abs(n - n0) +
                    std::abs(now.law.viscous - last.law.viscous) * relative0.norm();
            most += cone0 * std::max<Real>(0, 1 - now.law.stiffness / Real(last.law.stiffness));
            if (now.lets_go) most += holds - slides;
            // The turn of the surface, and the decay of the residual.
            most += (turned + now.dt / Real(residual_decay)) * (cone0 + viscous0);
            most += now.dt / Real(residual_decay) * 2 * felt();
        }
        recent_.push_back({cone + viscous, 0});
        for (auto& [size, age] : recent_) age += now.dt;
        while (recent_.front().second > residual_decay + 5 * now.dt) recent_.erase(recent_.begin());
        last_ = now;
        any_ = true;
        return most;
    }

  private:
    // The recent maximum.
    Real felt() const {
        Real most = 0;
        for (const auto& [size, age] : recent_) most = std::max(most, size);
        return most;
    }
    bool any_ = false;
    Cycle last_;
    std::vector<std::pair<Real, Real>> recent_;
};

FrictionLaw random_law(Rng& rng) {
    const double dynamic = between(rng, 0, 5) ? uniform(rng, 0, 1) : 0;
    const Friction friction{.static_ = between(rng, 0, 1) ? automatic : dynamic + uniform(rng, 0, 0.4),
                            .dynamic = dynamic,
                            .viscous = between(rng, 0, 1) ? 0 : scale(rng, 0.1, 20)};
    Snag snag{};
    if (between(rng, 0, 3) == 0)
        snag = {.k_kinetic = uniform(rng, 0.1, 0.8),
                .k_stick = scale(rng, 200, 3000),
                .d_snap = scale(rng, 1e-4, 1e-3),
                .d_mean = scale(rng, 2e-4, 5e-3),
                .d_spread = scale(rng, 1e-4, 2e-3),
                .seed = static_cast<std::uint32_t>(rng())};
    return friction_law(friction, snag, scale(rng, 200, 2000), free_limits);
}

void turn(Rng& rng, Tangent& tangent) {
    switch (between(rng, 0, 2)) {
        case 0:  // slowly
            tangent.normal = (tangent.normal + scale(rng, 1e-4, 0.02) * direction(rng)).normalized();
            break;
        case 1:  // into a corner, out of it, or along another one
            tangent.dimensions = static_cast<std::uint32_t>(between(rng, 0, 2));
            [[fallthrough]];
        default:
            tangent.line = direction(rng);
    }
    tangent.line = (tangent.line - tangent.normal.dot(tangent.line) * tangent.normal).normalized();
}

}  // namespace

TEST(Friction, NoChangeOfItsContactAddsMoreThanItsBound) {
    const std::uint64_t seed = 51;
    Rng rng(seed);
    double most = 0, worst = 0;
    for (int run = 0; run < (long_form() ? 20'000 : 400); ++run) {
        const FrictionLaw one = random_law(rng), other = random_law(rng);
        Tip tip{one};
        StepBound bound;
        Rubbing rubbing = rubbing_at(0.1 * direction(rng), scale(rng, 0.2, 5));
        if (between(rng, 0, 2) == 0) rubbing.surface_velocity = 0.05 * direction(rng);
        const double often = scale(rng, 0.005, 0.5), dt = scale(rng, 1e-4, 2e-3);
        double share = 1;
        Vector last = Vector::Zero();
        for (int i = 0; i < 500; ++i) {
            rubbing.velocity += std::min(1.0, dt / 0.02) * (0.3 * direction(rng) - rubbing.velocity);
            rubbing.position += dt * rubbing.velocity;
            rubbing.normal_force = std::clamp(rubbing.normal_force * uniform(rng, 0.98, 1.02), 0.05, 8.0);
            if (uniform(rng, 0, 1) < often) turn(rng, tip.tangent);
            share = std::clamp(share + uniform(rng, -0.02, 0.02), 0.0, 1.0);
            tip.law = {};
            double leading = 0;
            add_share(tip.law, leading, one, share);
            add_share(tip.law, leading, other, 1 - share);
            const bool slid = tip.state.sliding;
            const std::uint64_t drawn = tip.state.generator;
            const Vector force = friction_force(tip.law, tip.state, tip.tangent, rubbing, free_limits, dt);
            // A snag that lets go draws the place of the next one, which may hold in the same cycle.
            const bool lets_go = (!slid && tip.state.sliding) || tip.state.generator != drawn;
            const Real allowed = bound.step({tip.law, tip.tangent, rubbing, dt, lets_go});
            const double step = (force - last).norm();
            if (i > 0) {
                const double ratio = static_cast<double>(step / allowed);
                worst = std::max(worst, ratio);
                most = std::max(most, step);
            }
            last = force;
        }
    }
    std::printf("seed %llu: the largest step is %.3f N, at most %.3f of the bound\n",
                static_cast<unsigned long long>(seed), most, worst);
    EXPECT_LE(worst, 1 + 1e-9) << "seed " << seed;
}

namespace {

struct Wall {
    Plane plane;
    bool present = false;
};

/// A wall of a room about the origin: no two of them face nearly the same way.
Plane random_wall(Rng& rng, int side, double stiffness, const Friction& friction) {
    Vector n = Vector::Zero();
    n[side % 3] = side < 3 ? 1 : -1;
    n = (n + uniform(rng, 0, 0.4) * direction(rng)).normalized();
    return {.normal = {n.x(), n.y(), n.z()},
            .offset = uniform(rng, -0.003, -0.0005),
            .stiffness = stiffness,
            .recovery = between(rng, 0, 1) ? scale(rng, 5e-3, 0.1) : automatic,
            .friction = friction};
}

}  // namespace

TEST(Friction, InAChangingRoomNothingAddsMoreThanItsBound) {
    const std::uint64_t seed = 52;
    Rng rng(seed);
    double worst = 0, most = 0, gain = 0;
    for (int run = 0; run < (long_form() ? 2000 : 60); ++run) {
        const double mu = uniform(rng, 0, 1), b = between(rng, 0, 1) ? 0 : scale(rng, 0.5, 50);
        const bool alike = between(rng, 0, 1) != 0;         // all walls are of one material
        Scene rough = make_scene(), smooth = make_scene();  // without friction: the contact alone
        std::array<Wall, 6> walls;
        const auto renew = [&](std::uint32_t side) {
            Wall& wall = walls[side];
            const double part = alike ? 1 : uniform(rng, 0, 1);
            wall.plane = random_wall(rng, static_cast<int>(side), alike ? 1000 : scale(rng, 200, 1000),
                                     {.dynamic = part * mu, .viscous = part * b});
            Plane bare = wall.plane;
            bare.friction = {};
            ASSERT_TRUE(wall.present ? rough.update({side, 1}, wall.plane)
                                     : rough.add({side, 1}, wall.plane));
            ASSERT_TRUE(wall.present ? smooth.update({side, 1}, bare) : smooth.add({side, 1}, bare));
            wall.present = true;
        };
        Vector x = 0.01 * direction(rng), v = Vector::Zero(), last_contact = Vector::Zero(),
               last = Vector::Zero();
        std::vector<double> recent;
        double work = 0;
        for (int i = 0; i < 1000; ++i) {
            if (i == 0 || between(rng, 0, 60) == 0) {
                for (int changes = i == 0 ? 4 : 1; changes > 0; --changes) {
                    const auto side = static_cast<std::uint32_t>(between(rng, 0, 5));
                    if (walls[side].present && between(rng, 0, 2) == 0) {
                        ASSERT_TRUE(rough.remove({side, 1}) && smooth.remove({side, 1}));
                        walls[side].present = false;
                    } else {
                        renew(side);
                    }
                }
            }
            const Vector before = v;
            v += 0.02 * (0.15 * direction(rng) - 3 * x - v);  // slowly, so that its own motion explains
                                                              // little
            x += dt * v;
            const Vector contact = smooth.evaluate(at(x, v), dt).force;
            const Vector along = rough.evaluate(at(x, v), dt).force - contact;
            const double n = contact.norm();
            recent.push_back(mu * n + std::min(n, b * v.norm()));
            if (recent.size() > 16) recent.erase(recent.begin());
            const double felt = *std::max_element(recent.begin(), recent.end());
            // The tip's motion; the contact's size and turn; the decay of the residual.
            const double allowed = 1000 * dt * v.norm() + b * (v - before).norm() +
                                   (1 + 2 * mu) * (contact - last_contact).norm() +
                                   3 * dt / residual_decay * felt + 1e-12;
            const double step = (along - last).norm();
            worst = std::max(worst, step / allowed);
            most = std::max(most, step);
            work += 0.5 * dt * (along + last).dot(v);
            gain = std::max(gain, work);
            last = along;
            last_contact = contact;
        }
    }
    std::printf(
        "seed %llu: the largest step is %.3f N, at most %.3f of the bound; at most %.2g J came back\n",
        static_cast<unsigned long long>(seed), most, worst, gain);
    EXPECT_LE(worst, 1 + 1e-9) << "seed " << seed;
    EXPECT_LT(gain, 1e-5) << "J: friction takes, and what it lets go gives no more back";
}

TEST(Friction, WhatATextureLeavesBehindEndsWithTheContact) {
    Scene scene = make_scene();
    Plane ridges{.normal = {0, 0, 1}, .stiffness = 1000};
    ridges.texture = {.amplitude = 1e-4, .wavelength = 2e-3};
    ASSERT_TRUE(scene.add({0, 1}, ridges));
    scene.settle();
    Vector x(0.0005, 0, -0.002);
    double last = scene.evaluate(at(x), dt).force.x(), most = 0;
    ASSERT_GT(last, 0.5);
    for (const double offset : {-1e-5, -2e-5}) {  // the second interrupts the first: the relief is dropped
        ridges.offset = offset;
        ASSERT_TRUE(scene.update({0, 1}, ridges));
        const double now = scene.evaluate(at(x), dt).force.x();
        most = std::max(most, std::abs(now - last));
        last = now;
    }
    for (int i = 0; i < 6; ++i) {  // lifted within the 10 ms
        x.z() += 0.0005;
        const double now = scene.evaluate(at(x), dt).force.x();
        most = std::max(most, std::abs(now - last));
        last = now;
    }
    EXPECT_EQ(last, 0);
    EXPECT_LT(most, 0.32) << "half a newton less of contact, of which a third pushes sideways, and a tenth";
}

TEST(Friction, ThatComesLaterBeginsWhereTheTipIs) {
    Scene scene = make_scene();
    Plane floor{.normal = {0, 0, 1}, .stiffness = 1000, .recovery = 0, .friction = {.dynamic = 1}};
    ASSERT_TRUE(scene.add({0, 1}, floor));
    scene.evaluate(at({0, 0, -0.002}), dt);
    floor.friction.dynamic = 0;
    ASSERT_TRUE(scene.update({0, 1}, floor));
    for (int i = 0; i < 50; ++i) scene.evaluate(at({1e-4 * i, 0, -0.002}), dt);
    floor.friction.dynamic = 1;
    ASSERT_TRUE(scene.update({0, 1}, floor));
    EXPECT_EQ(scene.evaluate(at({0.005, 0, -0.002}), dt).force.x(), 0);
    EXPECT_NEAR(scene.evaluate(at({0.0055, 0, -0.002}), dt).force.x(), -0.5, 1e-12);
}
