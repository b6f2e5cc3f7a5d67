// What touches holds the hand like one: a hand that is pressed into a surface and slides on to its neighbour, or
// against a wall that stands on it. The judge is the god-object of the union in closed form, and shares nothing
// with reps/.
//
// KNURL_APPROACHES: how many of each kind of seam (scripts/approaches: a million in all).

#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace seams_tests {
namespace {

constexpr double k = 1000;      // N/m
constexpr double touch = 1e-4;  // of the size: what touches
constexpr double hand = 1e-5;   // m: of what has no size

std::uint64_t approaches(std::uint64_t usual) {
    const char* asked = std::getenv("KNURL_APPROACHES");
    return asked ? std::strtoull(asked, nullptr, 10) : usual;
}

std::uint64_t seed() {
    const char* asked = std::getenv("KNURL_SEED");
    return asked ? std::strtoull(asked, nullptr, 10) : 1;
}

enum class Kind { box, polygon, half_plane };
constexpr std::array all_kinds{Kind::box, Kind::polygon, Kind::half_plane};
constexpr const char* names[] = {"box", "polygon", "half_plane"};

/// All of a test in a random pose.
struct Pose {
    Eigen::Quaterniond turn;
    Vector shift;
    Vector operator()(const Vector& p) const { return turn * p + shift; }
};

/// A face in z = 0 of this frame, the rectangle low ... high of x and y; free is z > 0.
struct Face {
    Pose pose;
    Vector low, high;
    double size() const { return (high - low).cwiseAbs().maxCoeff(); }
};

/// `edge_is_high`: of a half-plane, that it ends at high.x and not at low.x.
template <class Put>
void put(Kind kind, const Face& face, double thick, bool edge_is_high, Put&& put) {
    const Vector &low = face.low, &high = face.high;
    if (kind == Kind::box) {
        const Vector middle((low.x() + high.x()) / 2, (low.y() + high.y()) / 2, -thick / 2);
        put(Box{.center = to_plain(face.pose(middle)),
                .orientation = to_plain(face.pose.turn),
                .half_size = {(high.x() - low.x()) / 2, (high.y() - low.y()) / 2, thick / 2},
                .stiffness = k});
    } else if (kind == Kind::polygon) {
        Polygon polygon{.stiffness = k};
        polygon.vertices.count = 4;
        polygon.vertices.at[0] = to_plain(face.pose({low.x(), low.y(), 0}));
        polygon.vertices.at[1] = to_plain(face.pose({high.x(), low.y(), 0}));
        polygon.vertices.at[2] = to_plain(face.pose({high.x(), high.y(), 0}));
        polygon.vertices.at[3] = to_plain(face.pose({low.x(), high.y(), 0}));
        put(polygon);
    } else {
        const Vector normal = face.pose.turn * Vector::UnitZ();
        const Vector edge = face.pose.turn * Vector(edge_is_high ? 1 : -1, 0, 0);
        const Vector on = face.pose({edge_is_high ? high.x() : low.x(), 0, 0});
        put(HalfPlane{.normal = to_plain(normal),
                      .offset = normal.dot(face.pose.shift),
                      .edge = to_plain(edge),
                      .edge_offset = edge.dot(on),
                      .stiffness = k});
    }
}

void add(Scene& scene, std::uint32_t slot, Kind kind, const Face& face, double thick, bool edge_is_high) {
    put(kind, face, thick, edge_is_high, [&](const auto& surface) {
        ASSERT_TRUE(scene.add({slot, 1}, surface));
    });
}

struct Counts {
    std::uint64_t approaches = 0, cycles = 0, lost = 0;
    double worst = 0;  // N, beyond what the judge allows
};
std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << c.approaches << " approaches, " << c.cycles << " cycles, " << c.lost
               << " lost, farthest from the judge " << c.worst << " N";
}

double log_uniform(Rng& rng, double low, double high) {
    return scale(rng, low, high);
}

/// 0, or from 1e-9 to 1e-4 of the size, of either sign.
double little(Rng& rng, double size_or_zero) {
    if (between(rng, 0, 3) == 0) return 0;
    const double most = size_or_zero > 0 ? touch * size_or_zero : hand;
    const double some = log_uniform(rng, 1e-5, 0.99) * most;
    return between(rng, 0, 1) ? some : -some;
}

