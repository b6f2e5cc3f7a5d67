// Surfaces sent by an application at 1 to 1000 Hz: the rendered force along a given stroke, against that of
// the true surface. A sine sheet, stroked at 0.1 m/s, 1.5 to 2.5 mm deep, k = 1000 N/m; servo 1 kHz, encoder
// 30 um, device 8.5 N; an answer acts half a period after the hand was read. The path is given, without
// dynamics, so an error belongs to the representation. Planes, spheres and caps go through the whole Scene,
// cross-fade included.

#include <optional>

#include <knurl/reps/cap.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/reps/sphere.hpp>

#include "panel.hpp"

namespace knurl::error {
namespace {

using Eigen::Vector3d;

constexpr double stiffness = 1000;  // N/m
constexpr double strongest = 8.5;   // N
constexpr double count = 30e-6;     // m, the encoder's
constexpr double period = 1e-3;     // s, the servo's
constexpr double speed = 0.1;       // m/s
constexpr int cycles = 6000;
constexpr int ignored = 2000;  // cycles at the start, until the slowest application has sent an update

/// z = amplitude sin(x / scale).
struct Sine {
    const char* name;
    double amplitude, scale;  // m

    double z(double x) const { return amplitude * std::sin(x / scale); }
    double slope(double x) const { return amplitude / scale * std::cos(x / scale); }
    double bend(double x) const { return -amplitude / (scale * scale) * std::sin(x / scale); }

