// Shapes (meshes, height fields) that touch each other, or other surfaces that can be entered and left, hold
// the hand like one.

#include <iostream>

#include <knurl/geometry/proxy.hpp>

#include "count_allocations.hpp"
#include "seam_tools.hpp"

namespace seams_tests {
namespace {

struct Two {
    Kind a, b;
};

constexpr Two side_by_side[] = {{Kind::mesh, Kind::mesh},        {Kind::mesh, Kind::box},
                                {Kind::box, Kind::mesh},         {Kind::mesh, Kind::polygon},
                                {Kind::polygon, Kind::mesh},     {Kind::mesh, Kind::half_plane},
                                {Kind::half_plane, Kind::mesh},  {Kind::height_field, Kind::height_field},
                                {Kind::height_field, Kind::box}, {Kind::mesh, Kind::height_field}};
constexpr Two floors_with_walls[] = {
    {Kind::mesh, Kind::mesh},        {Kind::mesh, Kind::box},
    {Kind::box, Kind::mesh},         {Kind::mesh, Kind::polygon},
    {Kind::polygon, Kind::mesh},     {Kind::mesh, Kind::half_plane},
    {Kind::half_plane, Kind::mesh},  {Kind::mesh, Kind::plane},
    {Kind::plane, Kind::mesh},       {Kind::height_field, Kind::height_field},
    {Kind::height_field, Kind::box}, {Kind::height_field, Kind::mesh}};

template <class Try>
void each_pair(std::span<const Two> pairs, const char* what, Try&& one) {
    for (const Two& pair : pairs) {
        Rng rng(seed() + 16 * static_cast<std::uint64_t>(pair.a) + static_cast<std::uint64_t>(pair.b));
        Counts counts;
        one(pair.a, pair.b, rng, counts);
        std::cout << names[int(pair.a)] << what << names[int(pair.b)] << ": " << counts
                  << ", KNURL_SEED=" << seed() << '\n';
        EXPECT_EQ(counts.lost, 0u) << names[int(pair.a)] << what << names[int(pair.b)];
        EXPECT_GT(counts.approaches, 100u);
    }
}

}  // namespace

TEST(SeamsOfShapes, AHandSlidesOnToWhatTouches) {
    each_pair(side_by_side, " to ",
              [](Kind a, Kind b, Rng& rng, Counts& counts) { across(a, b, approaches(300), rng, counts); });
}

TEST(SeamsOfShapes, AHandInACornerIsHeldByBoth) {
    each_pair(floors_with_walls, " with ", [](Kind a, Kind b, Rng& rng, Counts& counts) {
        into_a_corner(a, b, approaches(300), rng, counts);
    });
}

// The order of addition makes no difference; a cycle in which no time passes repeats the answer, and so does
// another run.
TEST(SeamsOfShapes, NeitherOrderNorRepetitionMakesADifference) {
    Rng rng(seed());
    for (int round = 0; round < 300; ++round) {
        const Two pair = side_by_side[static_cast<std::size_t>(between(rng, 0, std::size(side_by_side) - 1))];
        const Pose pose = any_pose(rng);
        Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {little(rng, 0), -0.04, 0}, {0.05, 0.04, 0}};
        b.pose.shift = pose({0, 0, little(rng, 0)});
        Forms forms;
        Scene one = room(), other = room(), again = room();
        add(one, 0, pair.a, a, 0.01, true, forms);
        add(one, 1, pair.b, b, 0.01, false, forms);
        add(again, 0, pair.a, a, 0.01, true, forms);
        add(again, 1, pair.b, b, 0.01, false, forms);
        add(other, 0, pair.b, b, 0.01, false, forms);
        add(other, 1, pair.a, a, 0.01, true, forms);
        const double speed = log_uniform(rng, 1e-3, 0.3);
        for (int i = -20; i < 60; ++i) {
            SCOPED_TRACE("seed " + std::to_string(seed()) + " round " + std::to_string(round) + " cycle " +
                         std::to_string(i));
            const Vector p(0.3 * speed * dt * (std::abs(i - 20) - 20), 1e-4, i < -10 ? 1e-3 : -2e-3);
            const Probe probe = at(pose(p));
            const Wrench felt = one.evaluate(probe, dt);
            ASSERT_TRUE(knurl::test::same_bits(felt, one.evaluate(probe, 0)));
            ASSERT_TRUE(knurl::test::same_bits(felt, again.evaluate(probe, dt)));
            ASSERT_LE((felt.force - other.evaluate(probe, dt).force).norm(), 1e-9);
            if (i > 0) {
                ASSERT_GT(felt.force.norm(), 1.9);
            }
        }
    }
}

