#pragma once
// Shared by the tests of touching surfaces: faces of any kind side by side, hands that slide over them, and
// the judge: the god-object of the union in closed form, which shares nothing with reps/.
//
// KNURL_APPROACHES: how many of each kind of seam (scripts/approaches: a million in all).

#include <cstdlib>
#include <iostream>
#include <memory>
#include <vector>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>

#include "scene_tools.hpp"

namespace seams_tests {
namespace {

using namespace knurl;
using knurl::test::at;
using knurl::test::between;
using knurl::test::blocks;
using knurl::test::direction;
using knurl::test::dt;
using knurl::test::infinity;
using knurl::test::MadeMesh;
using knurl::test::Rng;
using knurl::test::scale;
using knurl::test::turn;
using knurl::test::uniform;
using knurl::test::Vector;

constexpr double k = 1000;      // N/m
constexpr double touch = 1e-4;  // of the size: within it surfaces touch
constexpr double hand = 1e-5;   // m: the same for surfaces without a size

std::uint64_t approaches(std::uint64_t usual) {
    const char* asked = std::getenv("KNURL_APPROACHES");
    return asked ? std::strtoull(asked, nullptr, 10) : usual;
}

std::uint64_t seed() {
    const char* asked = std::getenv("KNURL_SEED");
    return asked ? std::strtoull(asked, nullptr, 10) : 1;
}

enum class Kind { box, polygon, half_plane, mesh, height_field, plane };
constexpr std::array flat_kinds{Kind::box, Kind::polygon, Kind::half_plane};
constexpr const char* names[] = {"box", "polygon", "half_plane", "mesh", "height_field", "plane"};
constexpr bool is_endless(Kind kind) {
    return kind == Kind::half_plane || kind == Kind::plane;
}

/// Its size is the diagonal of the box around it, and its own frame may be rotated.
constexpr bool is_shape(Kind kind) {
    return kind == Kind::mesh || kind == Kind::height_field;
}

/// The whole test in a random pose.
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

/// The assets of a scene's shapes.
using Forms = std::vector<std::unique_ptr<Asset>>;

/// A box of triangles under the face, in a frame of its own.
std::unique_ptr<Asset> mesh_of(const Face& face, double thick, int divisions, const Pose& own) {
    std::vector<double> lines[3];
    const Vector low(face.low.x(), face.low.y(), -thick), high(face.high.x(), face.high.y(), 0);
    for (int axis = 0; axis < 3; ++axis) {
        for (int i = 0; i <= divisions; ++i)
            lines[axis].push_back(low[axis] + (high[axis] - low[axis]) * i / divisions);
    }
    MadeMesh made = blocks(lines[0], lines[1], lines[2], [](int, int, int) { return true; });
    for (auto& vertex : made.vertices) {
        const Vector moved = own({vertex[0], vertex[1], vertex[2]});
        vertex = {moved.x(), moved.y(), moved.z()};
    }
    return std::make_unique<Mesh>(
        Triangles{.vertices = made.vertices, .triangles = made.triangles, .materials = {}},
        MeshBuild{.exact = true});
}

std::unique_ptr<Asset> height_field_of(const Face& face, std::uint32_t divisions) {
    const std::uint32_t lines = divisions + 1;
    const std::vector<float> heights(lines * lines, 0.0f);
    return std::make_unique<HeightField>(heights, HeightGrid{.columns = lines,
                                                             .rows = lines,
                                                             .dx = (face.high.x() - face.low.x()) / divisions,
                                                             .dy = (face.high.y() - face.low.y()) / divisions,
                                                             .corner = {face.low.x(), face.low.y(), 0}});
}

/// `edge_is_high`: a half-plane ends at high.x, not at low.x.
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
    } else if (kind == Kind::plane) {
        const Vector normal = face.pose.turn * Vector::UnitZ();
        put(Plane{.normal = to_plain(normal), .offset = normal.dot(face.pose.shift), .stiffness = k});
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

/// A mesh or height field is asset `slot` + 1, given in its own random frame. Returns its size: for a box or
/// a polygon the longest side, for a shape the diagonal of the box around it along the axes of its own frame.
double add(Scene& scene, std::uint32_t slot, Kind kind, const Face& face, double thick, bool edge_is_high,
           Forms& forms) {
    if (is_shape(kind)) {
        Rng rng(static_cast<std::uint64_t>(1e9 * (thick + face.size() + face.high.x())));
        const int divisions = between(rng, 1, 4);
        Pose own{Eigen::Quaterniond::Identity(), Vector::Zero()};
        if (kind == Kind::mesh && between(rng, 0, 1)) own = {turn(rng), 0.1 * direction(rng)};
        forms.push_back(kind == Kind::mesh ? mesh_of(face, thick, divisions, own)
                                           : height_field_of(face, static_cast<std::uint32_t>(divisions)));
        scene.set_asset(slot + 1, forms.back().get());
        const Eigen::Quaterniond turned = face.pose.turn * own.turn.conjugate();
        EXPECT_TRUE(
            scene.add({slot, 1}, Shape{.asset = slot + 1,
                                       .position = to_plain(Vector(face.pose.shift - turned * own.shift)),
                                       .orientation = to_plain(turned),
                                       .stiffness = k}));
        Vector sides = face.high - face.low;
        sides.z() = kind == Kind::mesh ? thick : 0;
        return (own.turn.toRotationMatrix().cwiseAbs() * sides).norm();
    }
    put(kind, face, thick, edge_is_high, [&](const auto& surface) {
        EXPECT_TRUE(scene.add({slot, 1}, surface));
    });
    return face.size();
}

struct Counts {
    std::uint64_t approaches = 0, cycles = 0, lost = 0;
    double worst = 0;  // N, by which the judge's bound is exceeded
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
    const double first = is_endless(a) ? infinity : size_a;
    const double second = is_endless(b) ? infinity : size_b;
    const bool sized = !is_endless(a) && !is_endless(b);
    const double least = std::min(first, second);
    return sized ? least : std::min(least, hand / touch);
}

/// The hand moves to `goal` at this speed; `judge` returns for each cycle how far the force is off (N).
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

/// Two faces in a plane, A in x < 0, B in x > 0, except for a gap and a step.
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
        Forms forms;
        Scene scene = room();
        const double size_a = add(scene, 0, kind_a, a, log_uniform(rng, 5e-4, 0.05), true, forms);
        const double size_b = add(scene, 1, kind_b, b, log_uniform(rng, 5e-4, 0.05), false, forms);
        const double largest = std::max({touch * size_a, touch * size_b, hand});
        const double near = std::abs(gap) + 2.1 * largest;
        for (int i = 0; i < hands; ++i) {
            const double deep = uniform(rng, 1e-3, 5e-3), speed = log_uniform(rng, 1e-3, 0.3);
            const double angle = uniform(rng, -1.3, 1.3), y = uniform(rng, -5e-3, 5e-3);
            // One of four lands on the gap between them.
            const double ahead = between(rng, 0, 3) == 0
                                     ? std::abs(gap) * uniform(rng, -1, 1)
                                     : std::max(20 * speed * dt, near) * uniform(rng, 0.5, 1);
            const bool back = between(rng, 0, 1);
            const Vector way = (back ? -1 : 1) * Vector(std::cos(angle), std::sin(angle), 0);
            const auto judge = [&](const Vector& p, const Vector& force) {
                // Where they touch, either may hold, or what lies between them.
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
        const bool under = between(rng, 0, 1);  // the floor continues under the wall
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
        Forms forms;
        Scene scene = room();
        add(scene, 0, floor_kind, floor, log_uniform(rng, 5e-4, 0.05), true, forms);
        add(scene, 1, wall_kind, wall, log_uniform(rng, 5e-4, 0.05), true, forms);
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

/// A ball of any radius is pressed on one face, slides over the seam on to the next, and is pushed aside by
/// no more than the path over the step. Returns by how much the force exceeded that (N; negative: it did
/// not). `margin` (m): a ball whose centre is that near the face is left out, since a seam is as wide.
double roll_over_a_seam(Kind kind_a, Kind kind_b, double margin, Rng& rng) {
    const Pose pose = any_pose(rng);
    const double gap = little(rng, 0), step = little(rng, 0);
    Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {gap, -0.05, 0}, {0.05, 0.05, 0}};
    b.pose.shift = pose({0, 0, step});
    Forms forms;
    Scene scene = room();
    add(scene, 0, kind_a, a, 0.01, true, forms);
    add(scene, 1, kind_b, b, 0.01, false, forms);
    const double radius = uniform(rng, 1e-3, 5e-3), deep = uniform(rng, 1e-3, 8e-3);
    if (std::abs(radius - deep) < margin) return -1;
    EXPECT_TRUE(scene.place_probe(0, {.offset = {}, .radius = radius}));
    const double speed = scale(rng, 0.01, 0.3), angle = uniform(rng, -1.2, 1.2);
    Vector p(-4e-3, 0, radius + 1e-3);
    double worst = -1;
    for (int i = 0; p.x() < 4e-3 && std::abs(p.y()) < 0.04; ++i) {
        if (i <= 50) {
            p.z() = radius + 1e-3 - (deep + 1e-3) * i / 50;
        } else {
            p += speed * dt * Vector(std::cos(angle), std::sin(angle), 0);
        }
        const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
        const double want = k * std::max(0.0, radius - p.z());
        const double off = (force - Vector(0, 0, want)).norm();
        // Its centre has not reached the faces: between them the planes at both feet may act.
        const bool between_them = deep < radius && std::abs(p.x()) < 2e-3;
        const double over = std::sqrt(2 * want / k * std::abs(step) + step * step);
        worst =
            std::max(worst, off - (between_them ? want / 2 : k * (over + std::abs(step) + std::abs(gap))));
    }
    EXPECT_LE(worst, 1e-9) << "N; " << names[int(kind_a)] << " to " << names[int(kind_b)] << ", radius "
                           << radius << " deep " << deep << " gap " << gap << " step " << step << "; seed "
                           << seed();
    return worst;
}

}  // namespace
}  // namespace seams_tests
