// Springs without rest length on one probe: each separately, or all as one. About a local origin o,
//     K = sum k, A = sum k (a - o), B = sum k b, M = sum k b (a - o)^T
//     F = A - K (p - o) - R B,   torque = axial(R M) - (R B) x (p - o)

#include <random>

#include <knurl/reps/collapsed_springs.hpp>
#include <knurl/reps/scene.hpp>

#include "panel.hpp"

namespace knurl::error {
namespace {

template <class Real>
struct Collapsed {
    Eigen::Matrix<Real, 3, 1> o, a, b;
    Eigen::Matrix<Real, 3, 3> m;
    Real k = 0;

    explicit Collapsed(const std::vector<Spring>& springs) {
        const Eigen::Vector3d origin = to_eigen(springs[0].anchor);
        Eigen::Vector3d sum_a = Eigen::Vector3d::Zero(), sum_b = Eigen::Vector3d::Zero();
        Eigen::Matrix3d sum_m = Eigen::Matrix3d::Zero();
        double sum_k = 0;
        for (const Spring& s : springs) {
            const Eigen::Vector3d from = to_eigen(s.anchor) - origin, at = to_eigen(s.attach);
            sum_k += s.stiffness;
            sum_a += s.stiffness * from;
            sum_b += s.stiffness * at;
            sum_m += s.stiffness * at * from.transpose();
        }
        o = origin.cast<Real>(), a = sum_a.cast<Real>(), b = sum_b.cast<Real>(), m = sum_m.cast<Real>();
        k = static_cast<Real>(sum_k);
    }
    Wrench operator()(const Probe& probe) const {
        const Eigen::Matrix<Real, 3, 1> p = probe.position.cast<Real>() - o;
        const Eigen::Matrix<Real, 3, 3> r = probe.orientation.cast<Real>().toRotationMatrix(), w = r * m;
        const Eigen::Matrix<Real, 3, 1> rb = r * b, f = a - k * p - rb;
        const Eigen::Matrix<Real, 3, 1> axial(w(1, 2) - w(2, 1), w(2, 0) - w(0, 2), w(0, 1) - w(1, 0));
        const Eigen::Matrix<Real, 3, 1> t = axial - rb.cross(p);
        return {f.template cast<double>(), t.template cast<double>()};
    }
};

/// N, and torque as N at an arm of 30 mm.
double distance(const Wrench& got, const Eigen::Matrix<long double, 6, 1>& exact) {
    const double force = static_cast<double>((got.force.cast<long double>() - exact.head<3>()).norm());
    const double torque = static_cast<double>((got.torque.cast<long double>() - exact.tail<3>()).norm());
    return std::max(force, torque / 0.03);
}

Eigen::Matrix<long double, 6, 1> exact_at(const std::vector<Spring>& springs, const Probe& probe) {
    using Vector = Eigen::Matrix<long double, 3, 1>;
    Eigen::Matrix<long double, 6, 1> sum = Eigen::Matrix<long double, 6, 1>::Zero();
    const Eigen::Quaternion<long double> turn = probe.orientation.cast<long double>().normalized();
    for (const Spring& s : springs) {
        const Vector arm = turn * to_eigen(s.attach).cast<long double>();
        const Vector f = static_cast<long double>(s.stiffness) *
                         (to_eigen(s.anchor).cast<long double>() - probe.position.cast<long double>() - arm);
        sum.head<3>() += f;
        sum.tail<3>() += arm.cross(f);
    }
    return sum;
}

}  // namespace

Panel springs(const measure::Stopwatch& watch) {
    Panel panel{.name = "springs",
                .error_unit = "N",
                .error_meaning = "largest error of force, or of torque at 30 mm",
                .exact = 1e-10,
                .points = {}};
    panel.points.reserve(64);
    const Limits limits;
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<> any(-1, 1);
    for (const int count : {1, 6, 64, 1000}) {
        std::vector<Spring> all;
        std::vector<Spring::State> states;
        Scene scene({.representations = 1024, .probes = 1}, limits);
        for (int i = 0; i < count; ++i) {
            const Spring sent{.anchor = {0.1 * any(rng), 0.1 * any(rng), 0.1 * any(rng)},
                              .attach = {0.03 * any(rng), 0.03 * any(rng), 0.03 * any(rng)},
                              .stiffness = 200.0 / count * (1.5 + any(rng))};
            const Spring spring = prepared(sent, limits);
            all.push_back(spring);
            Spring::State state;
            settle(spring, state);
            states.push_back(state);
            (void)scene.add({static_cast<std::uint32_t>(i), 1}, sent, {.feedback = 0});
        }
        scene.settle();
        std::vector<Probe> probes(64);
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const double phase = static_cast<double>(i) * M_PI / 32;
            probes[i].position = {0.02 * std::sin(phase), 0.02 * std::cos(phase), 0.01};
            probes[i].orientation =
                Eigen::AngleAxisd(0.3 * std::sin(phase), Eigen::Vector3d(1, 2, 3).normalized());
        }
        CollapsedSprings ours;
        for (const Spring& spring : all) ours.add(spring, spring.anchor);
        const Collapsed<double> one(all);
        const Collapsed<float> small(all);

        const std::function<Wrench(const Probe&)> by_loop = [&](const Probe& probe) {
            Wrench sum;
            for (std::size_t i = 0; i < all.size(); ++i) sum += evaluate(all[i], states[i], probe, 1e-3);
            return sum;
        };
        struct Entry {
            const char* name;
            std::function<Wrench(const Probe&)> wrench;
            bool knurl;
            std::string flaw;
        };
        const std::vector<Entry> entries = {
            {"each by itself", by_loop, false, {}},
            {"as one", [&](const Probe& probe) { return ours.evaluate(probe); }, true, {}},
            {"as one, by matrices", [&](const Probe& probe) { return one(probe); }, false, {}},
            {"as one, by matrices, float", [&](const Probe& probe) { return small(probe); }, false, {}},
            {"a whole cycle of Scene",
             [&](const Probe& probe) { return scene.evaluate(probe, 1e-3); },
             false,
             {}},
        };
        std::vector<Contender> contenders;
        for (const Entry& entry : entries) {
            double error = 0;
            for (const Probe& probe : probes)
                error = std::max(error, distance(entry.wrench(probe), exact_at(all, probe)));
            Point* point = &panel.points.emplace_back(
                Point{.scene = std::to_string(count) + (count == 1 ? " spring" : " springs"),
                      .size = static_cast<double>(count),
                      .implementation = entry.name,
                      .error = error,
                      .knurl = entry.knurl,
                      .flaw = entry.flaw});
            contenders.push_back({point, [&probes, wrench = entry.wrench, next = 0u](int calls) mutable {
                                      for (int i = 0; i < calls; ++i) keep(wrench(probes[next++ & 63]));
                                  }});
        }
        race(watch, contenders);
    }
    return panel;
}

}  // namespace knurl::error