Pose any_pose(Rng& rng) {
    if (between(rng, 0, 3) == 0) return {Eigen::Quaterniond::Identity(), Vector::Zero()};
    return {turn(rng), uniform(rng, 0, 0.2) * direction(rng)};
}

Scene room() {
    Scene scene({.representations = 4, .probes = 1}, {});
    scene.set_fade({.automatic = 0, .rise_speed = infinity});
    return scene;
}

double touching(Kind a, double size_a, Kind b, double size_b) {
    const double first = a == Kind::half_plane ? infinity : size_a;
    const double second = b == Kind::half_plane ? infinity : size_b;
    const bool sized = a != Kind::half_plane && b != Kind::half_plane;
    const double least = std::min(first, second);
    return sized ? least : std::min(least, hand / touch);
}

/// One hand goes on to `goal` at this speed; `judge` says of each cycle how far the force is off (N).
template <class Judge>
bool slide(Scene& scene, const Pose& pose, Vector& p, const Vector& goal, double speed, Judge&& judge,
           Counts& counts) {
    const Vector from = p;
    const int cycles = std::max(1, static_cast<int>(std::ceil((goal - from).norm() / (speed * dt))));
    bool held = true;
    for (int i = 1; i <= cycles; ++i) {
        p = from + (goal - from) * (double(i) / cycles);
        const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
        const double off = judge(p, force);
        ++counts.cycles;
        counts.worst = std::max(counts.worst, off);
        held = held && !(off > 1e-6);
    }
    return held;
}

/// Two faces in a plane, A in x < 0, B in x > 0, but for a gap and a step.
void across(Kind kind_a, Kind kind_b, std::uint64_t count, Rng& rng, Counts& counts) {
    constexpr int hands = 20;
    while (counts.approaches < count) {
        const Pose pose = any_pose(rng);
        Face a{pose, {-log_uniform(rng, 0.02, 0.1), -log_uniform(rng, 0.02, 0.1), 0}, {0, 0, 0}};
        Face b{pose, {0, 0, 0}, {log_uniform(rng, 0.02, 0.1), 0, 0}};
        a.high.y() = log_uniform(rng, 0.02, 0.1);
        const bool same_width = between(rng, 0, 1);
        b.low.y() = same_width ? a.low.y() : -log_uniform(rng, 0.02, 0.1);
        b.high.y() = same_width ? a.high.y() : log_uniform(rng, 0.02, 0.1);
        const double size = touching(kind_a, a.size(), kind_b, b.size());
        const double gap = little(rng, size), step = little(rng, size);  // < 0: they overlap; B is lower
        b.low.x() += gap;
        b.pose.shift = pose({0, 0, step});
        Scene scene = room();
        add(scene, 0, kind_a, a, log_uniform(rng, 5e-4, 0.05), true);
        add(scene, 1, kind_b, b, log_uniform(rng, 5e-4, 0.05), false);
        const double near = std::abs(gap) + 2.1 * std::max({touch * a.size(), touch * b.size(), hand});
        for (int i = 0; i < hands; ++i) {
            const double deep = uniform(rng, 1e-3, 5e-3), speed = log_uniform(rng, 1e-3, 0.3);
            const double angle = uniform(rng, -1.3, 1.3), y = uniform(rng, -5e-3, 5e-3);
            // One of four comes down on what is between them.
            const double ahead = between(rng, 0, 3) == 0
                                     ? std::abs(gap) * uniform(rng, -1, 1)
                                     : std::max(20 * speed * dt, near) * uniform(rng, 0.5, 1);
            const bool back = between(rng, 0, 1);
            const Vector way = (back ? -1 : 1) * Vector(std::cos(angle), std::sin(angle), 0);
            const auto judge = [&](const Vector& p, const Vector& force) {
                // Where they touch it may be either, or what is between them.
                const double low = p.x() > near ? step : p.x() < -near ? 0 : std::min(0.0, step);
                const double high = p.x() > near ? step : p.x() < -near ? 0 : std::max(0.0, step);
                const double sideways = std::hypot(force.x(), force.y());
                const double least = k * std::max(0.0, low - p.z()), most = k * std::max(0.0, high - p.z());
                return std::max({sideways, least - force.z(), force.z() - most});
            };
            Vector p = Vector(0, y, 1e-3) - ahead / std::cos(angle) * way;
            const double far = std::max(20 * speed * dt, near);
            const Vector end = p + (ahead + far) / std::cos(angle) * way;
            if (std::abs(p.y()) > 0.019 || std::abs(end.y()) > 0.019) continue;
            scene.evaluate(at(pose(p)), dt);
            bool held = slide(scene, pose, p, {p.x(), p.y(), -deep}, 0.3, judge, counts);
            held = slide(scene, pose, p, p + (ahead + far) / std::cos(angle) * way, speed, judge, counts) &&
                   held;
            const double rest = (p.x() < 0 ? -5e-3 : 5e-3) - p.x();
            if (std::abs(p.x()) < 5e-3)
                held = slide(scene, pose, p, p + Vector(rest, 0, 0), 0.3, judge, counts) && held;
            held = slide(scene, pose, p, {p.x(), p.y(), 1e-3}, 0.3, judge, counts) && held;
            ++counts.approaches;
            counts.lost += !held;
            if (!held && counts.lost <= 3)
                std::cout << "lost: " << names[int(kind_a)] << " to " << names[int(kind_b)] << ", gap " << gap
                          << " m, step " << step << " m, sizes " << a.size() << " " << b.size() << " m, deep "
                          << deep << " m, speed " << speed << " m/s, angle " << angle << ", back " << back
                          << ", worst " << counts.worst << '\n';
        }
    }
}