    /// The x of the point nearest to (px, pz), by Newton from `x`: where (px - x) + (pz - z) z' = 0.
    double foot(double px, double pz, double x) const {
        for (int i = 0; i < 20; ++i) {
            const double dz = pz - z(x), s = slope(x);
            const double value = (px - x) + dz * s, rate = dz * bend(x) - s * s - 1;
            const double step = rate < 0 ? -value / rate : std::copysign(0.1 * scale, value);
            x += std::clamp(step, -0.2 * scale, 0.2 * scale);
            if (std::abs(step) < 1e-12) break;
        }
        return x;
    }
    Vector3d point(double x) const { return {x, 0, z(x)}; }
    Vector3d normal(double x) const { return Vector3d(-slope(x), 0, 1).normalized(); }
    /// Positive: hollow.
    double curvature(double x) const { return bend(x) / std::pow(1 + slope(x) * slope(x), 1.5); }
};
constexpr Sine sines[] = {{"gentle", 5e-3, 80e-3 / (2 * M_PI)}, {"harsh", 3e-3, 40e-3 / (2 * M_PI)}};

struct Cycle {
    Probe probe;     // as the encoder has it
    Vector3d force;  // N, of the true surface at the true place
};

Vector3d limited(const Vector3d& force) {
    return force.norm() > strongest ? Vector3d(force * (strongest / force.norm())) : force;
}

std::vector<Cycle> stroke(const Sine& sine) {
    std::vector<Cycle> all(cycles);
    double x = 0;
    Vector3d last = Vector3d::Zero(), slow = Vector3d::Zero();
    const double share = period / (period + 1 / (2 * M_PI * 20));  // first order 20 Hz, for prediction
    for (int i = 0; i < cycles; ++i) {
        const double depth = 2e-3 + 0.5e-3 * std::sin(2 * M_PI * 0.7 * i * period);
        const Vector3d true_place = sine.point(x) - depth * sine.normal(x);
        Cycle& cycle = all[static_cast<std::size_t>(i)];
        cycle.probe.position = count * (true_place / count).array().round().matrix();
        if (i == 0) last = cycle.probe.position;
        slow += share * ((cycle.probe.position - last) / period - slow);
        last = cycle.probe.position;
        cycle.probe.velocity = cycle.probe.smooth_velocity = slow;
        cycle.force = stiffness * depth * sine.normal(x);
        x += speed * period / std::sqrt(1 + sine.slope(x) * sine.slope(x));
    }
    return all;
}

enum class Form { force, plane, sphere, cap };
struct Answer {
    int felt = 0;  // the first cycle in which it acts
    Vector3d force = Vector3d::Zero();
    Plane plane;
    Sphere sphere;
    Cap cap;
};

/// All updates of the application on that stroke.
std::vector<Answer> answers(const Sine& sine, const std::vector<Cycle>& path, double rate, bool predicted) {
    std::vector<Answer> all;
    const double interval = 1 / rate, latency = std::max(interval / 2, period);
    double foot = 0;
    for (double t = 0; t < cycles * period - 1e-9; t += interval) {
        const Probe& hand = path[static_cast<std::size_t>(t / period + 1e-6)].probe;
        Vector3d ahead = (latency + interval / 2) * hand.velocity;
        if (ahead.norm() > 0.02) ahead *= 0.02 / ahead.norm();
        const Vector3d p = hand.position + (predicted ? ahead : Vector3d(Vector3d::Zero()));
        foot = sine.foot(p.x(), p.z(), p.x());
        const Vector3d f = sine.point(foot), n = sine.normal(foot);
        const double bend = sine.curvature(foot), firm = std::copysign(std::max(std::abs(bend), 1e-3), bend);
        Answer answer;
        answer.felt = static_cast<int>((t + latency) / period + 0.5);
        answer.force = stiffness * std::max(0.0, n.dot(f - p)) * n;
        answer.plane = {.normal = to_plain(n), .offset = n.dot(f), .stiffness = stiffness};
        answer.sphere = {.center = to_plain(f + n / firm),
                         .radius = 1 / std::abs(firm),
                         .side = firm > 0 ? Side::inside : Side::outside,
                         .stiffness = stiffness};
        answer.cap = {.foot = to_plain(f), .normal = to_plain(n), .curvature = bend, .stiffness = stiffness};
        all.push_back(answer);
    }
    return all;
}

template <class R>
const R& part(const Answer& answer) {
    if constexpr (std::is_same_v<R, Plane>) return answer.plane;
    if constexpr (std::is_same_v<R, Sphere>) return answer.sphere;
    if constexpr (std::is_same_v<R, Cap>) return answer.cap;
}

/// Runs the stroke cycle by cycle, endlessly: at its end it restarts.
template <class R>
class StrokeRunner {
  public:
    StrokeRunner(const std::vector<Cycle>& path, std::vector<Answer> said, double rate)
        : path_(&path),
          said_(std::move(said)),
          scene_({.representations = 4, .probes = 1}, {.max_force = strongest}) {
        scene_.set_fade({.automatic = automatic_fade(1 / rate)});
    }
    Vector3d next() {
        if (cycle_ == cycles) cycle_ = 0, next_ = 0;
        if (cycle_ == 0) {
            scene_.clear();
            (void)scene_.add({0, 1}, part<R>(said_[0]));
            scene_.settle();
        }
        while (next_ < said_.size() && said_[next_].felt <= cycle_)
            (void)scene_.update({0, 1}, part<R>(said_[next_++]));
        return scene_.evaluate((*path_)[static_cast<std::size_t>(cycle_++)].probe, period).force;
    }

  private:
    const std::vector<Cycle>* path_;
    std::vector<Answer> said_;
    Scene scene_;
    int cycle_ = 0;
    std::size_t next_ = 0;
};

/// The force that the application computed, held until the next.
class Held {
  public:
    Held(std::vector<Answer> said) : said_(std::move(said)) {}
    Vector3d next() {
        if (cycle_ == cycles) cycle_ = 0, next_ = 0;
        while (next_ < said_.size() && said_[next_].felt <= cycle_) force_ = limited(said_[next_++].force);
        ++cycle_;
        return force_;
    }

