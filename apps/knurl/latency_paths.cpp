#include "latency_paths.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <poll.h>

namespace knurl::cli {

using namespace std::chrono_literals;

namespace {

constexpr std::size_t cold_reports = 2, cold_commands = 2;
constexpr std::size_t remembered_cycles = 16;
constexpr std::uint64_t distinct_forces = 4096;
constexpr double force_step = 1.0 / (1 << 20);  // N; a power of two, so that every sum of steps is exact
// While the claim's gain still ramps up, forces differ from their identifying values. The largest shows the
// ramp best.
constexpr double largest_force = distinct_forces * force_step;
constexpr Nanoseconds felt_within = 5'000'000'000;
constexpr Nanoseconds last_use_within = 50'000'000;  // after a block: for updates still under way

double force_of(std::uint64_t update) {
    return static_cast<double>(update % distinct_forces + 1) * force_step;
}

bool same_force(double a, double b) {
    return std::abs(a - b) < force_step / 4;
}

}  // namespace

LatencyPaths::LatencyPaths(Claim& hand, std::uint64_t seed)
    : hand_(hand), generator_(seed), period_(std::llround(1e9 / hand.device().rate)) {
    force_ = hand_.add(ConstantForce{.force = {largest_force, 0, 0}, .recovery = 0});
    hand_.arm();
    wait_until_felt();
}

void LatencyPaths::wait_until_felt() {
    const Nanoseconds end = now_ns() + felt_within;
    DeviceState state = DeviceState::disconnected;
    while (now_ns() < end) {
        hand_.commit();
        const auto report = hand_.next_report(20ms);
        if (!report) continue;
        newest_ = report;
        state = report->state;
        if (same_force(report->scene_force.x, largest_force)) return;
    }
    throw std::runtime_error(
        fmt::format("no force arrived within {} s (device state {}); is somebody else holding the "
                    "device, or is it in fault? See knurl ls",
                    felt_within / 1'000'000'000, static_cast<std::uint32_t>(state)));
}

void LatencyPaths::commit_update(Nanoseconds intended) {
    const double force = force_of(++updates_);
    force_->set({.force = {force, 0, 0}, .recovery = 0});
    const Nanoseconds begun = now_ns();
    hand_.commit();
    pending_.push_back({.force = force,
                        .intended = intended,
                        .begun = begun,
                        .committed = now_ns(),
                        .basis_read = newest_ ? newest_->read_ns : 0});
}

void LatencyPaths::forget() {
    PathSamples fresh;
    fresh.merged = samples_.merged;
    fresh.lost = samples_.lost;
    samples_ = std::move(fresh);
}

void LatencyPaths::see(const HandReport& report) {
    const Nanoseconds last_deadline =
        newest_ && newest_->cycle + 1 == report.cycle ? newest_->deadline_ns : report.deadline_ns;
    newest_ = report;
    clock_offset_ = hand_.network().clock_offset.count();  // changes while it is estimated
    reads_.push_back(report.read_ns);
    if (reads_.size() > remembered_cycles) reads_.pop_front();
    if (cold_ > 0) return;
    samples_.servo_lateness.push_back(static_cast<double>(report.read_ns - report.deadline_ns));
    // After a standstill a servo starts a new grid of deadlines: the skipped cycles were late, too.
    constexpr Nanoseconds at_most = 1'000'000'000;
    for (Nanoseconds due = std::max(last_deadline, report.deadline_ns - at_most) + period_;
         due <= report.deadline_ns - period_; due += period_)
        samples_.servo_lateness.push_back(static_cast<double>(report.read_ns - due));
}

void LatencyPaths::note(const HandReport& report, Nanoseconds had, std::vector<double>& from_read,
                        std::vector<double>& from_deadline) {
    see(report);
    if (cold_ > 0) {
        --cold_;
        return;
    }
    from_read.push_back(static_cast<double>(had - ours(report.read_ns)));
    from_deadline.push_back(static_cast<double>(had - ours(report.deadline_ns)));
}

void LatencyPaths::used(const Update& update, const HandReport& report) {
    samples_.commit_to_write.push_back(static_cast<double>(ours(report.write_ns) - update.intended));
    // An update may arrive between the read and the taking: then it did not wait.
    samples_.wait_for_use.push_back(
        std::max(0.0, static_cast<double>(ours(report.read_ns) - update.committed)));
    if (update.basis_read > 0) {
        samples_.report_age.push_back(static_cast<double>(report.write_ns - update.basis_read));
    }
    // reads_ ends with the cycle that used it.
    const auto overlooked = std::count_if(reads_.begin(), reads_.end() - 1,
                                          [&](Nanoseconds read) { return ours(read) > update.committed; });
    samples_.overlooked.push_back(static_cast<double>(overlooked));
}

void LatencyPaths::used_by_sleeper(const Update& update, const HandReport& report) {
    const Nanoseconds written = ours(report.write_ns);
    samples_.to_use.push_back(std::max(0.0, static_cast<double>(ours(report.read_ns) - update.begun)));
    samples_.to_write.push_back(static_cast<double>(written - update.begun));
    samples_.commits.push_back({.begin = update.begun, .end = written});
}

void LatencyPaths::catch_up() {
    while (const auto report = hand_.next_report(0ns)) newest_ = report;
    if (!hand_.connected())
        throw std::runtime_error("the servo ended during the measurement; see its messages");
    cold_ = cold_reports;
}

void LatencyPaths::updates_block(Nanoseconds length, bool spinning) {
    catch_up();
    const Nanoseconds end = now_ns() + length;
    const auto step = [this] {
        return period_ + static_cast<Nanoseconds>(static_cast<double>(period_) * random());
    };
    Nanoseconds due = now_ns() + step();
    for (Nanoseconds now = now_ns(); now < end || due < end || !pending_.empty(); now = now_ns()) {
        if (now > end + last_use_within) break;
        if (now >= due && due < end) {
            commit_update(due);
            due += step();  // the intended times stay as drawn, however late this loop is
        }
        const Nanoseconds next = due < end ? due : now + period_;
        const auto report =
            hand_.next_report(std::chrono::nanoseconds(spinning ? 0 : std::max<Nanoseconds>(0, next - now)));
        if (!report) continue;
        if (spinning)
            note(*report, now_ns(), samples_.spinning, samples_.spinning_deadline);
        else
            see(*report);
        const auto felt = std::find_if(pending_.begin(), pending_.end(), [&](const Update& update) {
            return same_force(update.force, report->scene_force.x);
        });
        if (felt == pending_.end()) continue;
        if (spinning)
            used(*felt, *report);
        else
            used_by_sleeper(*felt, *report);
        samples_.merged += static_cast<std::uint64_t>(felt - pending_.begin());
        pending_.erase(pending_.begin(), felt + 1);
    }
    samples_.lost += pending_.size();
    pending_.clear();
}

void LatencyPaths::blocking_block(Nanoseconds length) {
    catch_up();
    const Nanoseconds end = now_ns() + length;
    while (now_ns() < end) {
        const auto report = hand_.next_report(10ms);
        if (!report) continue;
        const Nanoseconds had = now_ns();
        const bool cold = cold_ > 0;
        note(*report, had, samples_.blocking, samples_.blocking_deadline);
        if (!cold) samples_.after_write.push_back(static_cast<double>(had - ours(report->write_ns)));
    }
    hand_.commit();  // still alive
}

void LatencyPaths::descriptor_block(Nanoseconds length) {
    catch_up();
    const Nanoseconds end = now_ns() + length;
    pollfd wait{.fd = hand_.fd(), .events = POLLIN, .revents = 0};
    while (now_ns() < end) {
        if (::poll(&wait, 1, 10) <= 0) continue;
        const auto report = hand_.next_report(0ns);
        if (report) note(*report, now_ns(), samples_.descriptor, samples_.descriptor_deadline);
    }
    hand_.commit();
}

void LatencyPaths::command(bool counts) {
    const Nanoseconds begin = now_ns();
    hand_.arm();
    const Nanoseconds took = now_ns() - begin;
    if (!counts) return;
    // The earliest arrival; from then on the update waits for the servo.
    const Nanoseconds there = begin + round_trip() / 2;
    const Nanoseconds since = (there - deadline()) % period_;
    const Nanoseconds wait = since > 0 ? period_ - since : -since;
    samples_.command.push_back(static_cast<double>(took));
    samples_.command_less_wait.push_back(static_cast<double>(took - wait));
}

void LatencyPaths::commands_block(Nanoseconds length, const std::function<void(bool counts)>& beside) {
    catch_up();
    const auto sleep_at_random = [this] {
        sleep_until(now_ns() + static_cast<Nanoseconds>(static_cast<double>(period_) * random()));
    };
    // With a round trip of milliseconds cold caches do not matter, and a block may have time for only one
    // pair.
    const std::size_t cold = round_trip() > 1'000'000 ? 0 : cold_commands;
    const Nanoseconds end = now_ns() + length;
    for (std::size_t pairs = 0; now_ns() < end; ++pairs) {
        sleep_at_random();
        command(pairs >= cold);
        hand_.commit();  // still alive, however long it took
        sleep_at_random();
        beside(pairs >= cold);
        hand_.commit();
    }
}

}  // namespace knurl::cli
