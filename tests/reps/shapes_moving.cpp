// Moving meshes out of reach are not evaluated, and nothing else changes: compared with the same scene in
// which each is evaluated in every cycle.

#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace shapes_moving_tests {
namespace {

std::unique_ptr<Mesh> mesh_at(MadeMesh shape, const Vector& middle) {
    for (auto& v : shape.vertices)
        for (int k = 0; k < 3; ++k) v[static_cast<std::size_t>(k)] += middle[k];
    return std::make_unique<Mesh>(
        Triangles{.vertices = shape.vertices, .triangles = shape.triangles, .materials = {}},
        MeshBuild{.exact = true});
}

struct Seen {
    std::uint64_t cycles = 0, felt = 0, begun = 0, evaluated = 0, instead_of = 0;
};

/// Some shapes of 1 to 10 cm that come from all directions, most of them towards the hand. They are updated
/// at times (up to 5 mm off their present place), given another asset or none, or removed; with silences, and
/// steps of other lengths and of zero.
class Flight {
  public:
    Flight(std::uint64_t seed, double offset)
        : rng_(seed), origin_(offset, -offset, offset / 3), far_(offset > 0) {
        // Assets about their origin, beside it, and far from it.
        for (const double middle : {0.0, 0.02, 0.3, offset}) {
            meshes_.push_back(mesh_at(icosphere(2, uniform(rng_, 0.005, 0.05)), middle * direction(rng_)));
            meshes_.push_back(
                mesh_at(knurl::test::cube(3, uniform(rng_, 0.01, 0.1)), middle * direction(rng_)));
        }
        for (std::uint32_t i = 0; i < meshes_.size(); ++i) pair_.set_asset(i + 1, meshes_[i].get());
        if (between(rng_, 0, 1)) {
            const ProbePlacement finger{.offset = {}, .radius = uniform(rng_, 0, 0.008)};
            (void)pair_.place_probe(0, finger);
        }
        hand_ = at(origin_);
        for (std::uint32_t i = 0; i < slots; ++i) add(i);
    }

    void fly(int cycles, Seen& seen) {
        bool before = false, silent = false;
        double step = 0;
        for (int i = 0; i < cycles; ++i) {
            change();
            move_hand();
            // After a zero step, or after silence, a period: the scene assumes it for the first step of a new
            // surface.
            const bool other = between(rng_, 0, 30) == 0 && step > 0 && !silent && silent_ <= 0;
            silent = silent_ > 0;
            step = !other ? dt : between(rng_, 0, 1) ? 0 : uniform(rng_, 0, 0.01);
            const Vector want = pair_.exhaustive.evaluate(hand_, step).force,
                         got = pair_.skipping.evaluate(hand_, step).force;
            // With one 1000 km away, 1e-10 m is one bit.
            ASSERT_LE((got - want).norm(), (far_ ? 1e-5 : 1e-9) * (1 + want.norm()))
                << "cycle " << i << ": " << got.transpose() << " instead of " << want.transpose();
            for (std::uint32_t k = 0; k < slots; ++k)
                if (!(silent_ > 0 && holds_[k])) since_[k] += step;
            ++seen.cycles;
            const bool felt = want.norm() > 0;
            seen.felt += felt;
            seen.begun += felt && !before;
            before = felt;
            seen.evaluated += pair_.skipping.evaluated();
            seen.instead_of += pair_.exhaustive.evaluated();
        }
    }

  private:
    static constexpr std::uint32_t slots = 12;

