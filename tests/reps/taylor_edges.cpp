// The edges of Taylor fields derive from a potential where the Jacobian is symmetric: closed loops return
// their work, nothing steps, and the stiffness stays within the device's limit.

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <knurl/reps/taylor.hpp>
#include <knurl/reps/taylor6.hpp>

#include "effect_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace taylor_edges_tests {
namespace {

constexpr double most_work = 1e-8;  // J, of a loop of some newtons over some centimetres
const Limits device{.max_stiffness = 2000, .max_torsion = 0.5};

template <class Matrix>
Matrix symmetric(Matrix m, std::size_t n) {
    for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c < r; ++c) m.at[n * r + c] = m.at[n * c + r];
    return m;
}

Taylor random_field(Rng& rng, TaylorEdge edge) {
    Taylor field{.origin = to_plain(0.01 * direction(rng)),
                 .force = to_plain(uniform(rng, 0, 2) * direction(rng)),
                 .radius = uniform(rng, 0.01, 0.05),
                 .edge = edge};
    for (double& entry : field.jacobian.at) entry = uniform(rng, -300, 300);
    field.jacobian = symmetric(field.jacobian, 3);
    return field;
}

Taylor6 random_field6(Rng& rng, TaylorEdge edge) {
    Taylor6 field{.origin = to_plain(0.01 * direction(rng)),
                  .orientation = to_plain(turn(rng)),
                  .force = to_plain(uniform(rng, 0, 2) * direction(rng)),
                  .torque = to_plain(uniform(rng, 0, 0.1) * direction(rng)),
                  .radius = uniform(rng, 0.01, 0.05),
                  .angle = uniform(rng, 0.1, 1),
                  .edge = edge};
    for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t c = 0; c < 6; ++c)
            field.jacobian.at[6 * r + c] =
                uniform(rng, -1, 1) * (r < 3 ? 1.0 : 0.05) * (c < 3 ? 1.0 : 0.05) * 300;
    field.jacobian = symmetric(field.jacobian, 6);
    return field;
}

// Gauss and Legendre's five points: their error falls as the tenth power of the step.
constexpr double points[] = {-0.906179845938664, -0.538469310105683, 0, 0.538469310105683, 0.906179845938664};
constexpr double weights[] = {0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366,
                              0.236926885056189};

template <class Power>
double gauss(double from, double to, Power& power) {
    double sum = 0;
    for (int k = 0; k < 5; ++k)
        sum += weights[k] / 2 * (to - from) * power((from + to) / 2 + points[k] / 2 * (to - from));
    return sum;
}
/// Halved where the two halves give another sum: at the edges the force has a kink.
template <class Power>
double halved(double from, double to, double whole, int depth, Power& power) {
    const double middle = (from + to) / 2, left = gauss(from, middle, power),
                 right = gauss(middle, to, power);
    if (depth == 0 || std::abs(left + right - whole) < 1e-13) return left + right;
    return halved(from, middle, left, depth - 1, power) + halved(middle, to, right, depth - 1, power);
}
/// Of power(t) over 0 ... 1.
template <class Power>
double integral(int pieces, Power power) {
    double sum = 0;
    for (int i = 0; i < pieces; ++i) {
        const double from = static_cast<double>(i) / pieces, to = static_cast<double>(i + 1) / pieces;
        sum += halved(from, to, gauss(from, to, power), 30, power);
    }
    return sum;
}

/// Three harmonics about a point; crosses the edge again and again.
struct Loop {
    Vector about, a[3], b[3];
    Loop(Rng& rng, const Vector& at, double size) : about(at) {
        for (int h = 0; h < 3; ++h)
            a[h] = size / (h + 1) * direction(rng), b[h] = size / (h + 1) * direction(rng);
    }
    Vector at(double t) const {
        Vector p = about;
        for (int h = 0; h < 3; ++h) {
            const double w = 2 * M_PI * (h + 1);
            p += std::cos(w * t) * a[h] + std::sin(w * t) * b[h];
        }
        return p;
    }
    Vector slope(double t) const {
        Vector v = Vector::Zero();
        for (int h = 0; h < 3; ++h) {
            const double w = 2 * M_PI * (h + 1);
            v += w * (std::cos(w * t) * b[h] - std::sin(w * t) * a[h]);
        }
        return v;
    }
};

template <class R>
Wrench felt_of(const R& params, const Probe& probe) {
    typename R::State state{};
    return evaluate(params, state, probe, dt);
}

}  // namespace

