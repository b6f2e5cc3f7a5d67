#include "device_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/servo/servo.hpp>
#include <knurl/servo/velocity.hpp>

#include "../measure/measure.hpp"

namespace knurl::cli {

namespace {

using drivers::Nanoseconds;
using drivers::ReadStatus;
using Eigen::Vector3d;

constexpr double fastest = 1;          // m/s: whoever tests a device does not want it to hit anything
constexpr double hold_stiffness = 50;  // N/m, towards where it began, between the trials
constexpr double hold_damping = 2;     // N s/m
constexpr int servo_priority = 80;
constexpr int round_trips = 1000;
constexpr int cold_orders = 3;                      // what the trial before has sent may still be on its way
constexpr Nanoseconds longest_answer = 20'000'000;  // then it is none
constexpr Nanoseconds look = 10'000;                // between looks on a virtual clock

Nanoseconds monotonic() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

/// What one cycle knows.
struct Moment {
    double t = 0;  // s since this part began
    drivers::JointSample sample;
    Vector3d position = Vector3d::Zero();  // m
    Vector3d velocity = Vector3d::Zero();  // m/s, first order 100 Hz
    ReadStatus status = ReadStatus::stale;
    double lateness = 0, transfer = 0;  // s; transfer is the last cycle's
};

class Bench {
  public:
    Bench(drivers::Device& device, const TrialOptions& options)
        : device_(device),
          options_(options),
          period_(std::llround(1e9 / options.rate)),
          now_(options.virtual_time ? 0 : monotonic()) {}
    ~Bench() {
        device_.write(now_, {});
        device_.notify(drivers::Notice::disabled);
    }
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;

    /// Cycles for so long; `force` says what the tip feels (N). It may end the part by returning false.
    template <class Force>
    void run(double seconds, Force force) {
        const Nanoseconds begin = now_;
        const auto cycles = std::llround(seconds * options_.rate);
        for (long long i = 0; i < cycles; ++i) {
            now_ += period_;
            moment_.lateness = wait();
            moment_.t = static_cast<double>(now_ - begin) * 1e-9;
            const Nanoseconds before = options_.virtual_time ? 0 : monotonic();
            read();
            Vector3d wanted = Vector3d::Zero();
            const bool go_on = force(std::as_const(moment_), wanted);
            write(wanted);
            moment_.transfer = options_.virtual_time ? 0 : static_cast<double>(monotonic() - before) * 1e-9;
            if (!go_on) return;
        }
    }
    /// As RestTrial::round_trip. Each is waited for, so that no answer is another order's.
    std::vector<double> round_trips(int count) {
        std::vector<double> took;
        for (int i = 0; i < count + cold_orders; ++i) {
            now_ += period_;
            wait();
            read();
            write(Vector3d::Zero());
            const Nanoseconds sent = clock();
            do {
                if (options_.virtual_time) now_ += look;
                read();
            } while (moment_.status != ReadStatus::ok && clock() - sent < longest_answer);
            if (i >= cold_orders && moment_.status == ReadStatus::ok)
                took.push_back(static_cast<double>(clock() - sent) * 1e-9);
            now_ = std::max(now_, clock());
        }
        return took;
    }
    /// Back to `home`, gently.
    void settle(double seconds, const Vector3d& home) {
        run(seconds, [&](const Moment& m, Vector3d& force) {
            force = hold_stiffness * (home - m.position) - hold_damping * m.velocity;
            if (force.norm() > options_.push) force *= options_.push / force.norm();
            return true;
        });
    }
    const Moment& moment() const { return moment_; }
    bool known() const { return known_; }