/// A floor in z = 0, x < 0, and a wall in x = 0 that stands on it and faces it.
void into_a_corner(Kind floor_kind, Kind wall_kind, std::uint64_t count, Rng& rng, Counts& counts) {
    constexpr int hands = 20;
    while (counts.approaches < count) {
        const Pose pose = any_pose(rng);
        const bool under = between(rng, 0, 1);  // the floor goes on under the wall
        Face floor{pose, {-log_uniform(rng, 0.03, 0.1), -log_uniform(rng, 0.02, 0.1), 0}, {0, 0, 0}};
        floor.high.y() = log_uniform(rng, 0.02, 0.1);
        // Its frame: x down, z towards the floor's middle.
        Face wall{pose, {-log_uniform(rng, 0.03, 0.1), -log_uniform(rng, 0.02, 0.1), 0}, {0, 0, 0}};
        wall.high.y() = log_uniform(rng, 0.02, 0.1);
        Eigen::Matrix3d axes;
        axes.col(0) = -Vector::UnitZ();
        axes.col(1) = -Vector::UnitY();
        axes.col(2) = -Vector::UnitX();
        wall.pose.turn = pose.turn * Eigen::Quaterniond(axes);
        const double size = touching(floor_kind, floor.size(), wall_kind, wall.size());
        const double gap = little(rng, size), lift = little(rng, size);
        floor.high.x() = under ? 0.02 : gap;
        wall.high.x() = lift;  // < 0: its lower edge is above the floor
        Scene scene = room();
        add(scene, 0, floor_kind, floor, log_uniform(rng, 5e-4, 0.05), true);
        add(scene, 1, wall_kind, wall, log_uniform(rng, 5e-4, 0.05), true);
        for (int i = 0; i < hands; ++i) {
            const double deep = uniform(rng, 1e-3, 5e-3), speed = log_uniform(rng, 1e-3, 0.3);
            const double angle = uniform(rng, -1.3, 1.3), y = uniform(rng, -5e-3, 5e-3);
            const double ahead = std::max(20 * speed * dt, 3e-5) * uniform(rng, 0.5, 1);
            const Vector way(std::cos(angle), std::sin(angle), 0);
            const auto judge = [&](const Vector& p, const Vector& force) {
                return (force - k * Vector(-std::max(0.0, p.x()), 0, std::max(0.0, -p.z()))).norm();
            };
            Vector p = Vector(0, y, 1e-3) - ahead / std::cos(angle) * way;
            if (std::abs(p.y()) > 0.019) continue;
            scene.evaluate(at(pose(p)), dt);
            bool held = slide(scene, pose, p, {p.x(), p.y(), -deep}, 0.3, judge, counts);
            const Vector end = p + 2 * ahead / std::cos(angle) * way;
            if (std::abs(end.y()) > 0.019) continue;
            held = slide(scene, pose, p, end, speed, judge, counts) && held;
            held = slide(scene, pose, p, {4e-3, p.y(), -4e-3}, 0.3, judge, counts) && held;
            held = slide(scene, pose, p, {-2e-3, p.y(), -4e-3}, 0.3, judge, counts) && held;
            held = slide(scene, pose, p, {-2e-3, p.y(), 1e-3}, 0.3, judge, counts) && held;
            ++counts.approaches;
            counts.lost += !held;
            if (!held && counts.lost <= 3)
                std::cout << "lost: " << names[int(wall_kind)] << " on " << names[int(floor_kind)] << ", gap "
                          << gap << " m, lift " << lift << " m, under " << under << ", deep " << deep
                          << " m, speed " << speed << " m/s, angle " << angle << ", worst " << counts.worst
                          << '\n';
        }
    }
}