    /// At a place so far away that it arrives, if at all, after a second or so.
    Shape any() {
        Shape shape;
        const auto which = static_cast<std::uint32_t>(between(rng_, 0, static_cast<int>(meshes_.size()) - 1));
        shape.asset = which + 1;
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(uniform(rng_, 0, 3), direction(rng_)));
        shape.orientation = {turn.w(), turn.x(), turn.y(), turn.z()};
        const Mesh& mesh = *meshes_[which];
        const Vector middle = (mesh.low + mesh.high) / 2;
        const bool by_the_hand = between(rng_, 0, 1);
        const double speed = between(rng_, 0, 4) == 0 ? 0 : scale(rng_, 0.01, 2);
        const Vector out = direction(rng_), place = hand_.position + uniform(rng_, 0.1, 0.5) * out;
        // A shape far from its origin cannot turn about it and stay here.
        const bool turns = middle.norm() < 1 && between(rng_, 0, 1);
        shape.position = to_plain(Vector(place - turn * middle));
        // Beside it, not with its very middle over it, where all faces are equally near.
        const Vector goal = hand_.position + uniform(rng_, 0.001, 0.02) * direction(rng_);
        const Vector way = by_the_hand ? Vector((goal - place).normalized()) : direction(rng_);
        shape.velocity = to_plain(Vector(speed * way));
        if (turns) shape.angular_velocity = to_plain(Vector(scale(rng_, 0.1, 20) * direction(rng_)));
        shape.stiffness = between(rng_, 0, 1) ? 500 : 900;
        const double recoveries[] = {automatic, 0, 0.002, 0.03};
        shape.recovery = recoveries[between(rng_, 0, 3)];
        return shape;
    }
    void add(std::uint32_t i) {
        told_[i] = any();
        since_[i] = 0;
        holds_[i] = between(rng_, 0, 1) != 0;
        // None fades out in a silence: a frozen plane depends on which surfaces are weighed, and a faded one
        // forgets its path only where it may be out of reach.
        ASSERT_TRUE(
            pair_.add({i, ++generation_[i]}, told_[i],
                      {.on_silence = holds_[i] ? OnSilence::hold : OnSilence::move, .silence_time = 10}));
        there_[i] = true;
    }
    void change() {
        if (between(rng_, 0, 400) == 0) silent_ = silent_ > 0 ? 0 : 1e-3;
        if (silent_ > 0) silent_ += dt;
        pair_.each([&](Scene& scene) { scene.set_silence(silent_); });
        if (between(rng_, 0, 15) != 0) return;
        const auto i = static_cast<std::uint32_t>(between(rng_, 0, static_cast<int>(slots) - 1));
        if (!there_[i]) return add(i);
        Shape& shape = told_[i];
        switch (between(rng_, 0, 6)) {
            case 0:
                there_[i] = false;
                ASSERT_TRUE(pair_.remove({i, generation_[i]}));
                return;
            case 1:
                shape.stiffness = shape.stiffness < 600 ? 900 : 500;  // continues in its motion
                break;
            case 2:
                shape.asset = shape.asset > 0 ? 0 : 1;
                break;
            case 3:
                shape.asset = static_cast<std::uint32_t>(between(rng_, 1, 4));
                break;
            // about its present place: from farther away it would be led past the hand, not through it
            default: {
                const Vector velocity = to_eigen(shape.velocity);
                shape.position = to_plain(Vector(to_eigen(shape.position) + since_[i] * velocity +
                                                 uniform(rng_, 0, 0.005) * direction(rng_)));
                shape.velocity = to_plain(Vector(velocity + 0.05 * velocity.norm() * direction(rng_)));
                const Vector spin = to_eigen(shape.angular_velocity);
                if (const double rate = spin.norm(); rate > 0)
                    shape.orientation = to_plain(Eigen::Quaterniond(
                        Eigen::AngleAxisd(rate * since_[i] + uniform(rng_, 0, 0.01), spin / rate) *
                        to_eigen(shape.orientation)));
                since_[i] = 0;
            }
        }
        ASSERT_TRUE(pair_.update({i, generation_[i]}, shape));
    }
    void move_hand() {
        if (between(rng_, 0, 60) == 0) velocity_ = scale(rng_, 1e-3, 0.5) * direction(rng_);
        if ((hand_.position - origin_).norm() > 0.2)
            velocity_ = 0.2 * (origin_ - hand_.position).normalized();
        hand_.position += dt * velocity_;
        hand_.velocity = hand_.smooth_velocity = velocity_;
    }

    knurl::test::Rng rng_;
    ScenePair pair_{{.representations = 64, .probes = 16}, {.max_force = 20}};
    std::vector<std::unique_ptr<Mesh>> meshes_;
    const Vector origin_;
    const bool far_;
    Probe hand_;
    Vector velocity_ = Vector::Zero();
    double silent_ = 0;
    std::array<Shape, slots> told_;
    std::array<double, slots> since_{};
    std::array<std::uint32_t, slots> generation_{};
    std::array<bool, slots> there_{}, holds_{};
};

}  // namespace

TEST(MovingShapes, APoseSentAloneIsFeltAsIfAllWereSent) {
    const std::uint64_t seed = 541;
    Rng rng(seed);
    const auto mesh = mesh_at(knurl::test::cube(3, 0.05), Vector::Zero());
    Scene whole = make_scene(), pose = make_scene();
    Shape shape{.asset = 1, .stiffness = 500};
    for (Scene* scene : {&whole, &pose}) {
        scene->set_asset(1, mesh.get());
        ASSERT_TRUE(scene->add({0, 1}, shape));
    }
    int touched = 0;
    for (int i = 0; i < 5000; ++i) {
        if (i % 7 == 0) {
            shape.position = to_plain(Vector(0.03 * direction(rng)));
            shape.orientation = {1, uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
            shape.velocity = to_plain(Vector(0.1 * direction(rng)));
            shape.angular_velocity = to_plain(direction(rng));
        }
        Shape anew = shape;
        anew.texture.reserved =
            static_cast<std::uint32_t>(i + 1);  // a byte without meaning: it takes the long way
        ASSERT_TRUE(whole.update({0, 1}, anew));
        ASSERT_TRUE(pose.update({0, 1}, kind_of<Shape>, &shape, geometry_bytes<Shape>()));
        const Probe probe = at(0.03 * Vector(std::sin(0.01 * i), std::sin(0.013 * i), std::cos(0.007 * i)));
        const Wrench want = whole.evaluate(probe, dt);
        ASSERT_TRUE(same_bits(want, pose.evaluate(probe, dt))) << "seed " << seed << " cycle " << i;
        touched += !want.force.isZero();
    }
    EXPECT_GT(touched, 500);
}

TEST(MovingShapes, AnswerAsIfEachWereEvaluatedInEveryCycle) {
    Seen seen;
    // 119: a softer surface lifts the proxy off; 394: a cycle without time during a fade.
    std::vector<std::uint64_t> seeds(201, 394);
    std::iota(seeds.begin(), seeds.end() - 1, 1);
    for (const std::uint64_t seed : seeds) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Flight flight(seed, seed % 3 == 0 ? 1e6 : 0);
        ASSERT_NO_FATAL_FAILURE(flight.fly(2000, seen));
        if (HasFailure()) return;
    }
    std::printf("%llu cycles, felt in %llu, contacts begun %llu; evaluated %.2f a cycle instead of %.2f\n",
                static_cast<unsigned long long>(seen.cycles), static_cast<unsigned long long>(seen.felt),
                static_cast<unsigned long long>(seen.begun), double(seen.evaluated) / double(seen.cycles),
                double(seen.instead_of) / double(seen.cycles));
    EXPECT_GT(seen.felt * 20, seen.cycles) << "a test that hardly touches anything";
    EXPECT_GT(seen.begun, 200u);
    EXPECT_LT(seen.evaluated * 2, seen.instead_of) << "a test in which hardly anything is skipped";
}

