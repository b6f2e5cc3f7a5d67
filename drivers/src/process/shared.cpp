#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstring>
#include <ctime>
#include <span>
#include <stdexcept>

#include <linux/futex.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <knurl/drivers/driver_process.hpp>

namespace knurl::drivers::process {

namespace {

template <std::size_t n>
void put(std::array<char, n>& to, std::string_view text) {
    to.fill(0);
    std::copy_n(text.begin(), std::min(text.size(), n - 1), to.begin());
}

/// Also where the other side left no end.
template <std::size_t n>
std::string text_of(const std::array<char, n>& from) {
    return {from.begin(), std::find(from.begin(), from.end(), '\0')};
}

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value,
           const timespec* until) noexcept {
    return syscall(SYS_futex, &word, operation, value, until, nullptr, FUTEX_BITSET_MATCH_ANY);
}

}  // namespace

Nanoseconds monotonic() noexcept {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

void ring(Shared& shared) noexcept {
    // Either the other side sees the new bell before it waits, or it is seen here to wait: both in one order.
    shared.bell.fetch_add(1, std::memory_order_seq_cst);
    if (shared.waits.load(std::memory_order_seq_cst) != 0) futex(shared.bell, FUTEX_WAKE, INT_MAX, nullptr);
}

Description description_of(const LinkConfig& link, const ToolShape& shape, bool has_buttons) {
    Description d{};
    put(d.name, link.name);
    put(d.serial, link.serial);
    put(d.text, link.description);
    std::copy_n(link.radians_per_count.begin(),
                std::min<std::size_t>(link.radians_per_count.size(), max_joints),
                d.radians_per_count.begin());
    std::copy_n(link.effort_limit.begin(), std::min<std::size_t>(link.effort_limit.size(), max_joints),
                d.effort_limit.begin());
    d.joint_least = link.joint_least;
    d.joint_greatest = link.joint_greatest;
    d.workspace_centre = link.workspace_centre;
    d.workspace_radius = link.workspace_radius;
    d.nominal_rate = link.nominal_rate;
    d.peak_force = link.peak_force;
    d.continuous_force = link.continuous_force;
    d.peak_torque = link.peak_torque;
    d.damping = link.damping;
    d.rotational_damping = link.rotational_damping;
    d.lag = link.lag;
    d.measured_max_stiffness = link.measured_max_stiffness;
    d.grip_damping = link.grip_damping;
    d.apparent_mass = link.apparent_mass;
    d.watchdog_time = link.watchdog_time;
    d.sensed_joints = link.sensed_joints;
    d.actuated_joints = link.actuated_joints;
    d.senses_orientation = link.senses_orientation ? 1 : 0;
    d.renders_torque = link.renders_torque ? 1 : 0;
    d.has_watchdog = link.has_watchdog ? 1 : 0;
    d.has_brake = link.has_brake ? 1 : 0;
    d.has_buttons = has_buttons ? 1 : 0;
    d.shape = shape;
    return d;
}

LinkConfig link_of(const Description& d) {
    const auto numbers = {d.workspace_radius,   d.nominal_rate,  d.peak_force,
                          d.continuous_force,   d.peak_torque,   d.damping,
                          d.rotational_damping, d.lag,           d.grip_damping,
                          d.apparent_mass,      d.watchdog_time, d.measured_max_stiffness};
    const int joints = 3 + (d.shape.wrist != 0 ? 3 : 0) + (d.shape.gripper >= 0 ? 1 : 0);
    const bool sense = std::ranges::all_of(numbers, [](double n) { return std::isfinite(n) && n >= 0; }) &&
                       d.sensed_joints == joints && d.actuated_joints >= 0 && d.actuated_joints <= joints &&
                       d.shape.gripper < joints && (d.shape.gripper == -1 || d.shape.gripper >= 3) &&
                       d.workspace_radius > 0 && d.nominal_rate > 0;
    if (!sense)
        throw std::runtime_error("knurl-device describes a device that cannot be; it is of another build");
    LinkConfig link;
    link.name = text_of(d.name);
    link.serial = text_of(d.serial);
    link.description = text_of(d.text);
    link.radians_per_count.assign(d.radians_per_count.begin(), d.radians_per_count.begin() + d.sensed_joints);
    link.effort_limit.assign(d.effort_limit.begin(), d.effort_limit.begin() + d.actuated_joints);
    link.joint_least = d.joint_least;
    link.joint_greatest = d.joint_greatest;
    link.workspace_centre = d.workspace_centre;
    link.workspace_radius = d.workspace_radius;
    link.nominal_rate = d.nominal_rate;
    link.peak_force = d.peak_force;
    link.continuous_force = d.continuous_force;
    link.peak_torque = d.peak_torque;
    link.damping = d.damping;
    link.rotational_damping = d.rotational_damping;
    link.lag = d.lag;
    link.measured_max_stiffness = d.measured_max_stiffness;
    link.grip_damping = d.grip_damping;
    link.apparent_mass = d.apparent_mass;
    link.watchdog_time = d.watchdog_time;
    link.sensed_joints = d.sensed_joints;
    link.actuated_joints = d.actuated_joints;
    link.senses_orientation = d.senses_orientation != 0;
    link.renders_torque = d.renders_torque != 0;
    link.has_watchdog = d.has_watchdog != 0;
    link.has_brake = d.has_brake != 0;
    return link;
}

Exchange::Exchange(int mapping, unsigned lane) {
    struct stat info = {};
    const bool is =
        fstat(mapping, &info) == 0 && info.st_size == static_cast<off_t>(sizeof(Shared)) && lane < lanes;
    void* memory =
        is ? mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, mapping, 0) : MAP_FAILED;
    if (memory == MAP_FAILED || static_cast<Shared*>(memory)->size != sizeof(Shared))
        throw std::runtime_error(
            "descriptor " + std::to_string(mapping) +
            " is no mapping of a servo of this build; knurld starts this program, do not start it");
    shared_ = static_cast<Shared*>(memory);
    lane_ = &shared_->lane[lane];
    heard_ = shared_->bell.load(std::memory_order_seq_cst);
}