// Two tables on one belt, which turns as it moves.
TEST(SeamsOfShapes, WhatMovesAndTurnsTogetherHoldsLikeOne) {
    Rng rng(seed());
    for (int round = 0; round < 200; ++round) {
        const Pose pose = any_pose(rng);
        const Vector spin = pose.turn * Vector(0, 0, uniform(rng, -3, 3));
        const Vector belt = pose.turn * Vector(uniform(rng, -0.2, 0.2), uniform(rng, -0.2, 0.2), 0);
        const double gap = little(rng, 0);
        Forms forms;
        Scene scene = room();
        for (std::uint32_t i = 0; i < 2; ++i) {
            const Face face{pose, {i == 0 ? -0.05 : gap, -0.05, 0}, {i == 0 ? 0 : 0.05, 0.05, 0}};
            forms.push_back(mesh_of(face, 0.01, 2, {Eigen::Quaterniond::Identity(), Vector::Zero()}));
            scene.set_asset(i + 1, forms.back().get());
            ASSERT_TRUE(scene.add({i, 1}, Shape{.asset = i + 1,
                                                .position = to_plain(pose.shift),
                                                .orientation = to_plain(pose.turn),
                                                .velocity = to_plain(belt),
                                                .angular_velocity = to_plain(spin),
                                                .stiffness = k}));
        }
        for (int i = 0; i < 200; ++i) {
            const Eigen::Quaterniond turned =
                spin.norm() > 0
                    ? Eigen::Quaterniond(Eigen::AngleAxisd(spin.norm() * dt * i, spin.normalized())) *
                          pose.turn
                    : pose.turn;
            const Vector local(4e-3 * std::sin(0.05 * i), 2e-3, std::max(-3e-3, 1e-3 - 1e-4 * i));
            const Vector force = turned.conjugate() *
                                 scene.evaluate(at(turned * local + pose.shift + dt * i * belt), dt).force;
            ASSERT_LE((force - Vector(0, 0, k * std::max(0.0, -local.z()))).norm(), 1e-9)
                << "seed " << seed() << " round " << round << " cycle " << i;
        }
    }
}

TEST(SeamsOfShapes, ABallSlidesOnToWhatTouches) {
    Rng rng(seed());
    for (int round = 0; round < 500 && !HasFailure(); ++round) {
        const Two pair = side_by_side[static_cast<std::size_t>(between(rng, 0, std::size(side_by_side) - 1))];
        roll_over_a_seam(pair.a, pair.b, 6e-5, rng);
    }
}

// A softer plane rises through the top of a stiff shape that holds the hand: the shape holds as before, as
// long as the proxy is over it.
TEST(SeamsOfShapes, AStifferShapeHoldsOnWhileASofterPlaneLiftsTheProxyOffIt) {
    Rng rng(seed());
    constexpr double soft = 400;
    for (int round = 0; round < 200; ++round) {
        const Pose pose = any_pose(rng);
        const Face face{pose, {-0.05, -0.05, 0}, {0.05, 0.05, 0}};
        Forms forms;
        Scene scene = room();
        add(scene, 0, between(rng, 0, 1) ? Kind::mesh : Kind::height_field, face, 0.02, true, forms);
        const Vector up = pose.turn * Vector::UnitZ();
        Plane plane{.normal = to_plain(up), .offset = up.dot(pose.shift) - 0.02, .stiffness = soft};
        ASSERT_TRUE(scene.add({1, 1}, plane));
        const double deep = uniform(rng, 1e-3, 3e-3), most = uniform(rng, 1e-4, 3e-3),
                     speed = log_uniform(rng, 1e-3, 0.3), y = uniform(rng, -0.04, 0.04);
        for (int i = 0; i < 60; ++i) {
            const double rises = -0.02 + (0.02 + most) * std::sin(0.06 * std::max(0, i - 10));
            plane.offset = up.dot(pose.shift) + rises;
            ASSERT_TRUE(scene.update({1, 1}, plane));
            const Vector p(speed * dt * i - 0.02, y, i < 5 ? 1e-3 : -deep);
            const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
            const double want = i < 5 ? 0 : soft * std::max(deep, deep + rises) + (k - soft) * deep;
            ASSERT_LE((force - Vector(0, 0, want)).norm(), 1e-9)
                << "seed " << seed() << " round " << round << " cycle " << i << " rises " << rises << " deep "
                << deep << " m";
        }
    }
}

