// Curved surfaces: the error of each method against the nearest free point, in the groove of two rods that
// cross at an angle, and in the hollow between three, with the probe 1 to 3 mm below their meeting point.

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include <Eigen/LU>

#include <knurl/reps/capsule.hpp>
#include <knurl/reps/curved_contact.hpp>
#include <knurl/reps/scene.hpp>

#include "panel.hpp"

namespace knurl::error {
namespace {

using Eigen::Vector3d;
using Exact = Eigen::Matrix<long double, 3, 1>;

struct Rod {
    Vector3d center, axis;
    double radius;  // m

    CurvedContact at(const Vector3d& x) const {
        const Vector3d q = x - center, side = q - axis.dot(q) * axis;
        const double length = side.norm();
        const Vector3d n = side / length;
        return {n, length - radius,
                (Eigen::Matrix3d::Identity() - axis * axis.transpose() - n * n.transpose()) / length};
    }
};
using Rods = std::vector<Rod>;

/// The point where all of them hold, in long double: repeatedly the nearest point to p on all tangent planes
/// at the last point, which converges linearly. Nothing if it does not converge, or one of them would pull.
std::optional<Exact> exact_at(const Rods& rods, const Vector3d& hand) {
    using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, 3>;
    using Column = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
    const Exact p = hand.cast<long double>();
    const auto m = static_cast<Eigen::Index>(rods.size());
    Exact x = p;
    Column pushes;
    long double step = 1;
    for (int round = 0; round < 2000 && step > 1e-17L; ++round) {
        Matrix normals(m, 3);
        Column s(m);
        for (Eigen::Index k = 0; k < m; ++k) {
            const Rod& rod = rods[static_cast<std::size_t>(k)];
            const Exact a = rod.axis.cast<long double>().normalized(), q = x - rod.center.cast<long double>();
            const Exact side = q - a.dot(q) * a, n = side.normalized();
            normals.row(k) = n.transpose();
            s[k] = n.dot(x - p) - (side.norm() - rod.radius);
        }
        pushes = (normals * normals.transpose()).fullPivLu().solve(s);
        const Exact next = p + normals.transpose() * pushes;
        step = (next - x).norm();
        x = next;
    }
    if (!(step <= 1e-17L) || pushes.minCoeff() < 0) return std::nullopt;
    return x;
}

/// Nearest to p within the rods' tangent planes at x; both relative to p.
struct Planes {
    std::array<double, 3> nx{}, ny{}, nz{}, s{};
    ContactSolution solution;

