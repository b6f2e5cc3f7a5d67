#include "delta_error.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <benchmark/benchmark.h>

#include <knurl/drivers/delta.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::drivers {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Angles = std::array<double, 3>;

constexpr std::size_t cycles = 2048;  // of a path, at 1 kHz
constexpr int blocks = 41;            // of each implementation, in turn
const Vector3d middle(0, 0, falcon_centre);

struct Path {
    std::vector<Angles> joints;
    std::vector<Vector3d> position;  // m, the truth
};

/// A closed curve through most of a ball of 45 mm, at a steady speed.
Path path_at(const Delta& delta, double speed) {
    Path path;
    double phase = 0;
    for (std::size_t i = 0; i < cycles; ++i) {
        const auto at = [](double t) {
            return Vector3d(0.026 * std::sin(3 * t), 0.026 * std::sin(4 * t + 1),
                            0.026 * std::sin(5 * t + 2));
        };
        const double slope = (at(phase + 1e-4) - at(phase - 1e-4)).norm() / 2e-4;
        phase += speed * 1e-3 / std::max(slope, 0.01);
        Angles q{};
        path.position.push_back(middle + at(phase));
        delta.inverse(path.position.back(), q);
        path.joints.push_back(q);
    }
    return path;
}

/// One cycle: from the angles and the two poses before to the pose. `jacobian` is J^T F's.
using Solve = std::function<void(const Angles&, Vector3d& last, Vector3d& before_last, Matrix3d& jacobian)>;

/// Takes `steps` Newton steps from wherever `start` says. None still ask for one, since it brings the
/// Jacobian.
template <class Start>
Solve newton(const Delta& delta, int steps, Start start) {
    return
        [&delta, steps, start](const Angles& q, Vector3d& last, Vector3d& before_last, Matrix3d& jacobian) {
            const Delta::Cranks ends = delta.cranks(q);
            Vector3d position = start(ends, last, before_last), change;
            if (steps == 0) delta.step(ends, position, change, jacobian);
            for (int i = 0; i < (steps == DeltaPoint::until_settled ? Delta::most_steps : steps); ++i) {
                if (!delta.step(ends, position, change, jacobian)) break;
                position += change;
                if (steps == DeltaPoint::until_settled && change.norm() < Delta::enough) break;
            }
            before_last = last;
            last = position;
        };
}

struct Contestant {
    DeltaPoint point;
    Solve solve;
    std::vector<double> ns = {};
};

void measure_one(Contestant& contestant, const Path& path, const measure::Stopwatch& watch, bool errors) {
    Vector3d last = path.position[1], before_last = path.position[0];
    Matrix3d jacobian;
    if (errors) {
        std::vector<double> miss;
        for (std::size_t i = 2; i < cycles; ++i) {
            contestant.solve(path.joints[i], last, before_last, jacobian);
            miss.push_back((last - path.position[i]).norm());
        }
        std::sort(miss.begin(), miss.end());
        contestant.point.worst = miss.back();
        contestant.point.median = miss[miss.size() / 2];
        return;
    }
    const auto begin = measure::Stopwatch::begin();
    for (std::size_t i = 2; i < cycles; ++i) {
        contestant.solve(path.joints[i], last, before_last, jacobian);
        const Vector3d efforts = jacobian.transpose() * last;
        benchmark::DoNotOptimize(efforts.data());
    }
    contestant.ns.push_back(watch.nanoseconds(begin, measure::Stopwatch::end()) / (cycles - 2));
}

}  // namespace

std::vector<DeltaPoint> delta_run_time_against_error() {
    const Delta delta(falcon_delta());
    const measure::Stopwatch watch;
    std::vector<DeltaPoint> points;
    for (const double speed : {0.05, 0.3, 1.0}) {
        const Path path = path_at(delta, speed);
        std::vector<Contestant> contestants;
        for (int steps = DeltaPoint::until_settled; steps <= 6; ++steps) {
            const auto enrol = [&](const char* name, auto start) {
                Contestant contestant;
                contestant.point.start = name;
                contestant.point.speed = speed;
                contestant.point.steps = steps;
                contestant.solve = newton(delta, steps, start);
                contestants.push_back(std::move(contestant));
            };
            enrol("three spheres", [&delta](const Delta::Cranks& ends, const Vector3d&, const Vector3d&) {
                return delta.three_spheres(ends);
            });
            contestants.back().point.knurl = steps == DeltaPoint::until_settled;
            enrol("last pose",
                  [](const Delta::Cranks&, const Vector3d& last, const Vector3d&) { return last; });
            enrol("last pose moved on", [](const Delta::Cranks&, const Vector3d& last,
                                           const Vector3d& before) { return Vector3d(2 * last - before); });
            enrol("centre", [](const Delta::Cranks&, const Vector3d&, const Vector3d&) { return middle; });
        }
        for (Contestant& contestant : contestants) measure_one(contestant, path, watch, true);
        for (int block = 0; block < blocks; ++block)
            for (Contestant& contestant : contestants) measure_one(contestant, path, watch, false);
        for (Contestant& contestant : contestants) {
            std::nth_element(contestant.ns.begin(), contestant.ns.begin() + blocks / 2, contestant.ns.end());
            contestant.point.ns = contestant.ns[blocks / 2];
            points.push_back(contestant.point);
        }
    }
    return points;
}

}  // namespace knurl::drivers