TEST(TaylorEdges, ClosedLoopsThatCrossThemReturnTheirWorkWhereTheJacobianIsSymmetric) {
    const std::uint64_t seed = 411;
    Rng rng(seed);
    double worst = 0, crossed = 0;
    for (int i = 0; i < (long_form() ? 400 : 60); ++i) {
        const TaylorEdge edge = i % 2 ? TaylorEdge::hold : TaylorEdge::fade;
        const Limits limits = between(rng, 0, 1) ? device : Limits{};
        const Taylor field = prepared(random_field(rng, edge), limits);
        const Loop loop(rng, to_eigen(field.origin) + 0.5 * field.radius * direction(rng),
                        0.6 * field.radius);
        const auto power = [&](double t) {
            const Vector p = loop.at(t);
            crossed += (p - to_eigen(field.origin)).norm() > field.radius;
            return felt_of(field, at(p)).force.dot(loop.slope(t));
        };
        const double work = integral(16000, power);
        worst = std::max(worst, std::abs(work));
        ASSERT_LE(std::abs(work), most_work) << "seed " << seed << " case " << i;
    }
    EXPECT_GT(crossed, 5'000);
    std::printf("seed %lu, worst %.2g J\n", seed, worst);
}

// The geometry of the rotation vector gives work to a loop of orientations (see below), not the edge. Loops
// in position, together with a rotation about one axis, return all work.
TEST(TaylorEdges, ClosedLoopsOfPositionAndTurningAboutOneAxisReturnTheirWorkInSixDimensions) {
    const std::uint64_t seed = 412;
    Rng rng(seed);
    double worst = 0;
    for (int i = 0; i < (long_form() ? 300 : 40); ++i) {
        const TaylorEdge edge = i % 2 ? TaylorEdge::hold : TaylorEdge::fade;
        const Limits limits = between(rng, 0, 1) ? device : Limits{};
        const Taylor6 field = prepared(random_field6(rng, edge), limits);
        const Loop loop(rng, to_eigen(field.origin) + 0.3 * field.radius * direction(rng),
                        0.6 * field.radius);
        const Vector axis = direction(rng);
        const double swing = uniform(rng, 0, 1.6) * field.angle, lag = uniform(rng, 0, 6);
        const auto power = [&](double t) {
            const double w = 2 * M_PI * t;
            const double angle = swing * std::sin(w + lag), rate = 2 * M_PI * swing * std::cos(w + lag);
            Probe probe = at(loop.at(t));
            probe.orientation =
                Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * to_eigen(field.orientation);
            const Wrench w6 = felt_of(field, probe);
            return w6.force.dot(loop.slope(t)) + w6.torque.dot(rate * axis);
        };
        const double work = integral(16000, power);
        worst = std::max(worst, std::abs(work));
        ASSERT_LE(std::abs(work), most_work) << "seed " << seed << " case " << i;
    }
    std::printf("seed %lu, worst %.2g J\n", seed, worst);
}

// A torsion that is equal about all axes is exact on any loop of orientations. The rest equals what the
// series gives within the core as well.
TEST(TaylorEdges, LoopsOfOrientationsReturnTheirWorkWhereTheTorsionIsTheSameAboutEveryAxis) {
    const std::uint64_t seed = 413;
    Rng rng(seed);
    for (int i = 0; i < 20; ++i) {
        Taylor6 raw{.radius = 0.02, .angle = 0.5, .edge = i % 2 ? TaylorEdge::hold : TaylorEdge::fade};
        const double torsion = uniform(rng, -2, 0);
        for (std::size_t k = 0; k < 3; ++k)
            raw.jacobian.at[7 * k] = -100, raw.jacobian.at[7 * (k + 3)] = torsion;
        const Taylor6 field = prepared(raw, {});
        const Loop loop(rng, 0.3 * field.angle * direction(rng), 0.4 * field.angle);
        const Loop path(rng, Vector::Zero(), 0.4 * field.radius);
        const auto power = [&](double t) {
            const Vector theta = loop.at(t), rate = loop.slope(t);
            const double angle = theta.norm();
            const Vector n = theta / angle;
            Probe probe = at(path.at(t));
            probe.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, n));
            // The angular velocity in the world of exp(theta(t)).
            const Vector omega =
                rate + (1 - std::cos(angle)) / (angle * angle) * theta.cross(rate) +
                (angle - std::sin(angle)) / (angle * angle * angle) * theta.cross(theta.cross(rate));
            const Wrench w = felt_of(field, probe);
            return w.force.dot(path.slope(t)) + w.torque.dot(omega);
        };
        EXPECT_LE(std::abs(integral(16000, power)), most_work) << "seed " << seed << " case " << i;
    }
}

