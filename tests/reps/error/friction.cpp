// Friction models: how far a held tip creeps, measured through an encoder. The hand is 0.15 kg and pushes
// with 0.2 N and 0.1 N at 10 Hz against a grip of 1 N (mu 0.4 and 0.8), so that a tip with friction stays in
// place.

#include <cstdio>

#include <knurl/reps/friction.hpp>

#include "friction_models.hpp"
#include "panel.hpp"

namespace knurl::error {
namespace {

using Eigen::Vector3d;

constexpr double count = 30e-6;  // m, the encoder's
constexpr double period = 1e-3;  // s, the servo's

Vector3d rounded(const Vector3d& x) {
    return count * (x / count).array().round().matrix();
}

/// Knurl's: a law, and its state.
struct Anchored {
    FrictionLaw law;
    FrictionState state;
    Limits limits;

    Vector3d operator()(const Vector3d& position, double n, double dt) {
        Rubbing rubbing;
        rubbing.position = position;
        rubbing.normal_force = n;
        return friction_force(law, state, Tangent{}, rubbing, limits, dt);
    }
};

/// A model of motions, fed with positions.
template <class Model>
struct Moving {
    Model model;
    Vector3d last = Vector3d::Zero();

    Vector3d operator()(const Vector3d& position, double n, double dt) {
        const Vector3d dx = position - last;
        last = position;
        return model(dx, n, dt);
    }
};

FrictionLaw snags(SnagLaw law) {
    return friction_law(
        {}, {.k_kinetic = 0.4, .k_stick = 800, .d_snap = 1e-3, .d_mean = 5e-3, .d_spread = 2e-3, .law = law},
        1000, {});
}

using Law = std::function<Vector3d(const Vector3d& position, double n, double dt)>;

/// mm between the means of the first and the last second of 16 s (without the first second, in which the tip
/// settles).
double drift(Law law) {
    Vector3d x = Vector3d::Zero(), force = Vector3d::Zero();
    double v = 0, first = 0, last = 0;
    constexpr double step = 1e-4;  // s, of the hand
    constexpr int steps = 170'000, second = 10'000;
    for (int i = 0; i < steps; ++i) {
        if (i % 10 == 0) force = law(rounded(x), 1, period);
        v += step / 0.15 * (0.2 + 0.1 * std::sin(2 * M_PI * 10 * i * step) + force.x() - 3.2 * v);
        x.x() += step * v;
        if (!std::isfinite(x.x())) return 1e6;
        if (i >= second && i < 2 * second) first += x.x() / second;
        if (i >= steps - second) last += x.x() / second;
    }
    return 1e3 * std::abs(last - first);
}

/// mJ that the hand gains on each of ten loops: out by 0.9 mm, press twice as hard, back, release.
double gained(Law law) {
    double work = 0, x = 0;
    Vector3d force = law({x, 0, 0}, 1, period);
    const auto go = [&](double to, double n) {
        const double step = (to - x) / 100;
        for (int i = 0; i < 100; ++i) {
            x += step;
            const Vector3d next = law({x, 0, 0}, n, period);
            work += 0.5 * (force + next).x() * step;
            force = next;
        }
    };
    constexpr int loops = 10;
    for (int i = 0; i < loops; ++i) {
        go(0.9e-3, 1);
        force = law({x, 0, 0}, 2, period);
        go(0, 2);
        force = law({x, 0, 0}, 1, period);
    }
    return 1e3 * work / loops;
}

template <class F>
void add(Panel& panel, std::vector<Contender>& contenders, const char* name, const F& law,
         bool knurl = false) {
    std::string flaw;
    if (const double gain = gained(law); gain > 1e-6) {
        char text[64];
        std::snprintf(text, sizeof text, "not passive: gives %.2f mJ a loop", gain);
        flaw = text;
    }
    Point* point = &panel.points.emplace_back(Point{.scene = "a held tip",
                                                    .size = 1,
                                                    .implementation = name,
                                                    .error = drift(law),
                                                    .knurl = knurl,
                                                    .flaw = flaw});
    // Back and forth, sticking half of the time: the same path for all.
    std::vector<Vector3d> path;
    for (int i = 0; i < 1024; ++i) {
        const double phase = 2 * M_PI * i / 1024;
        path.push_back(rounded({4e-3 * std::sin(phase) * std::sin(phase), 1e-3 * std::sin(2 * phase), 0}));
    }
    contenders.push_back({point, [law = law, path, next = 0u](int calls) mutable {
                              for (int i = 0; i < calls; ++i) keep(law(path[next++ & 1023], 1, period));
                          }});
}

}  // namespace

Panel friction(const measure::Stopwatch& watch) {
    Panel panel{.name = "friction",
                .error_unit = "mm",
                .error_meaning = "drift of a held tip in 15 s",
                .exact = 1e-3,
                .points = {}};
    panel.points.reserve(16);  // the contenders point into it
    std::vector<Contender> contenders;
    const FrictionLaw coulomb = friction_law({.static_ = 0.8, .dynamic = 0.4}, {}, 800, {});
    add(panel, contenders, "elastic Coulomb", Anchored{coulomb, {}, {}}, true);
    add(panel, contenders, "snags, passive", Anchored{snags(SnagLaw::passive), {}, {}}, true);
    add(panel, contenders, "snags, the paper's law", Anchored{snags(SnagLaw::paper), {}, {}});
    add(panel, contenders, "Dahl, exact step", Moving<Dahl>{});
    add(panel, contenders, "LuGre, exact step", Moving<LuGre>{});
    add(panel, contenders, "LuGre, Euler", Moving<LuGre>{.model = {.f = {}, .exact = false}});
    add(panel, contenders, "velocity Coulomb", Moving<VelocityCoulomb>{});
    race(watch, contenders);
    return panel;
}

}  // namespace knurl::error
