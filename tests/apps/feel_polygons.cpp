// Polygons as triangles: every point inside the outline lies in one triangle, every other in none.

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <knurl/meshfile/polygons.hpp>

namespace {

using Eigen::Vector2d;
using knurl::meshfile::Cutter;
using Outline = std::vector<Vector2d>;

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

bool within(const Outline& outline, const Vector2d& p) {
    bool in = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
            in = !in;
    }
    return in;
}

double area(const Outline& outline) {
    double sum = 0;
    for (std::size_t i = 0; i < outline.size(); ++i)
        sum += turn({0, 0}, outline[i], outline[(i + 1) % outline.size()]);
    return sum / 2;
}

/// Triangulates the outline at a random place and orientation in space, and compares areas and points.
void expect_filled(const Outline& outline, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    const Eigen::Quaterniond turned =
        seed % 3 == 0
            ? Eigen::Quaterniond::Identity()
            : Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized();
    const Eigen::Vector3d moved =
        seed % 3 == 2 ? Eigen::Vector3d(4e5, 5e6, 100) : Eigen::Vector3d(unit(random), 0, unit(random));
    std::vector<knurl::Point3> vertices;
    std::vector<std::uint32_t> polygon;
    for (const Vector2d& p : outline) {
        const Eigen::Vector3d at = turned * Eigen::Vector3d(p.x(), p.y(), 0) + moved;
        polygon.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.push_back({at.x(), at.y(), at.z()});
    }
    Cutter cutter;
    std::vector<knurl::Triangle> triangles;
    const auto shape = cutter.cut(vertices, polygon, triangles);
    ASSERT_TRUE(shape == Cutter::Shape::convex || shape == Cutter::Shape::concave) << "seed " << seed;
    double sum = 0;
    for (const auto& t : triangles) {
        const double part = turn(outline[t[0]], outline[t[1]], outline[t[2]]) / 2;
        EXPECT_GT(part, -1e-6) << "seed " << seed;
        sum += part;
    }
    EXPECT_NEAR(sum, area(outline), 1e-6 * (1 + area(outline))) << "seed " << seed;
    Vector2d low = outline[0], high = low;
    for (const Vector2d& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    for (int i = 0; i < 100; ++i) {
        const Vector2d p = low + (high - low).cwiseProduct(Vector2d(unit(random) + 1, unit(random) + 1)) / 2;
        double nearest = INFINITY;  // distance to an edge; near one, rounding decides
        for (std::size_t k = 0; k < outline.size(); ++k) {
            const Vector2d a = outline[k], d = outline[(k + 1) % outline.size()] - a;
            const double share = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
            nearest = std::min(nearest, (p - a - share * d).norm());
        }
        if (nearest < 1e-3) continue;
        int over = 0;
        for (const auto& t : triangles) {
            const double a = turn(outline[t[0]], outline[t[1]], p), b = turn(outline[t[1]], outline[t[2]], p),
                         c = turn(outline[t[2]], outline[t[0]], p);
            over += a > 1e-9 && b > 1e-9 && c > 1e-9;
            if (std::min({a, b, c}) > -1e-9 && std::min({a, b, c}) <= 1e-9) over = -1000;  // on a diagonal
        }
        if (over >= 0) {
            EXPECT_EQ(over, within(outline, p) ? 1 : 0) << "seed " << seed;
        }
    }
}

Outline star(std::mt19937& random, int n) {
    std::uniform_real_distribution<double> radius(0.2, 2);
    Outline outline;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * M_PI * i / n;
        outline.push_back(radius(random) * Vector2d(std::cos(angle), std::sin(angle)));
    }
    return outline;
}

/// A band along a spiral.
Outline spiral(int n) {
    Outline outline;
    for (int i = 0; i < n; ++i) {
        const double angle = 0.35 * i, r = 1 + 0.2 * angle;
        outline.push_back(r * Vector2d(std::cos(angle), std::sin(angle)));
    }
    for (int i = n - 1; i >= 0; --i) {
        const double angle = 0.35 * i, r = 0.6 + 0.2 * angle;
        outline.push_back(r * Vector2d(std::cos(angle), std::sin(angle)));
    }
    std::reverse(outline.begin(), outline.end());
    return area(outline) > 0 ? outline : Outline(outline.rbegin(), outline.rend());
}