TEST(TaylorEdges, WhatIsCurledMakesItsWorkAndNoMore) {
    // Only the curl: all the work of a loop within the rim, cut or held by force beyond.
    const std::uint64_t seed = 414;
    Rng rng(seed);
    for (int i = 0; i < 20; ++i) {
        Taylor field = random_field(rng, i % 2 ? TaylorEdge::hold : TaylorEdge::fade), curl = field;
        for (double& entry : field.jacobian.at) entry += uniform(rng, -100, 100);
        const Eigen::Matrix3d j = to_eigen(field.jacobian);
        curl.force = {};
        curl.jacobian = to_mat3(Eigen::Matrix3d(0.5 * (j - j.transpose())));
        const Loop loop(rng, to_eigen(field.origin), 0.6 * field.radius);
        const auto work = [&](const Taylor& of) {
            const Taylor params = prepared(of, {});
            return integral(
                4000, [&](double t) { return felt_of(params, at(loop.at(t))).force.dot(loop.slope(t)); });
        };
        EXPECT_NEAR(work(field), work(curl), most_work) << "seed " << seed << " case " << i;
    }
}

/// df/dx by central differences, whose step is small against the edge.
template <class Field>
Eigen::Matrix3d slope_at(Field field, const Vector& p, double step) {
    Eigen::Matrix3d out;
    for (int k = 0; k < 3; ++k) {
        const Vector e = step * Vector::Unit(k);
        out.col(k) = (field(p + e) - field(p - e)) / (2 * step);
    }
    return out;
}

