#include "device_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/measure/measure.hpp>
#include <knurl/servo/servo.hpp>

#include "device_bench.hpp"

namespace knurl::cli {

namespace {

using drivers::ReadStatus;
using Eigen::Vector3d;

constexpr double fastest_ringing = 0.5;  // m/s: a wall with this speed hums
constexpr double calming_damping = 2;    // N s/m
constexpr int servo_priority = 80;
constexpr int round_trips = 1000;

HomingTrial home(Bench& bench, const TrialOptions& options) {
    HomingTrial homing;
    bench.run(options.homing_time, [&](const Moment& m, Wrench&) {
        homing.done = m.status == ReadStatus::ok && m.sample.calibrated && bench.known();
        if (!homing.done) homing.seconds = m.t;
        return !homing.done;
    });
    if (homing.seconds < 0.1) homing.seconds = 0;
    return homing;
}

RestTrial rest(Bench& bench, const drivers::LinkConfig& link, const TrialOptions& options) {
    RestTrial rest;
    constexpr double seconds = 2;
    const auto joints = static_cast<std::size_t>(link.sensed_joints);
    std::vector<double> low(joints, std::numeric_limits<double>::infinity()), high(joints, -low[0]);
    std::vector<Vector3d> tips;
    const Eigen::Quaterniond first = bench.moment().orientation;
    bench.run(seconds, [&](const Moment& m, Wrench&) {
        ++rest.cycles;
        rest.fresh += m.status == ReadStatus::ok;
        rest.stale += m.status == ReadStatus::stale;
        rest.bad += m.status == ReadStatus::bad;
        if (!options.virtual_time) {
            rest.lateness.push_back(m.lateness);
            if (rest.cycles > 1) rest.transfer.push_back(m.transfer);
        }
        for (std::size_t j = 0; j < joints; ++j) {
            low[j] = std::min(low[j], m.sample.position[j]);
            high[j] = std::max(high[j], m.sample.position[j]);
        }
        tips.push_back(m.position);
        rest.turned_apart = std::max(rest.turned_apart, turn_between(first, m.orientation).norm());
        return true;
    });
    rest.sample_rate = static_cast<double>(rest.fresh) / seconds;
    rest.round_trip = bench.round_trips(round_trips);
    for (std::size_t j = 0; j < joints; ++j) {
        const double count = j < link.radians_per_count.size() ? link.radians_per_count[j] : 0;
        rest.counts_apart.push_back(count > 0 ? (high[j] - low[j]) / count : 0);
    }
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& tip : tips) mean += tip / static_cast<double>(tips.size());
    double square = 0;
    for (const Vector3d& tip : tips) {
        square += (tip - mean).squaredNorm() / static_cast<double>(tips.size());
        rest.tip_apart = std::max(rest.tip_apart, (tip - mean).norm());
    }
    rest.tip_noise = std::sqrt(square);
    return rest;
}

/// How it is moved: pushed (N, m, kg) or turned (N m, rad, kg m^2).
enum class By : std::uint8_t { force, torque };

/// Half the difference of the two directions, sample by sample: gravity and drift are in both.
std::vector<Vector3d> both_ways(Bench& bench, By by, const Vector3d& push, const Moment& home) {
    constexpr double seconds = 0.03;
    std::array<std::vector<Vector3d>, 2> path;
    for (const int way : {0, 1}) {
        bench.settle(0.4, home);
        const Moment begin = bench.moment();
        bench.run(seconds, [&](const Moment& m, Wrench& wanted) {
            (by == By::force ? wanted.force : wanted.torque) = way == 0 ? push : Vector3d(-push);
            path[static_cast<std::size_t>(way)].push_back(
                by == By::force ? Vector3d(m.position - begin.position)
                                : turn_between(begin.orientation, m.orientation));
            return true;
        });
    }
    std::vector<Vector3d> half;
    for (std::size_t i = 0; i < std::min(path[0].size(), path[1].size()); ++i)
        half.push_back((path[0][i] - path[1][i]) / 2);
    return half;
}

/// From m x'' = F - b x': x + (b/m) (its integral) = a/2 (t - tau)^2. The square root of twice that is a line
/// in t: its slope is sqrt(a), its zero tau. Least squares over values well above a count. `slowing`: b/m.
struct Start {
    double acceleration = 0, delay = 0;
};
Start fit(const std::vector<Vector3d>& path, const Vector3d& axis, double period, double count,
          double slowing) {
    double n = 0, t1 = 0, t2 = 0, y1 = 0, ty = 0, integral = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const double x = path[i].dot(axis), t = static_cast<double>(i) * period;
        integral += x * period;
        if (x < 4 * count) continue;
        const double y = std::sqrt(2 * (x + slowing * integral));
        n += 1, t1 += t, t2 += t * t, y1 += y, ty += t * y;
    }
    const double det = n * t2 - t1 * t1;
    if (n < 3 || !(det > 0)) return {};
    const double slope = (n * ty - t1 * y1) / det, at_zero = (y1 - slope * t1) / n;
    if (!(slope > 0)) return {};
    return {slope * slope, -at_zero / slope};
}