TEST(Polygons, AreFilledWhicheverWayTheyAreBent) {
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        std::mt19937 random(seed);
        expect_filled(star(random, 4 + static_cast<int>(seed % 40)), seed);
    }
    for (std::uint32_t seed = 0; seed < 6; ++seed) expect_filled(spiral(40), seed);
}

TEST(Polygons, WithCornersOnTheirEdgesLeaveNoneOut) {
    // A square, whose sides have more corners.
    Outline outline;
    for (const auto& [from, to] : {std::pair{Vector2d(0, 0), Vector2d(1, 0)},
                                   {Vector2d(1, 0), Vector2d(1, 1)},
                                   {Vector2d(1, 1), Vector2d(0, 1)},
                                   {Vector2d(0, 1), Vector2d(0, 0)}})
        for (int i = 0; i < 4; ++i) outline.push_back(from + (to - from) * i / 4);
    expect_filled(outline, 0);
    std::vector<knurl::Point3> vertices;
    std::vector<std::uint32_t> polygon;
    for (const Vector2d& p : outline) {
        polygon.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.push_back({p.x(), p.y(), 0});
    }
    Cutter cutter;
    std::vector<knurl::Triangle> triangles;
    cutter.cut(vertices, polygon, triangles);
    EXPECT_EQ(triangles.size(), outline.size() - 2) << "so each edge has its triangle";
    for (const auto& t : triangles)
        EXPECT_GT(turn(outline[t[0]], outline[t[1]], outline[t[2]]), 0.01) << "each with an area";
}

TEST(Polygons, HaveHolesThatABridgeJoins) {
    const Outline square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    // The outline goes from a corner to the hole, around it in the other direction, and back.
    expect_filled({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}, 0);
    expect_filled({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}, 1);
    // Two holes at one corner, and a bridge along the line of an edge.
    expect_filled({{0, 0},
                   {2, 0.5},
                   {2, 1},
                   {3, 1},
                   {3, 0.5},
                   {2, 0.5},
                   {0, 0},
                   {4, 0},
                   {4, 4},
                   {0, 4},
                   {0, 0},
                   {1, 2},
                   {1, 3},
                   {2, 3},
                   {1, 2}},
                  0);
}

TEST(Polygons, OfManyCornersTakeNoTime) {
    std::mt19937 random(1);
    const Outline outline = star(random, 20'000);
    std::vector<knurl::Point3> vertices;
    std::vector<std::uint32_t> polygon;
    for (const Vector2d& p : outline) {
        polygon.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.push_back({p.x(), p.y(), 0});
    }
    Cutter cutter;
    std::vector<knurl::Triangle> triangles;
    EXPECT_EQ(cutter.cut(vertices, polygon, triangles), Cutter::Shape::concave);
    EXPECT_EQ(triangles.size(), outline.size() - 2);
}

Cutter::Shape shape_of(const std::vector<knurl::Point3>& vertices) {
    std::vector<std::uint32_t> polygon;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) polygon.push_back(i);
    Cutter cutter;
    std::vector<knurl::Triangle> triangles;
    return cutter.cut(vertices, polygon, triangles);
}

TEST(Polygons, ThatCrossThemselvesOrHaveNoAreaAreNamedSo) {
    using Shape = Cutter::Shape;
    EXPECT_EQ(shape_of({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}), Shape::crossed);
    EXPECT_EQ(shape_of({{0, 0, 0}, {3, 2, 0}, {3, 0, 0}, {0, 3, 0}}), Shape::crossed);
    EXPECT_EQ(shape_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), Shape::nothing);
    EXPECT_EQ(shape_of({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}}), Shape::nothing);
    EXPECT_EQ(shape_of({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}}), Shape::convex) << "a corner twice";
    EXPECT_EQ(shape_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.3}, {0, 1, 0}}), Shape::convex) << "bent";
}

}  // namespace