TEST(MovingShapes, OutOfReachTheyAreNotEvaluatedNorWhileTheyFade) {
    const std::unique_ptr<Mesh> mesh = mesh_at(icosphere(2, 0.02), {0.01, 0, 0});
    Scene scene = make_scene();
    scene.set_asset(1, mesh.get());
    knurl::test::Rng rng(3);
    const auto shape = [&] {
        return Shape{.asset = 1,
                     .position = to_plain(Vector(uniform(rng, 0.2, 0.4) * direction(rng))),
                     .velocity = to_plain(Vector(0.3 * direction(rng))),
                     .angular_velocity = {0, 5, 0},
                     .stiffness = 500,
                     .recovery = 0.02};
    };
    for (std::uint32_t i = 0; i < 64; ++i) ASSERT_TRUE(scene.add({i, 1}, shape()));
    std::uint64_t evaluated = 0;
    for (int cycle = 0; cycle < 4000; ++cycle) {
        for (std::uint32_t i = 0; i < 64 && cycle % 17 == 0; ++i) {
            ASSERT_TRUE(scene.update({i, 1}, shape()));
        }
        scene.evaluate(at({0.03 * std::sin(cycle * 1e-3), 0, 0}), dt);
        evaluated += scene.evaluated();
    }
    EXPECT_EQ(evaluated, 0u);
}

// 0.5 m away at 1 m/s: not evaluated for four tenths of a second, and then in the right cycle.
TEST(MovingShapes, OneThatComesIsThereInTime) {
    const std::unique_ptr<Mesh> cube = mesh_at(knurl::test::cube(2, 0.1), Vector::Zero());
    for (const double turn : {0.0, 7.0}) {
        Scene scene = make_scene();
        scene.set_asset(1, cube.get());
        ASSERT_TRUE(scene.add({0, 1}, Shape{.asset = 1,
                                            .position = {0, 0, -0.55},
                                            .velocity = {0, 0, 1},
                                            .angular_velocity = {0, 0, turn},
                                            .stiffness = 500}));
        scene.settle();
        for (int cycle = 0; cycle < 520; ++cycle) {
            const double depth = cycle * dt - 0.5, force = scene.evaluate(at(Vector::Zero()), dt).force.z();
            ASSERT_NEAR(force, 500 * std::max(0.0, depth), 1e-9) << cycle;
            if (cycle < 400) {
                ASSERT_EQ(scene.evaluated(), 0u) << cycle;
            }
        }
    }
}

TEST(MovingShapes, WhatIsHeldInASilenceGoesOnFromThereAfterIt) {
    const std::unique_ptr<Mesh> cube = mesh_at(knurl::test::cube(2, 0.1), Vector::Zero());
    Scene scene = make_scene();
    scene.set_asset(1, cube.get());
    ASSERT_TRUE(scene.add(
        {0, 1}, Shape{.asset = 1, .position = {0, 0, -0.55}, .velocity = {0, 0, 1}, .stiffness = 500},
        {.on_silence = OnSilence::hold}));
    scene.settle();
    double told = 0;  // s, without the silence
    for (int cycle = 0; cycle < 2000; ++cycle) {
        const bool silent = cycle >= 300 && cycle < 1300;
        scene.set_silence(silent ? (cycle - 299) * dt : 0);
        if (cycle > 0 && !silent) told += dt;
        const double force = scene.evaluate(at(Vector::Zero()), dt).force.z();
        ASSERT_NEAR(force, 500 * std::max(0.0, told - 0.5), 1e-9) << cycle;
        if (told > 0.52) return;
    }
    FAIL() << "it never came";
}

}  // namespace shapes_moving_tests