/// `large`: N (N m). `count`: m (rad). `damping`: N s/m (N m s/rad), the device's own.
PushTrial push(Bench& bench, By by, const Vector3d& axis, double large, const Moment& home, double count,
               double damping) {
    PushTrial trial;
    trial.axis = axis;
    const double small = large / 2, rate = bench.options().rate;
    const std::vector<Vector3d> weak = both_ways(bench, by, small * axis, home),
                                strong = both_ways(bench, by, large * axis, home);
    const Vector3d way = strong.back();
    trial.cosine = way.norm() > 4 * count ? way.normalized().dot(axis) : 0;
    double slowing = 0;
    for (int i = 0; i < 4; ++i) {  // iterated, since the mass by which b is divided is unknown
        const Start a1 = fit(weak, axis, 1 / rate, count, slowing),
                    a2 = fit(strong, axis, 1 / rate, count, slowing);
        if (!(a2.acceleration > a1.acceleration && a1.acceleration > 0)) return trial;
        trial.delay = std::max(0.0, a2.delay);
        trial.mass = (large - small) / (a2.acceleration - a1.acceleration);
        trial.friction = std::max(0.0, small - trial.mass * a1.acceleration);
        slowing = damping / trial.mass;
    }
    if (by == By::force && bench.link().apparent_mass > 0)
        trial.size = bench.link().apparent_mass / trial.mass;
    return trial;
}

std::vector<PushTrial> along_each_axis(Bench& bench, By by, double large, const Moment& home, double count) {
    const double damping = by == By::force ? bench.link().damping : bench.link().rotational_damping;
    std::vector<PushTrial> pushes;
    for (const Vector3d& axis :
         {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitY()), Vector3d(Vector3d::UnitZ())})
        pushes.push_back(push(bench, by, axis, large, home, count, damping));
    return pushes;
}

/// Presses against a wall of this stiffness and knocks: does the ringing die away? First damping brings it to
/// rest, so that only the knock rings.
bool rings_down(Bench& bench, const Moment& home, double stiffness, double mass, double count) {
    const TrialOptions& options = bench.options();
    constexpr double calming = 0.5, knock = 0.01;  // s
    // Compares the first and the last third: each contains a whole period.
    const double listening = 3 * std::max(0.2, 1.2 * 2 * M_PI * std::sqrt(mass / stiffness));
    const Vector3d normal = Vector3d::UnitZ();
    bench.settle(0.4, home);
    const double wall = bench.moment().position.z() - 1e-3;
    struct Span {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        void add(double x) { low = std::min(low, x), high = std::max(high, x); }
        double size() const { return high - low; }
    } early, late;
    bool calm = true;
    bench.run(calming + knock + listening, [&](const Moment& m, Wrench& wanted) {
        const double depth = wall - m.position.z(), since = m.t - calming - knock;
        double push = -options.push / 2;
        if (since < -knock) {
            wanted.force = -calming_damping * m.velocity;
        } else if (since < 0) {
            push -= options.push / 2;
        } else if (since < listening / 3) {
            early.add(depth);
        } else if (since > 2 * listening / 3) {
            late.add(depth);
        }
        wanted.force += (std::max(0.0, stiffness * depth) + push) * normal;
        calm = m.velocity.norm() < fastest_ringing;
        return calm;
    });
    return calm && late.size() <= std::max(early.size(), 2 * count);
}