TEST(TaylorEdges, OnADeviceNoDirectionRestoresWithMoreThanItStandsNorPushesAway) {
    const std::uint64_t seed = 415;
    Rng rng(seed);
    double fade = 0, hold = 0;
    for (int i = 0; i < (long_form() ? 20'000 : 1500); ++i) {
        Taylor raw = random_field(rng, i % 2 ? TaylorEdge::hold : TaylorEdge::fade);
        const double size = scale(rng, 0.01, 100);
        raw.force = to_plain(scale(rng, 0.01, 10) * to_eigen(raw.force));
        raw.radius *= scale(rng, 0.05, 2);
        for (double& entry : raw.jacobian.at) entry *= size;
        const Taylor field = prepared(raw, device);
        const auto force = [&](const Vector& p) { return felt_of(field, at(p)).force; };
        for (int k = 0; k < 40; ++k) {
            const double r = field.radius * uniform(rng, 0, i % 2 ? 3 : 1.1);
            const Eigen::Matrix3d h =
                slope_at(force, to_eigen(field.origin) + r * direction(rng), 1e-6 * field.radius);
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> values(0.5 * (h + h.transpose()));
            const double restores = -values.eigenvalues()[0], pushes = values.eigenvalues()[2];
            const double slack = 1e-3 * (1 + device.max_stiffness);  // error of the differences
            ASSERT_LE(restores, field.stiffness + slack) << "seed " << seed << " case " << i;
            ASSERT_LE(restores, device.max_stiffness + slack) << "seed " << seed << " case " << i;
            ASSERT_LE(pushes,
                      (i % 2 ? hand_stiffness + device.max_stiffness / 3 : device.max_stiffness) + slack)
                << "seed " << seed << " case " << i;
            (i % 2 ? hold : fade) = std::max(i % 2 ? hold : fade, restores);
        }
    }
    EXPECT_GT(fade, 0.3 * device.max_stiffness) << "the bound is not idle";
    EXPECT_GT(hold, 0.9 * device.max_stiffness);
    std::printf("seed %lu: steepest felt %.0f (fade), %.0f N/m (hold) of 2000\n", seed, fade, hold);
}

TEST(TaylorEdges, OnADeviceForceAndTorqueTogetherRestoreWithNoMoreThanItStands) {
    const std::uint64_t seed = 416;
    Rng rng(seed);
    const double metres = std::sqrt(device.max_torsion / device.max_stiffness);
    double most = 0;
    for (int i = 0; i < (long_form() ? 10'000 : 800); ++i) {
        Taylor6 raw = random_field6(rng, i % 2 ? TaylorEdge::hold : TaylorEdge::fade);
        const double size = scale(rng, 0.01, 100);
        for (double& entry : raw.jacobian.at) entry *= size;
        const Taylor6 field = prepared(raw, device);
        // In position and rotation vector, with a radian as so many metres.
        using Six = Eigen::Matrix<double, 6, 1>;
        const auto wrench = [&](const Six& z) {
            Probe probe = at(to_eigen(field.origin) + z.head<3>());
            const Vector theta = z.tail<3>() / metres;
            const double angle = theta.norm();
            if (angle > 0)
                probe.orientation = Eigen::AngleAxisd(angle, theta / angle) * to_eigen(field.orientation);
            else
                probe.orientation = to_eigen(field.orientation);
            const Wrench w = felt_of(field, probe);
            Six out;
            out << w.force, w.torque / metres;
            return out;
        };
        for (int k = 0; k < 20; ++k) {
            Six z;
            const double angle = std::min(2.5, field.angle * uniform(rng, 0, 2));
            z << field.radius * uniform(rng, 0, 2) * direction(rng), metres * angle * direction(rng);
            Eigen::Matrix<double, 6, 6> h;
            const double step = 1e-6 * std::min(field.radius, metres * field.angle);
            for (int c = 0; c < 6; ++c) {
                const Six e = step * Six::Unit(c);
                h.col(c) = (wrench(z + e) - wrench(z - e)) / (2 * step);
            }
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> values(0.5 *
                                                                                    (h + h.transpose()));
            ASSERT_LE(-values.eigenvalues()[0], field.stiffness + 2) << "seed " << seed << " case " << i;
            ASSERT_LE(-values.eigenvalues()[0], device.max_stiffness + 2) << "seed " << seed << " case " << i;
            most = std::max(most, -values.eigenvalues()[0]);
        }
    }
    std::printf("seed %lu: steepest felt %.0f N/m of 2000\n", seed, most);
}

TEST(TaylorEdges, TheForceIsContinuousAndTheCoreIsTheSeries) {
    const std::uint64_t seed = 417;
    Rng rng(seed);
    for (int i = 0; i < 300; ++i) {
        const bool six = i % 4 >= 2;
        const TaylorEdge edge = i % 2 ? TaylorEdge::hold : TaylorEdge::fade;
        const Taylor three = prepared(random_field(rng, edge), i % 3 ? device : Limits{});
        const Taylor6 both = prepared(random_field6(rng, edge), i % 3 ? device : Limits{});
        const Vector u = direction(rng), axis = direction(rng);
        const double core = edge == TaylorEdge::hold ? 1 : six ? both.core : three.core;
        Wrench last;
        constexpr int steps = 20'000;
        double most = 0;
        for (int k = 0; k <= steps; ++k) {
            const double s = 1.3 * k / steps;
            Probe probe;
            Wrench w, series;
            if (six) {
                const double angle = s * both.angle;
                probe = at(to_eigen(both.origin) + s * both.radius * u);
                probe.orientation = Eigen::AngleAxisd(angle, axis) * to_eigen(both.orientation);
                w = felt_of(both, probe);
                Eigen::Matrix<double, 6, 1> z;
                z << s * both.radius * u, angle * axis;
                const Eigen::Matrix<double, 6, 1> change = to_eigen(both.jacobian) * z;
                series = {.force = to_eigen(both.force) + change.head<3>(),
                          .torque = to_eigen(both.torque) + change.tail<3>()};
            } else {
                probe = at(to_eigen(three.origin) + s * three.radius * u);
                w = felt_of(three, probe);
                series.force = to_eigen(three.force) + to_eigen(three.jacobian) * (s * three.radius * u);
            }
            if (s <= core) {
                ASSERT_LE((w.force - series.force).norm(), 1e-11) << i << " " << s;
                ASSERT_LE((w.torque - series.torque).norm(), 1e-11) << i << " " << s;
            }
            most = std::max(most, series.force.norm() + series.torque.norm());
            if (k >
                0) {  // a smoothstep of a fifth: 7.5, twice that of its slope, over a core that has shrunk less
                const double step = (w.force - last.force).norm() + (w.torque - last.torque).norm();
                ASSERT_LE(step, 400 * (1.3 / steps) * (most + 1))
                    << "seed " << seed << " case " << i << " at " << s;
            }
            last = w;
        }
        if (edge == TaylorEdge::fade) {
            ASSERT_EQ(last.force.norm() + last.torque.norm(), 0) << i;
        }
    }
}

}  // namespace taylor_edges_tests