// The hand lands so near to the rim that the side is nearer than the face, and moves inwards past a corner of
// triangles.
TEST(SeamsOfShapes, ByACornerOfTheRimAFaceHoldsWhatSlidesInwards) {
    Rng rng(seed());
    for (int round = 0; round < 500; ++round) {
        const Pose pose = any_pose(rng);
        const double step = little(rng, 0.02);
        Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {0, -0.05, 0}, {0.05, 0.05, 0}};
        b.pose.shift = pose({0, 0, step});
        Forms forms;
        Scene scene = room();
        add(scene, 0, between(rng, 0, 1) ? Kind::box : Kind::polygon, a, 0.01, true, forms);
        forms.push_back(mesh_of(b, 0.01, 4, {Eigen::Quaterniond::Identity(), Vector::Zero()}));
        scene.set_asset(2, forms.back().get());
        ASSERT_TRUE(scene.add({1, 1}, Shape{.asset = 2,
                                            .position = to_plain(b.pose.shift),
                                            .orientation = to_plain(b.pose.turn),
                                            .stiffness = k}));
        const double deep = uniform(rng, 1e-3, 4e-3), past = uniform(rng, 0, 2e-4);
        const double way = log_uniform(rng, 2e-5, 3e-4), angle = uniform(rng, -1.5, 1.5);
        const double corner = 0.025 * between(rng, -1, 1), side = std::sin(angle) > 0 ? -1 : 1;
        Vector p(log_uniform(rng, 1e-11, 1e-6), corner + side * past, 1e-3);
        for (int i = 0; i < 40; ++i) {
            p.z() = std::max(-deep, 1e-3 - 3e-4 * i);
            if (i > 20) p += way * Vector(std::cos(angle), std::sin(angle), 0);
            const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
            const double least = k * std::max(0.0, std::min(0.0, step) - p.z()),
                         most = k * std::max(0.0, std::max(0.0, step) - p.z());
            ASSERT_LE(std::max({std::hypot(force.x(), force.y()), least - force.z(), force.z() - most}), 1e-9)
                << force.transpose() << " N at " << p.transpose() << " m, step " << step << "; seed "
                << seed() << " round " << round << " cycle " << i;
        }
    }
}

// A floor that ends a few nanometres before the wall on it, and a hand that is pressed into both for long and
// then returns to the gap between the two.
TEST(SeamsOfShapes, TheRimOfAFloorDoesNotTurnItBeforeAWall) {
    Rng rng(seed());
    for (int round = 0; round < 500; ++round) {
        const Pose pose = any_pose(rng);
        const double gap = log_uniform(rng, 5e-10, 1e-8), deep = uniform(rng, 1e-3, 5e-3);
        const double y = uniform(rng, -1e-6, 1e-6);  // near a corner of the floor's triangles, if there is
                                                     // one
        Forms forms;
        Scene scene = room();
        add(scene, 0, between(rng, 0, 1) ? Kind::mesh : Kind::height_field,
            {pose, {-0.05, -0.05, 0}, {-gap, 0.05, 0}}, 0.01, true, forms);
        ASSERT_TRUE(scene.add({1, 1}, Box{.center = to_plain(pose({0.02, 0, 0})),
                                          .orientation = to_plain(pose.turn),
                                          .half_size = {0.02, 0.05, 0.03},
                                          .stiffness = k}));
        for (int i = 0; i < 60; ++i) {
            const double z = i < 5 ? 1e-3 : -deep;
            const double x = i < 10 ? -2e-3 : i < 50 ? 2e-3 : -gap * uniform(rng, 0, 1);
            const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose({x, y, z})), dt).force;
            const Vector want = k * Vector(-std::max(0.0, x), 0, std::max(0.0, -z));
            ASSERT_LE((force - want).norm(), 1e-9) << force.transpose() << " N, gap " << gap << ", seed "
                                                   << seed() << " round " << round << " cycle " << i;
        }
    }
}

TEST(SeamsOfShapes, NothingIsAllocatedOnTheWay) {
    const Pose pose{Eigen::Quaterniond::Identity(), Vector::Zero()};
    const Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {0, -0.05, 0}, {0.05, 0.05, 0}};
    Forms forms;
    Scene scene = room();
    add(scene, 0, Kind::mesh, a, 0.01, true, forms);
    add(scene, 1, Kind::mesh, b, 0.01, false, forms);
    scene.evaluate(at({-4e-3, 0, 1e-3}), dt);
    const auto before = knurl::test::allocations();
    Vector force;
    for (int i = 0; i < 100; ++i) force = scene.evaluate(at({-4e-3 + 8e-5 * i, 1e-4, -2e-3}), dt).force;
    EXPECT_EQ(knurl::test::allocations(), before);
    EXPECT_LE((force - Vector(0, 0, 2)).norm(), 1e-9);
}