/// `mass`: effective mass along the wall's normal, kg.
WallTrial wall(Bench& bench, const Moment& home, double mass, double count) {
    WallTrial trial;
    const TrialOptions& options = bench.options();
    trial.predicted = servo::max_stiffness(bench.link(), options.rate);
    trial.held = bench.link().grip_damping > 0;
    constexpr double most = 1e4, deepest = 10e-3;  // N/m; m, depth in the softest wall under the pressing
                                                   // force
    double stable = std::clamp(trial.predicted / 4, options.push / 2 / deepest, most), unstable = stable;
    if (!rings_down(bench, home, stable, mass, count)) return trial;
    while (unstable < most) {
        unstable = std::min(most, unstable * 1.5);
        if (!rings_down(bench, home, unstable, mass, count)) break;
        stable = unstable;
        trial.bounded = stable >= most;
        if (trial.bounded) break;
    }
    while (!trial.bounded && unstable > 1.03 * stable) {
        const double middle = std::sqrt(stable * unstable);
        (rings_down(bench, home, middle, mass, count) ? stable : unstable) = middle;
    }
    trial.stiffness = stable;
    return trial;
}

}  // namespace

Trial try_device(drivers::Device& device, const TrialOptions& options,
                 const std::function<void(const std::string&)>& tell) {
    Trial trial;
    trial.link = device.link();
    const bool takes_force = trial.link.actuated_joints > 0;
    const bool turns = takes_force && trial.link.renders_torque && trial.link.senses_orientation;
    const int parts = 2 + (takes_force ? 2 : 0) + (turns ? 1 : 0);
    auto say = [&, part = 0](const std::string& text) mutable {
        tell(fmt::format("{} of {}: {}", ++part, parts, text));
    };
    trial.rate = options.rate;
    if (!options.virtual_time) {
        measure::pin_this_thread(measure::allowed_cpus().back());
        trial.real_time = measure::run_real_time(servo_priority);
    }
    Bench bench(device, options);
    say(fmt::format(
        "homing: if the device asks for it (a light, or the handbook), move it through its range; "
        "at most {:g} s",
        options.homing_time));
    trial.homing = home(bench, options);
    if (!trial.homing.done) {
        throw std::runtime_error(
            fmt::format("not homed within {:g} s; move every axis to its stops, or give more --homing-time",
                        options.homing_time));
    }
    say("at rest: let go of the handle, it is not pushed for 2 s");
    trial.rest = rest(bench, trial.link, options);
    if (trial.rest.fresh == 0) throw std::runtime_error("it sends no samples; is it powered?");

    const Moment home_at = bench.moment();
    const auto [step, turn] = bench.resolution();
    // A value well above a count and the measured noise is motion.
    const double count = std::max({step, trial.rest.tip_apart, 1e-6}),
                 angle = std::max({turn, trial.rest.turned_apart, 1e-5});
    if (!takes_force) return trial;

    device.notify(drivers::Notice::enabled);
    say(fmt::format("pushes of {:g} and {:g} N along x, y and z: keep your hands off", options.push / 2,
                    options.push));
    trial.pushes = along_each_axis(bench, By::force, options.push, home_at, count);
    if (turns) {
        const double twist = std::min(options.push * twist_lever, trial.link.peak_torque / 2);
        say(fmt::format("turns it with {:g} and {:g} N m about x, y and z", twist / 2, twist));
        trial.turns = along_each_axis(bench, By::torque, twist, home_at, angle);
    }
    say(fmt::format("a wall below: the tip presses on it with {:g} N, and it gets stiffer until it hums",
                    options.push / 2));
    trial.wall = wall(bench, home_at, trial.pushes.back().mass, count);
    bench.settle(0.5, home_at);
    return trial;
}

}  // namespace knurl::cli