  private:
    Nanoseconds clock() const { return options_.virtual_time ? now_ : monotonic(); }
    double wait() {
        if (options_.virtual_time) return 0;
        const timespec until{.tv_sec = now_ / 1'000'000'000, .tv_nsec = now_ % 1'000'000'000};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
        return static_cast<double>(monotonic() - now_) * 1e-9;
    }
    void read() {
        drivers::JointSample sample = moment_.sample;
        moment_.status = device_.read(clock(), sample);
        if (moment_.status == ReadStatus::unplugged)
            throw std::runtime_error("it was unplugged; plug it in and start again");
        if (moment_.status != ReadStatus::ok) return;
        moment_.sample = sample;
        drivers::TipPose pose = pose_;
        const auto joints = static_cast<std::size_t>(device_.link().sensed_joints);
        if (!device_.mechanism().forward(std::span<const double>(sample.position.data(), joints), pose,
                                         jacobian_))
            return;
        if (known_) filter_.add((pose.position - pose_.position) * options_.rate, 1 / options_.rate);
        moment_.velocity = filter_.value();
        pose_ = pose;
        moment_.position = pose.position;
        known_ = true;
    }
    void write(const Vector3d& force) {
        drivers::JointEfforts efforts{};
        const drivers::LinkConfig& link = device_.link();
        const bool safe = known_ && force.allFinite() && moment_.velocity.norm() < fastest;
        if (safe) {
            const Eigen::Matrix<double, 8, 1> wanted = jacobian_.topRows<3>().transpose() * force;
            double scale = 1;  // all joints together, so that the direction stays
            for (int j = 0; j < link.actuated_joints; ++j) {
                const double limit = link.effort_limit[static_cast<std::size_t>(j)];
                if (std::abs(wanted[j]) > limit) scale = std::min(scale, limit / std::abs(wanted[j]));
            }
            for (int j = 0; j < link.actuated_joints; ++j)
                efforts[static_cast<std::size_t>(j)] = scale * wanted[j];
        }
        if (!device_.write(clock(), efforts))
            throw std::runtime_error("it takes no efforts any more: unplugged?");
        if (known_ && !safe) {
            throw std::runtime_error(
                fmt::format("the tip went {:.2g} m/s, faster than the {:g} m/s of this test; let it hang "
                            "freely and start again",
                            moment_.velocity.norm(), fastest));
        }
    }