// A dome cut in two, as two meshes whose rims have the same corners, against the whole dome. Where the whole
// lets the hand jump from facet to facet, the two may do so earlier or later by a seam (1e-4 of the size).
TEST(SeamsOfShapes, TheHalvesOfADomeHoldLikeTheWhole) {
    Rng rng(seed());
    constexpr int rings = 40, around = 80;
    const auto part = [&](int from, int to) {
        MadeMesh dome;
        constexpr double radius = 0.08;
        for (int i = 0; i <= rings; ++i) {
            for (int j = from; j <= to; ++j) {
                const double u = -0.04 + 0.08 * i / rings, v = -0.04 + 0.08 * j / around;
                dome.vertices.push_back({v, u, std::sqrt(radius * radius - u * u - v * v) - radius});
            }
        }
        const auto width = static_cast<std::uint32_t>(to - from + 1);
        for (std::uint32_t i = 0; i < rings; ++i) {
            for (std::uint32_t j = 0; j + 1 < width; ++j) {
                const std::uint32_t c = i * width + j;
                dome.triangles.push_back({c, c + 1, c + width + 1});
                dome.triangles.push_back({c, c + width + 1, c + width});
            }
        }
        return std::make_unique<Mesh>(
            Triangles{.vertices = dome.vertices, .triangles = dome.triangles, .materials = {}},
            MeshBuild{.exact = true});
    };
    const std::unique_ptr<Mesh> whole = part(0, around), left = part(0, around / 2),
                                right = part(around / 2, around);
    double worst = 0, sum = 0;
    std::uint64_t cycles = 0, lost = 0;
    for (std::uint64_t hand_count = 0; hand_count < approaches(300); ++hand_count) {
        const Pose pose = any_pose(rng);
        Scene one = room(), two = room();
        one.set_asset(1, whole.get());
        two.set_asset(1, left.get());
        two.set_asset(2, right.get());
        Shape shape{
            .asset = 1, .position = to_plain(pose.shift), .orientation = to_plain(pose.turn), .stiffness = k};
        ASSERT_TRUE(one.add({0, 1}, shape));
        ASSERT_TRUE(two.add({0, 1}, shape));
        shape.asset = 2;
        ASSERT_TRUE(two.add({1, 1}, shape));
        const double deep = uniform(rng, 1e-3, 3e-3), speed = log_uniform(rng, 3e-3, 0.3),
                     angle = uniform(rng, -1.2, 1.2);
        const double side = between(rng, 0, 1) ? 1 : -1, y = uniform(rng, -0.01, 0.01);
        const auto over = [&](double x, double along, double height) {
            const Vector foot = Vector(x, y + along, 0);
            const double z = std::sqrt(0.08 * 0.08 - foot.squaredNorm());
            return Vector(Vector(foot.x(), foot.y(), z) * (1 + height / 0.08) - Vector(0, 0, 0.08));
        };
        const double far = std::max(2e-3, 20 * speed * dt);
        for (int i = 0; i <= 40; ++i) {
            const Probe probe = at(pose(over(-side * far, 0, 1e-3 - (deep + 1e-3) * i / 40)));
            one.evaluate(probe, dt);
            two.evaluate(probe, dt);
        }
        const int steps = static_cast<int>(2 * far / (speed * dt)) + 1;
        bool held = true;
        for (int i = 0; i <= steps; ++i) {
            const double x = side * far * (2.0 * i / steps - 1);
            const Probe probe = at(pose(over(x, 0.3 * std::sin(angle) * (x + side * far), -deep)));
            const Vector want = one.evaluate(probe, dt).force, got = two.evaluate(probe, dt).force;
            const double off = (got - want).norm();
            worst = std::max(worst, off);
            sum += off;
            ++cycles;
            held = held && got.norm() > want.norm() / 2;
        }
        lost += !held;
    }
    std::cout << cycles << " cycles, " << lost << " lost, farthest from the whole " << worst << " N, mean "
              << sum / double(cycles) << " N, KNURL_SEED=" << seed() << '\n';
    EXPECT_EQ(lost, 0u);
    EXPECT_LE(worst, 0.2);
    EXPECT_LE(sum / double(cycles), 0.01);
}

}  // namespace seams_tests