Exchange::~Exchange() {
    munmap(shared_, sizeof(Shared));
}

void Exchange::ready(const Description& description) noexcept {
    lane_->description = description;
}

void Exchange::failed(std::string_view why) noexcept {
    put(lane_->message, why);
    lane_->state.store(static_cast<std::uint32_t>(LaneState::failed), std::memory_order_release);
}

bool Exchange::leaving() const noexcept {
    return leave_.load(std::memory_order_acquire) || shared_->leave.load(std::memory_order_acquire) != 0;
}

void Exchange::leave() noexcept {
    leave_.store(true, std::memory_order_release);
    ring(*shared_);
}

bool Exchange::awake() const noexcept {
    return shared_->awake.load(std::memory_order_acquire) != 0;
}

JointEfforts Exchange::efforts(Nanoseconds now) noexcept {
    // The bell first: what rings after this is looked at again before any wait.
    heard_ = shared_->bell.load(std::memory_order_seq_cst);
    if (Order next; lane_->orders.take(next)) {
        note(next);
        ordered_ = true;
        const Nanoseconds under_way = std::clamp<Nanoseconds>(now - order_.written, 0, UINT32_MAX);
        const std::uint64_t number = lane_->hops.load(std::memory_order_relaxed);
        lane_->hop[number % kept_hops].store(static_cast<std::uint32_t>(under_way),
                                             std::memory_order_relaxed);
        lane_->hops.store(number + 1, std::memory_order_release);
    }
    if (!ordered_ || now - order_.written > silence || leaving()) return {};
    return order_.acts == shared_->acts.load(std::memory_order_acquire) ? order_.efforts : JointEfforts{};
}

/// When the next one is due, and which CPU is to be kept off: there this process would stand in the way of the servo.
void Exchange::note(const Order& next) noexcept {
    const Nanoseconds apart = next.written - order_.written;
    period_ = ordered_ && apart > 2 * spin && apart < longest_period ? apart : 0;
    order_ = next;
    constexpr int most_moves = 16;  // a servo is on one CPU; a test is not
    if (next.cpu < 0 || next.cpu == cpu_ || ++moved_ > most_moves) return;
    cpu_ = next.cpu;
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) return;
    CPU_CLR(static_cast<std::size_t>(cpu_), &set);
    if (CPU_COUNT(&set) > 0) sched_setaffinity(0, sizeof set, &set);
}

/// True: the bell has rung.
bool Exchange::spin_until(Nanoseconds end) const noexcept {
    if (sched_getcpu() == cpu_) return false;
    do {
        if (shared_->bell.load(std::memory_order_seq_cst) != heard_) return true;
    } while (monotonic() < end);
    return false;
}

void Exchange::publish(const JointSample& joints, Nanoseconds taken) noexcept {
    lane_->samples.publish({joints, taken});
    if (!told_) {
        told_ = true;
        lane_->state.store(static_cast<std::uint32_t>(LaneState::ready), std::memory_order_release);
    }
    beat();
}

void Exchange::garbage() noexcept {
    lane_->garbage.fetch_add(1, std::memory_order_relaxed);
    beat();
}

void Exchange::beat() noexcept {
    lane_->beat.fetch_add(1, std::memory_order_relaxed);
}

void Exchange::wait(Nanoseconds until) noexcept {
    // Orders come regularly. Around the time of the next one it is waited for without sleep.
    const Nanoseconds due = order_.written + period_, now = monotonic();
    const bool soon = period_ > 0 && now < due + spin && until > due - spin;
    if (soon && now >= due - spin) {
        spin_until(std::min(until, due + spin));
        return beat();
    }
    if (soon) until = due - spin;
    shared_->waits.store(1, std::memory_order_seq_cst);
    if (shared_->bell.load(std::memory_order_seq_cst) == heard_) {
        const timespec time{.tv_sec = until / 1'000'000'000, .tv_nsec = until % 1'000'000'000};
        futex(shared_->bell, FUTEX_WAIT_BITSET, heard_, &time);  // CLOCK_MONOTONIC, absolute
    }
    shared_->waits.store(0, std::memory_order_seq_cst);
    beat();
}

}  // namespace knurl::drivers::process
