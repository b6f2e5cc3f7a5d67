#include "device_bench.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

namespace knurl::cli {

namespace {

using drivers::Nanoseconds;
using drivers::ReadStatus;
using Eigen::Vector3d;

constexpr double fastest = 1;            // m/s: a tested device must not hit anything
constexpr double fastest_turn = 30;      // rad/s
constexpr double hold_stiffness = 50;    // N/m, towards the starting place, between trials
constexpr double hold_damping = 2;       // N s/m
constexpr double hold_twist = 0.05;      // N m/rad
constexpr double twist_damping = 0.005;  // N m s/rad
constexpr double longest_settling = 3;   // s
constexpr double still = 1e-3, still_turn = 0.02, still_for = 0.05;  // m/s, rad/s, s
constexpr int cold_orders = 3;                      // orders of the previous trial may still be under way
constexpr Nanoseconds longest_answer = 20'000'000;  // a later answer does not count
constexpr Nanoseconds look = 10'000;                // between looks on a virtual clock

Nanoseconds monotonic() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

void shorten(Vector3d& v, double most) {
    if (v.norm() > most) v *= most / v.norm();
}

}  // namespace

Vector3d turn_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    const Eigen::AngleAxisd turn(b * a.conjugate());
    return turn.angle() > M_PI ? Vector3d((turn.angle() - 2 * M_PI) * turn.axis())
                               : Vector3d(turn.angle() * turn.axis());
}

Bench::Bench(drivers::Device& device, const TrialOptions& options)
    : device_(device),
      options_(options),
      period_(std::llround(1e9 / options.rate)),
      now_(options.virtual_time ? 0 : monotonic()) {}

Bench::~Bench() {
    device_.write(now_, {});
    device_.notify(drivers::Notice::disabled);
}

Nanoseconds Bench::clock() const {
    return options_.virtual_time ? now_ : monotonic();
}

double Bench::wait() {
    if (options_.virtual_time) return 0;
    const timespec until{.tv_sec = now_ / 1'000'000'000, .tv_nsec = now_ % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
    return static_cast<double>(monotonic() - now_) * 1e-9;
}

Nanoseconds Bench::next(Nanoseconds begin) {
    if (options_.stop != nullptr && *options_.stop)
        throw std::runtime_error("interrupted; its motors are at zero");
    now_ += period_;
    moment_.lateness = wait();
    moment_.t = static_cast<double>(now_ - begin) * 1e-9;
    const Nanoseconds before = clock();
    read();
    return before;
}

void Bench::read() {
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
    if (known_) {
        filter_.add((pose.position - pose_.position) * options_.rate, 1 / options_.rate);
        turning_.add(turn_between(pose_.orientation, pose.orientation) * options_.rate, 1 / options_.rate);
    }
    moment_.velocity = filter_.value();
    moment_.angular_velocity = turning_.value();
    pose_ = pose;
    moment_.position = pose.position;
    moment_.orientation = pose.orientation;
    known_ = true;
}

void Bench::write(const Wrench& wanted, Nanoseconds began) {
    drivers::JointEfforts efforts{};
    const drivers::LinkConfig& link = device_.link();
    const bool slow = moment_.velocity.norm() < fastest &&
                      (!link.renders_torque || moment_.angular_velocity.norm() < fastest_turn);
    const bool safe = known_ && wanted.force.allFinite() && wanted.torque.allFinite() && slow;
    if (safe) {
        Eigen::Matrix<double, 8, 1> joints = jacobian_.topRows<3>().transpose() * wanted.force;
        if (link.renders_torque) joints += jacobian_.bottomRows<3>().transpose() * wanted.torque;
        double scale = 1;  // common to all joints, so that the direction is kept
        for (int j = 0; j < link.actuated_joints; ++j) {
            const double limit = link.effort_limit[static_cast<std::size_t>(j)];
            if (std::abs(joints[j]) > limit) scale = std::min(scale, limit / std::abs(joints[j]));
        }
        for (int j = 0; j < link.actuated_joints; ++j)
            efforts[static_cast<std::size_t>(j)] = scale * joints[j];
    }
    if (!device_.write(clock(), efforts))
        throw std::runtime_error("it takes no efforts any more: unplugged?");
    if (known_ && !safe) {
        throw std::runtime_error(fmt::format(
            "the tip went {:.2g} m/s and {:.2g} rad/s, faster than the {:g} m/s and {:g} rad/s of this test; "
            "let it hang freely and start again",
            moment_.velocity.norm(), moment_.angular_velocity.norm(), fastest, fastest_turn));
    }
    moment_.transfer = options_.virtual_time ? 0 : static_cast<double>(monotonic() - began) * 1e-9;
}

std::vector<double> Bench::round_trips(int count) {
    std::vector<double> took;
    for (int i = 0; i < count + cold_orders; ++i) {
        const Nanoseconds before = next(now_);
        write({}, before);
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

void Bench::settle(double seconds, const Moment& home) {
    double still_since = 0;
    run(longest_settling, [&](const Moment& m, Wrench& wanted) {
        wanted.force = hold_stiffness * (home.position - m.position) - hold_damping * m.velocity;
        shorten(wanted.force, options_.push);
        wanted.torque =
            hold_twist * turn_between(m.orientation, home.orientation) - twist_damping * m.angular_velocity;
        shorten(wanted.torque, options_.push * twist_lever);
        if (m.velocity.norm() > still || (link().renders_torque && m.angular_velocity.norm() > still_turn))
            still_since = m.t;
        return m.t < seconds || m.t - still_since < still_for;
    });
}

std::pair<double, double> Bench::resolution() const {
    double moved = 0, turned = 0;
    const drivers::LinkConfig& link = device_.link();
    const auto joints =
        std::min<std::size_t>(static_cast<std::size_t>(link.sensed_joints), link.radians_per_count.size());
    for (std::size_t j = 0; known_ && j < joints; ++j) {
        const auto column = jacobian_.col(static_cast<Eigen::Index>(j));
        moved = std::max(moved, column.head<3>().norm() * link.radians_per_count[j]);
        turned = std::max(turned, column.tail<3>().norm() * link.radians_per_count[j]);
    }
    return {moved, turned};
}

}  // namespace knurl::cli