template <class Try>
void all_pairs(const char* what, Try&& one) {
    for (const Kind a : all_kinds) {
        for (const Kind b : all_kinds) {
            Rng rng(seed() + 16 * static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
            Counts counts;
            one(a, b, rng, counts);
            std::cout << names[int(a)] << what << names[int(b)] << ": " << counts << ", KNURL_SEED=" << seed()
                      << '\n';
            EXPECT_EQ(counts.lost, 0u) << names[int(a)] << what << names[int(b)];
            EXPECT_GT(counts.approaches, 100u);
        }
    }
}

}  // namespace

TEST(Seams, AHandSlidesOnToWhatTouches) {
    all_pairs(" to ",
              [](Kind a, Kind b, Rng& rng, Counts& counts) { across(a, b, approaches(1100), rng, counts); });
}

TEST(Seams, AHandInACornerIsHeldByBoth) {
    all_pairs(" with ", [](Kind a, Kind b, Rng& rng, Counts& counts) {
        into_a_corner(a, b, approaches(1100), rng, counts);
    });
}

// Which is added first makes no difference.
TEST(Seams, TheOrderOfSurfacesMakesNoDifference) {
    Rng rng(seed());
    for (int round = 0; round < 300; ++round) {
        const Kind kind_a = all_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Kind kind_b = all_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Pose pose = any_pose(rng);
        Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {little(rng, 0), -0.04, 0}, {0.05, 0.04, 0}};
        b.pose.shift = pose({0, 0, little(rng, 0)});
        Scene one = room(), other = room();
        add(one, 0, kind_a, a, 0.01, true);
        add(one, 1, kind_b, b, 0.01, false);
        add(other, 0, kind_b, b, 0.01, false);
        add(other, 1, kind_a, a, 0.01, true);
        const double speed = log_uniform(rng, 1e-3, 0.3);
        for (int i = -20; i < 60; ++i) {
            const Vector p(0.3 * speed * dt * (std::abs(i - 20) - 20), 1e-4, i < -10 ? 1e-3 : -2e-3);
            const Vector force = one.evaluate(at(pose(p)), dt).force;
            ASSERT_LE((force - other.evaluate(at(pose(p)), dt).force).norm(), 1e-9)
                << "seed " << seed() << " round " << round << " cycle " << i;
            if (i > 0) {
                ASSERT_GT(force.norm(), 1.9) << "seed " << seed() << " round " << round << " cycle " << i;
            }
        }
    }
}

// Two tables on one belt, and sent anew 30 times a second with what the application's clock is off by.
TEST(Seams, WhatMovesAndIsSentAnewHoldsLikeOne) {
    Rng rng(seed());
    for (int round = 0; round < 200; ++round) {
        const Kind kinds[] = {all_kinds[static_cast<std::size_t>(between(rng, 0, 2))],
                              all_kinds[static_cast<std::size_t>(between(rng, 0, 2))]};
        const Pose pose = any_pose(rng);
        const Vector belt(uniform(rng, -0.2, 0.2), uniform(rng, -0.2, 0.2), uniform(rng, -0.05, 0.05));
        const bool anew = between(rng, 0, 1);
        const double gap = little(rng, 0);
        Scene scene = room();
        scene.set_fade({.automatic = 0.01, .rise_speed = infinity});
        const auto tell = [&](double time, bool first) {
            for (std::uint32_t i = 0; i < 2; ++i) {
                Face face{pose, {i == 0 ? -0.05 : gap, -0.05, 0}, {i == 0 ? 0 : 0.05, 0.05, 0}};
                face.pose.shift = pose(time * belt);
                put(kinds[i], face, 0.01, i == 0, [&](auto surface) {
                    surface.velocity = to_plain(pose.turn * belt);
                    ASSERT_TRUE(first ? scene.add({i, 1}, surface) : scene.update({i, 1}, surface));
                });
            }
        };
        tell(0, true);
        const double y = uniform(rng, -5e-3, 5e-3);
        for (int i = 0; i < 200; ++i) {
            if (anew && i % 33 == 32) tell(dt * i, false);
            const double x = 4e-3 * std::sin(0.05 * i), z = std::max(-3e-3, 1e-3 - 1e-4 * i);
            // In the cycle that takes it a surface is where it was told to be, and moves on from there.
            const Vector p = Vector(x, y, z) + dt * i * belt;
            const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
            // An update says where it is in the next cycle.
            const double slack = k * (2e-5 + (anew ? dt * belt.norm() : 0));
            ASSERT_LE((force - Vector(0, 0, k * std::max(0.0, -z))).norm(), slack)
                << "seed " << seed() << " round " << round << " cycle " << i;
        }
    }
}