    drivers::Device& device_;
    const TrialOptions& options_;
    Nanoseconds period_, now_;
    Moment moment_;
    drivers::TipPose pose_;
    drivers::Jacobian jacobian_ = drivers::Jacobian::Zero();
    servo::FirstOrderVelocity filter_{100};
    bool known_ = false;
};

HomingTrial home(Bench& bench, const TrialOptions& options) {
    HomingTrial homing;
    bench.run(options.homing_time, [&](const Moment& m, Vector3d&) {
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
    bench.run(seconds, [&](const Moment& m, Vector3d&) {
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

/// Half of what the way there and the way back differ by, sample by sample: gravity and drift are in both.
std::vector<Vector3d> both_ways(Bench& bench, const Vector3d& push, const Vector3d& home) {
    constexpr double seconds = 0.03;
    std::array<std::vector<Vector3d>, 2> path;
    for (const int way : {0, 1}) {
        bench.settle(0.4, home);
        const Vector3d begin = bench.moment().position;
        bench.run(seconds, [&](const Moment& m, Vector3d& force) {
            force = way == 0 ? push : Vector3d(-push);
            path[static_cast<std::size_t>(way)].push_back(m.position - begin);
            return true;
        });
    }
    std::vector<Vector3d> half;
    for (std::size_t i = 0; i < std::min(path[0].size(), path[1].size()); ++i)
        half.push_back((path[0][i] - path[1][i]) / 2);
    return half;
}

/// From m x'' = F - b x': x + (b/m) (its integral) = a/2 (t - tau)^2. The root of twice that is a line in t:
/// its slope is sqrt(a), its zero tau. Least squares over what is well above a count. `slowing`: b/m.
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

PushTrial push(Bench& bench, const Vector3d& axis, const Vector3d& home, const drivers::LinkConfig& link,
               const TrialOptions& options, double count) {
    PushTrial trial;
    trial.axis = axis;
    const double small = options.push / 2, large = options.push;
    const std::vector<Vector3d> weak = both_ways(bench, small * axis, home),
                                strong = both_ways(bench, large * axis, home);
    const Vector3d way = strong.back();
    trial.cosine = way.norm() > 4 * count ? way.normalized().dot(axis) : 0;
    double slowing = 0;
    for (int i = 0; i < 4; ++i) {  // the mass that b is divided by is what is sought
        const Start a1 = fit(weak, axis, 1 / options.rate, count, slowing),
                    a2 = fit(strong, axis, 1 / options.rate, count, slowing);
        if (!(a2.acceleration > a1.acceleration && a1.acceleration > 0)) return trial;
        trial.delay = std::max(0.0, a2.delay);
        trial.mass = (large - small) / (a2.acceleration - a1.acceleration);
        trial.friction = std::max(0.0, small - trial.mass * a1.acceleration);
        slowing = link.damping / trial.mass;
    }
    if (link.apparent_mass > 0) trial.size = link.apparent_mass / trial.mass;
    return trial;
}

/// Pressed against a wall of this stiffness and knocked: does the ringing die away? It is brought to rest by
/// damping first, so that what rings is the knock alone.
bool rings_down(Bench& bench, const Vector3d& home, double stiffness, const TrialOptions& options,
                double count) {
    constexpr double calming = 0.5, knock = 0.01, listening = 0.6;  // s
    const Vector3d normal = Vector3d::UnitZ();
    bench.settle(0.4, home);
    const double wall = bench.moment().position.z() - 1e-3;
    struct Span {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        void add(double x) { low = std::min(low, x), high = std::max(high, x); }
        double size() const { return high - low; }
    } early, late;
    bool calm = true;
    bench.run(calming + knock + listening, [&](const Moment& m, Vector3d& force) {
        const double depth = wall - m.position.z(), since = m.t - calming - knock;
        double push = -options.push / 2;
        if (since < -knock) {
            force = -hold_damping * m.velocity;
        } else if (since < 0) {
            push -= options.push / 2;
        } else if (since < listening / 3) {
            early.add(depth);
        } else if (since > 2 * listening / 3) {
            late.add(depth);
        }
        force += (std::max(0.0, stiffness * depth) + push) * normal;
        calm = m.velocity.norm() < fastest / 2;
        return calm;
    });
    return calm && late.size() <= std::max(early.size(), 2 * count);
}

WallTrial wall(Bench& bench, const Vector3d& home, const drivers::LinkConfig& link,
               const TrialOptions& options, double count) {
    WallTrial trial;
    trial.predicted = servo::max_stiffness(link, options.rate);
    constexpr double most = 1e4, deepest = 10e-3;  // N/m; m, that the pressing may sink into the softest
    double stable = std::clamp(trial.predicted / 4, options.push / 2 / deepest, most), unstable = stable;
    if (!rings_down(bench, home, stable, options, count)) return trial;
    while (unstable < most) {
        unstable = std::min(most, unstable * 1.5);
        if (!rings_down(bench, home, unstable, options, count)) break;
        stable = unstable;
        trial.bounded = stable >= most;
        if (trial.bounded) break;
    }
    while (!trial.bounded && unstable > 1.03 * stable) {
        const double middle = std::sqrt(stable * unstable);
        (rings_down(bench, home, middle, options, count) ? stable : unstable) = middle;
    }
    trial.stiffness = stable;
    return trial;
}

}  // namespace

Trial try_device(drivers::Device& device, const TrialOptions& options,
                 const std::function<void(const std::string&)>& say) {
    Trial trial;
    trial.link = device.link();
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

    const Vector3d home_at = bench.moment().position;
    double count = 0;  // m at the tip: what one count of its coarsest joint is, seen as noise at least
    drivers::TipPose pose;
    drivers::Jacobian jacobian;
    const auto joints = static_cast<std::size_t>(trial.link.sensed_joints);
    if (device.mechanism().forward(std::span<const double>(bench.moment().sample.position.data(), joints),
                                   pose, jacobian)) {
        for (std::size_t j = 0; j < joints && j < trial.link.radians_per_count.size(); ++j)
            count = std::max(count, jacobian.topRows<3>().col(static_cast<int>(j)).norm() *
                                        trial.link.radians_per_count[j]);
    }
    count = std::max({count, trial.rest.tip_apart, 1e-6});
    if (trial.link.actuated_joints == 0) return trial;  // it takes no force

    device.notify(drivers::Notice::enabled);
    say(fmt::format("pushes of {:g} and {:g} N along x, y and z: keep your hands off", options.push / 2,
                    options.push));
    for (const Vector3d& axis :
         {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitY()), Vector3d(Vector3d::UnitZ())})
        trial.pushes.push_back(push(bench, axis, home_at, trial.link, options, count));
    say(fmt::format("a wall below: it presses itself on with {:g} N, ever stiffer until it hums",
                    options.push / 2));
    trial.wall = wall(bench, home_at, trial.link, options, count);
    bench.settle(0.5, home_at);
    return trial;
}

}  // namespace knurl::cli
