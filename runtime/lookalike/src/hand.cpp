#include "hand.hpp"

#include <cmath>

#include <errno.h>  // program_invocation_short_name

#include <knurl/client/error.hpp>

#include "say.hpp"

namespace knurl::lookalike {

namespace {

using namespace std::chrono_literals;

constexpr std::chrono::seconds retry{1};            // between two tries to arm
constexpr std::chrono::milliseconds arm_shows{50};  // until a report shows that the device was armed

double norm(const Vec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

ConnectOptions options() {
    return {.name = std::string(program_invocation_short_name) + " (as " + which + ")",
            .wait = 0ms,
            .hints = false};
}

}  // namespace

Hand::Hand(const Place& place)
    : client_(Client::connect(place.servo, options())),
      claim_(client_.claim(place.device, {.shared = true, .representations = 4})),
      device_(claim_.device()),
      reader_(client_.observe(place.device)),
      pacer_(client_.observe(place.device)) {
    if (!reader_.newest(2s))
        throw Error(Error::Kind::disconnected,
                    "device '" + place.device + "': no report within 2 s; see `knurl top`");
    keeper_ = std::thread([this] { keep(); });
}

Hand::~Hand() {
    {
        const Lock lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    keeper_.join();
}

std::optional<HandReport> Hand::newest() {
    std::optional<HandReport> report;
    {
        const std::lock_guard lock(reading_);
        report = reader_.latest();
    }
    if (!report) return report;
    const Vec3& centre = device_.workspace_centre;
    for (Vec3* place : {&report->position, &report->contact_point})
        *place = {place->x - centre.x, place->y - centre.y, place->z - centre.z};
    return report;
}

void Hand::pace() {
    const std::unique_lock lock(pacing_, std::try_to_lock);
    if (!lock) return;
    const auto period = std::chrono::nanoseconds(std::llround(1e9 / device_.rate));
    constexpr int most_cycles = 3;  // a servo that has stopped must not stop the program
    std::optional<HandReport> report = pacer_.latest();
    if (!report)
        std::this_thread::sleep_for(period);  // without a servo a loop keeps about its pace
    else if (report->cycle <= paced_)
        report = pacer_.newest(most_cycles * period);
    if (report) paced_ = report->cycle;
}

Pushed Hand::push(const Vec3& force, const Vec3& torque) {
    const Lock lock(mutex_);
    if (!claim_.connected())
        throw Error(Error::Kind::disconnected, "the servo of device '" + device_.name + "' is gone");
    const Clock::time_point now = Clock::now();
    const double since = std::chrono::duration<double>(now - pushed_).count();
    pushed_ = now;
    interval_ += 0.1 * (std::min(since, 1.0) - interval_);
    // A loop that keeps pace with the servo is felt as it is: a fade would be a delay more. A slower one would be felt
    // as steps, which the servo smooths as for every application.
    constexpr double keeps_pace = 1.7;  // periods
    set({.force = force, .torque = torque, .recovery = since * device_.rate < keeps_pace ? 0 : automatic},
        lock);
    const bool nothing = force == Vec3{} && torque == Vec3{};
    if (!nothing && !held_) changed_.notify_all();
    held_ = !nothing;
    look(lock);
    if (allowed_ && !armed_ && !arm(lock)) return Pushed::not_armed;
    return norm(force) > device_.peak_force ? Pushed::saturated : Pushed::taken;
}

void Hand::let_go() {
    const Lock lock(mutex_);
    held_ = false;
    if (force_ && claim_.connected()) set({.force = {}, .torque = {}, .recovery = fade}, lock);
}

void Hand::allow_force(bool allowed) {
    const Lock lock(mutex_);
    allowed_ = allowed;
    if (allowed || !armed_) return;
    held_ = false;
    armed_ = false;
    if (force_) set({.force = {}, .torque = {}, .recovery = fade}, lock);
    claim_.disarm();
}

bool Hand::force_allowed() const {
    const Lock lock(mutex_);
    return allowed_;
}

bool Hand::arm() {
    const Lock lock(mutex_);
    look(lock);
    return armed_ || arm(lock);
}

bool Hand::armed() const {
    const Lock lock(mutex_);
    return armed_;
}

void Hand::set_lapse(std::chrono::nanoseconds lapse) {
    const Lock lock(mutex_);
    lapse_ = lapse <= 0ns ? longest_lapse : std::min<std::chrono::nanoseconds>(lapse, longest_lapse);
    changed_.notify_all();
}

double Hand::rate() const {
    const Lock lock(mutex_);
    const bool stopped = Clock::now() - pushed_ > 1s;
    return stopped || interval_ <= 0 ? 0 : 1 / interval_;
}

void Hand::set(const ConstantForce& params, const Lock&) {
    try {
        if (force_) force_->set(params);
    } catch (const Error& error) {
        if (error.kind != Error::Kind::stale_handle) throw;
        // An overloaded servo has refused or shed it: once more, and armed anew.
        force_.reset();
        armed_ = false;
    }
    if (!force_) force_.emplace(claim_.add(params, {.feedback = 0}));
    claim_.commit();
}

/// Whether the servo has taken the arming away meanwhile: a fault, a restart.
void Hand::look(const Lock&) {
    const std::uint64_t servos = claim_.reattachments();
    if (servos != servos_) armed_ = false;
    servos_ = servos;
    if (!armed_ || Clock::now() - armed_at_ < arm_shows) return;
    const auto report = claim_.latest();
    if (report && (report->state == DeviceState::fault || report->state == DeviceState::idle ||
                   report->state == DeviceState::disconnected))
        armed_ = false;
}

bool Hand::arm(const Lock&) {
    const Clock::time_point now = Clock::now();
    if (now < try_arm_) return false;
    try {
        claim_.arm();
        armed_ = true;
        armed_at_ = Clock::now();
    } catch (const Error& error) {
        try_arm_ = now + retry;
        say_once(error.what());
    }
    return armed_;
}

/// The thread that ends forces which nobody sets any more.
void Hand::keep() {
    Lock lock(mutex_);
    while (!ending_) {
        if (!held_) {
            changed_.wait(lock, [this] { return held_ || ending_; });
            continue;
        }
        const Clock::time_point due = pushed_ + lapse_;
        if (Clock::now() < due) {
            // Each push moves the time, and wakes nobody: it is looked at again when the old one has come.
            changed_.wait_until(lock, due);
            continue;
        }
        held_ = false;
        try {
            if (claim_.connected()) set({.force = {}, .torque = {}, .recovery = fade}, lock);
        } catch (const Error& error) {
            say_once(error.what());  // the servo ends the force of a silent claim by itself
        }
    }
}

}  // namespace knurl::lookalike