// A ball rolls over what is between them, and is pushed aside no farther than the way over the step is long. Where its
// centre has not entered, what it overlaps at once is taken for planes at its feet, which lean more the nearer the edge
// is: there it is held by half of its depth at least, and pushed by no more than that.
TEST(Seams, ABallSlidesOnToWhatTouches) {
    Rng rng(seed());
    double worst = 0;
    for (int round = 0; round < 1500; ++round) {
        const Kind kind_a = all_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Kind kind_b = all_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Pose pose = any_pose(rng);
        const double gap = little(rng, 0), step = little(rng, 0);
        Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {gap, -0.05, 0}, {0.05, 0.05, 0}};
        b.pose.shift = pose({0, 0, step});
        Scene scene = room();
        add(scene, 0, kind_a, a, 0.01, true);
        add(scene, 1, kind_b, b, 0.01, false);
        const double radius = uniform(rng, 1e-3, 5e-3), deep = uniform(rng, 1e-3, 8e-3);
        if (std::abs(radius - deep) < 3e-5) continue;  // its centre lies in the face, within touching
        ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = radius}));
        const double speed = scale(rng, 0.01, 0.3), angle = uniform(rng, -1.2, 1.2);
        Vector p(-4e-3, 0, radius + 1e-3);
        for (int i = 0; p.x() < 4e-3 && std::abs(p.y()) < 0.04; ++i) {
            if (i <= 50) {
                p.z() = radius + 1e-3 - (deep + 1e-3) * i / 50;
            } else {
                p += speed * dt * Vector(std::cos(angle), std::sin(angle), 0);
            }
            const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
            const double want = k * std::max(0.0, radius - p.z());
            const double off = (force - Vector(0, 0, want)).norm();
            const bool between_them = deep < radius && std::abs(p.x()) < 2e-3;
            const double over = std::sqrt(2 * want / k * std::abs(step) + step * step);
            const double bound = between_them ? want / 2 : k * (over + std::abs(step) + std::abs(gap));
            if (!between_them) worst = std::max(worst, off - bound);
            ASSERT_LE(off, bound + 1e-9) << "N; seed " << seed() << " round " << round << " cycle " << i;
        }
    }
    std::cout << "farthest from the judge " << worst << " N, KNURL_SEED=" << seed() << '\n';
}

// While a neighbour fades out a surface is in two sets, the one with the neighbour and the one without. Both must feel it
// alike: else its force, and with a texture even whether that is a number, would depend on which set asked last.
TEST(Seams, WhatStaysIsFeltAsItWasWhileItsNeighbourFadesOut) {
    Scene scene({.representations = 4, .probes = 1}, {});
    ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = 3e-3}));
    const Box stays{.center = {0, 0, -0.05}, .stiffness = 1000, .texture = {.amplitude = 1e-5}};
    ASSERT_TRUE(scene.add({0, 1}, stays));
    ASSERT_TRUE(scene.add({1, 1}, Box{.center = {0.16, 0, -0.05}, .stiffness = 1000, .recovery = 0.02}));
    scene.settle();
    // Over the edge of the one that stays, which the probe's centre has not entered.
    const auto evaluate = [&] { return scene.evaluate(at({0.051, 0, 0.001}), dt).force; };
    evaluate();
    const Vector before = evaluate();
    ASSERT_GT(before.norm(), 1.0);
    ASSERT_TRUE(scene.remove({1, 1}));
    for (int i = 0; i < 30; ++i) EXPECT_LE((evaluate() - before).norm(), 1e-9) << "N, cycle " << i;
    std::array<Feedback, 4> feedback;
    ASSERT_EQ(scene.feedback(feedback), 1u);
    EXPECT_TRUE(feedback[0].wrench.force.allFinite());
}

}  // namespace seams_tests