  private:
    std::vector<Answer> said_;
    Vector3d force_ = Vector3d::Zero();
    int cycle_ = 0;
    std::size_t next_ = 0;
};

/// The true surface in the servo, if it is known: its foot point in each cycle, starting at the last one.
class True {
  public:
    True(const Sine& sine, const std::vector<Cycle>& path) : sine_(sine), path_(&path) {}
    Vector3d next() {
        if (cycle_ == cycles) cycle_ = 0;
        const Vector3d& p = (*path_)[static_cast<std::size_t>(cycle_)].probe.position;
        foot_ = sine_.foot(p.x(), p.z(), cycle_++ == 0 ? p.x() : foot_);
        const Vector3d n = sine_.normal(foot_);
        return limited(stiffness * std::max(0.0, n.dot(sine_.point(foot_) - p)) * n);
    }

  private:
    Sine sine_;
    const std::vector<Cycle>* path_;
    double foot_ = 0;
    int cycle_ = 0;
};

template <class F>
void add(Panel& panel, std::vector<Contender>& contenders, const std::vector<Cycle>& path,
         const Point& described, F felt) {
    double square = 0;
    for (int i = 0; i < cycles; ++i) {
        const Vector3d off = felt.next() - path[static_cast<std::size_t>(i)].force;
        if (i >= ignored) square += off.squaredNorm() / (cycles - ignored);
    }
    Point* point = &panel.points.emplace_back(described);
    point->error = std::sqrt(square);
    auto shared = std::make_shared<F>(std::move(felt));
    contenders.push_back({point, [shared](int calls) {
                              for (int i = 0; i < calls; ++i) keep(shared->next());
                          }});
}

/// A held force has no stiffness: it is stable only up to b / (T/2 + L + tau), with a hand and a device of
/// 3.2 N s/m and 0.53 ms, and an application that is half a period late.
std::string held_is_stable(double rate) {
    const double most = 3.2 / (0.5 / rate + std::max(0.5 / rate, period) + 0.53e-3);
    return most < stiffness ? "stable up to " + std::to_string(static_cast<int>(most)) + " N/m"
                            : std::string();
}

}  // namespace

Panel surfaces(const measure::Stopwatch& watch) {
    Panel panel{.name = "surfaces",
                .error_unit = "N",
                .error_meaning = "RMS force error along a stroke at 0.1 m/s, k = 1000 N/m",
                .exact = 0,
                .useless = 1,  // half of the true force
                .points = {}};
    panel.points.reserve(128);
    for (const Sine& sine : sines) {
        const std::vector<Cycle> path = stroke(sine);
        for (const double rate : {1.0, 5.0, 20.0, 100.0, 1000.0}) {
            std::vector<Contender> contenders;
            const auto described = [&](const char* name, bool knurl = false, std::string flaw = {}) {
                return Point{
                    .scene = std::string(sine.name) + ", " + std::to_string(static_cast<int>(rate)) + " Hz",
                    .size = rate,
                    .implementation = name,
                    .knurl = knurl,
                    .flaw = std::move(flaw)};
            };
            const std::vector<Answer> late = answers(sine, path, rate, false),
                                      ahead = answers(sine, path, rate, true);
            add(panel, contenders, path, described("force held", false, held_is_stable(rate)), Held(late));
            add(panel, contenders, path, described("plane"), StrokeRunner<Plane>(path, late, rate));
            add(panel, contenders, path, described("plane, predicted"),
                StrokeRunner<Plane>(path, ahead, rate));
            add(panel, contenders, path, described("sphere"), StrokeRunner<Sphere>(path, late, rate));
            add(panel, contenders, path, described("sphere, predicted"),
                StrokeRunner<Sphere>(path, ahead, rate));
            add(panel, contenders, path, described("cap"), StrokeRunner<Cap>(path, late, rate));
            add(panel, contenders, path, described("cap, predicted", true),
                StrokeRunner<Cap>(path, ahead, rate));
            add(panel, contenders, path,
                described("true surface in the servo", false, "needs the application's model there"),
                True(sine, path));
            race(watch, contenders);
        }
    }
    return panel;
}

}  // namespace knurl::error