    Vector3d solve(const Rods& rods, const Vector3d& p, const Vector3d& dx) {
        double worst = -1;
        for (std::size_t i = 0; i < rods.size(); ++i) {
            const CurvedContact there = rods[i].at(p + dx);
            nx[i] = there.normal.x(), ny[i] = there.normal.y(), nz[i] = there.normal.z();
            s[i] = there.normal.dot(dx) - there.height;
            worst = std::max(worst, s[i]);
        }
        solve_contact({nx.data(), ny.data(), nz.data(), s.data(), static_cast<std::uint32_t>(rods.size())},
                      worst, 0, solution);
        return solution.dx;
    }
};

Vector3d by_planes(const Rods& rods, const Vector3d& p, int rounds) {
    Planes planes;
    Vector3d dx = Vector3d::Zero();
    for (int i = 0; i < rounds; ++i) dx = planes.solve(rods, p, dx);
    return dx;
}

/// Once like by_planes, then steps that include the curvature of the surfaces.
Vector3d by_steps(const Rods& rods, const Vector3d& p, int rounds) {
    Planes planes;
    Vector3d dx = planes.solve(rods, p, Vector3d::Zero());
    std::array<double, 3> pushes{};
    for (std::uint32_t i = 0; i < planes.solution.active.count; ++i)
        pushes[planes.solution.active.plane[i]] = planes.solution.multiplier[i];
    std::array<NearSurface, 3> near;
    for (int round = 0; round < rounds; ++round) {
        for (std::uint32_t i = 0; i < rods.size(); ++i)
            near[i] = {.at = rods[i].at(p + dx), .member = i, .pushes = pushes[i], .curved = true};
        const CurvedStep step = solve_curved_step(std::span(near).first(rods.size()), dx);
        if (!step.found) break;
        dx += step.step;
        pushes = {};
        for (std::uint32_t i = 0; i < step.active.count; ++i)
            pushes[step.active.plane[i]] = step.multiplier[i];
    }
    return dx;
}

/// Out of one rod after the other, until none holds it: on all of them, but not the nearest such point.
Vector3d by_projections(const Rods& rods, const Vector3d& p, int rounds) {
    Vector3d x = p;
    for (int i = 0; i < rounds; ++i) {
        for (const Rod& rod : rods) {
            const CurvedContact there = rod.at(x);
            if (there.height < 0) x -= there.height * there.normal;
        }
    }
    return x - p;
}

struct Stroke {
    Rods rods;
    std::vector<Vector3d> path;
    std::vector<Exact> exact;  // relative to the probe, at each place of the path
    Scene scene{{.representations = 3, .probes = 1}, Limits{}};
};

Rods random_rods(int count, std::mt19937_64& rng) {
    std::uniform_real_distribution<> any(-1, 1);
    Rods rods;
    for (int i = 0; i < count; ++i) {
        const double around = 2 * M_PI * i / count + 0.2 * any(rng);
        const Vector3d out(std::cos(around), std::sin(around), 0);
        const Vector3d across = out.cross(Vector3d::UnitZ());
        rods.push_back({(0.012 + 0.001 * any(rng)) * out,
                        (across + 0.4 * Vector3d(any(rng), any(rng), any(rng))).normalized(),
                        0.015 + 0.002 * any(rng)});
    }
    return rods;
}

/// 64 places of a circle of 0.2 mm, below the meeting of the rods. False: not all of them hold there.
bool lay_path(Stroke& stroke, double depth) {
    const std::optional<Exact> bottom = exact_at(stroke.rods, Vector3d(0, 0, 0.006));
    if (!bottom) return false;
    for (int i = 0; i < 64; ++i) {
        const double phase = i * M_PI / 32;
        const Vector3d p =
            bottom->cast<double>() + Vector3d(1e-4 * std::cos(phase), 1e-4 * std::sin(phase), -depth);
        const std::optional<Exact> x = exact_at(stroke.rods, p);
        if (!x) return false;
        stroke.path.push_back(p);
        stroke.exact.push_back(*x - p.cast<long double>());
    }
    return true;
}

Stroke stroke_of(int count, std::mt19937_64& rng) {
    std::uniform_real_distribution<> depth(0.001, 0.003);
    Stroke stroke;
    do {
        stroke.path.clear(), stroke.exact.clear();
        stroke.rods = random_rods(count, rng);
    } while (!lay_path(stroke, depth(rng)));
    for (std::uint32_t i = 0; i < stroke.rods.size(); ++i) {
        const Rod& rod = stroke.rods[i];
        (void)stroke.scene.add({i, 1},
                               Capsule{.center = to_plain(rod.center),
                                       .axis = to_plain(rod.axis),
                                       .half_length = 0.1,
                                       .radius = rod.radius,
                                       .stiffness = 1000},
                               {.feedback = 0});
    }
    stroke.scene.settle();
    Probe hand;
    for (int i = 100; i >= 0; --i) {  // from above
        hand.position = stroke.path[0] + i * 1e-4 * Vector3d::UnitZ();
        stroke.scene.evaluate(hand, 1e-3);
    }
    return stroke;
}

}  // namespace

Panel curved(const measure::Stopwatch& watch) {
    Panel panel{.name = "curved",
                .error_unit = "N",
                .error_meaning = "largest force error at 1000 N/m",
                .exact = 1e-9,
                .points = {}};
    panel.points.reserve(64);
    std::mt19937_64 rng(4);
    for (const int count : {2, 3}) {
        constexpr int scenes = 8;
        std::vector<Stroke> strokes;
        for (int i = 0; i < scenes; ++i) strokes.push_back(stroke_of(count, rng));
        struct Entry {
            std::string name;
            int rounds;
            std::function<Vector3d(Stroke&, const Vector3d&)> dx;
            bool knurl = false;
        };
        std::vector<Entry> entries;
        for (const int rounds : {1, 2, 4, 8, 16}) {
            entries.push_back({"planes where they met", rounds, [rounds](Stroke& s, const Vector3d& p) {
                                   return by_planes(s.rods, p, rounds);
                               }});
            entries.push_back({"projections", rounds, [rounds](Stroke& s, const Vector3d& p) {
                                   return by_projections(s.rods, p, rounds);
                               }});
        }
        for (const int rounds : {1, 2, 3, 4})
            entries.push_back({"steps with their bend", rounds,
                               [rounds](Stroke& s, const Vector3d& p) { return by_steps(s.rods, p, rounds); },
                               rounds == static_cast<int>(max_curved_rounds)});
        entries.push_back(
            {"a whole cycle of Scene", static_cast<int>(max_curved_rounds), [](Stroke& s, const Vector3d& p) {
                 Probe hand;
                 hand.position = p;
                 return Vector3d(s.scene.evaluate(hand, 1e-3).force / 1000);
             }});
        std::vector<Contender> contenders;
        for (const Entry& entry : entries) {
            double error = 0;
            for (Stroke& stroke : strokes) {
                for (std::size_t i = 0; i < stroke.path.size(); ++i) {
                    const Exact dx = entry.dx(stroke, stroke.path[i]).cast<long double>();
                    error = std::max(error, 1000 * static_cast<double>((dx - stroke.exact[i]).norm()));
                }
            }
            Point* const point = &panel.points.emplace_back(
                Point{.scene = std::to_string(count) + " rods, " + std::to_string(entry.rounds) +
                               (entry.rounds == 1 ? " round" : " rounds"),
                      .size = static_cast<double>(entry.rounds),
                      .implementation = entry.name,
                      .error = error,
                      .knurl = entry.knurl});
            contenders.push_back(
                {point, [&strokes, dx = entry.dx, next = 0u](int calls) mutable {
                     for (int i = 0; i < calls; ++i, ++next)
                         keep(dx(strokes[next / 64 % scenes], strokes[next / 64 % scenes].path[next & 63]));
                 }});
        }
        race(watch, contenders);
    }
    return panel;
}

}  // namespace knurl::error
