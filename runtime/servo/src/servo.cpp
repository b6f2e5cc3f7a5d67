#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "servo_impl.hpp"

namespace knurl::servo {

namespace {

std::byte* with_empty_ring(std::byte* segment) {
    shm::broadcast_init(segment + protocol::device_layout().reports);
    return segment;
}

}  // namespace

Servo::Impl::Impl(drivers::Device& the_device, Clock& the_clock, std::byte* memory,
                  const ServoOptions& stated)
    : device(the_device),
      clock(the_clock),
      segment(memory),
      options(stated),
      period(std::llround(1e9 / stated.rate)),
      stages(the_clock),
      load(period),
      tip(the_device, stated.supervisor.off),
      supervisor(the_device.link(), stated.supervisor, stated.rate),
      reports(with_empty_ring(segment) + protocol::device_layout().reports, protocol::report_slots,
              sizeof(Report)),
      counters(segment + protocol::device_layout().counters, protocol::count_names),
      own_damping(max_stiffness(the_device.link(), stated.rate) *
                  (0.5 / stated.rate + the_device.link().lag)) {
    if (options.start_active) supervisor.start_active();
}

// ---------------------------------------------------------------------------------------------- the cycle

void Servo::step(Nanoseconds deadline, Nanoseconds now) noexcept {
    Impl& cycle = *impl_;
    if (cycle.input_log != nullptr) cycle.put_keyframe();  // if one is due
    const double dt = cycle.begin_cycle(deadline, now);    // stalls and jumps of the clock
    cycle.read_device(now);                                // joints -> pose and velocities
    cycle.take_mail(now);                                  // claims that arrive and leave
    cycle.find_awake(now, dt);                             // claims that have something to do
    cycle.take_changes(now);                               // commands and batches -> scenes
    cycle.stages.end(Stage::take);
    const Wrench sum = cycle.evaluate_claims(now, dt);  // scenes -> wrench, gains, sharing
    cycle.stages.end(Stage::scenes);
    const Supervised out = cycle.supervise(sum, dt);  // wrench -> efforts: the last gate
    cycle.stages.end(Stage::supervise);
    cycle.notify_device();
    cycle.write_device(now, out);
    cycle.stages.end(Stage::write);
    if (cycle.input_log != nullptr) cycle.put_cycle(deadline, now);
    cycle.publish(deadline, sum, out);  // report, feedback
    cycle.let_go();                     // claims whose force has faded
    cycle.publish_counters(now);
    cycle.stages.end(Stage::publish);
    cycle.publish_parts();  // in one cycle in 64
    if (cycle.scene_log != nullptr && cycle.report.cycle % scene_log_turn == 0) cycle.show_scenes();
}

double Servo::Impl::begin_cycle(Nanoseconds deadline, Nanoseconds now) noexcept {
    ++report.cycle;
    stages.begin(report.cycle, now);
    if (now > deadline + period) ++overruns;
    const Nanoseconds gap = first ? period : now - last_now;
    first = false;
    last_now = now;
    const double seconds = nominal(gap);
    if (gap < 0 || seconds > options.supervisor.clock_jump) {
        supervisor.raise(fault::clock_jump);
    } else if (seconds > options.supervisor.stall) {
        ++stalls;
        supervisor.hold();
    }
    if (guardian) supervisor.hold();
    watch_load();
    if (guardian_still) stop_for(fault::unguarded);
    if (stopping != 0 && !supervisor.powered()) supervisor.raise(std::exchange(stopping, 0));
    // Representations never get a time gap.
    return std::clamp(seconds, 0.0, std::max(options.max_dt, 1 / options.rate));
}

/// The force goes out by the ramp, and the fault is raised when it has gone.
void Servo::Impl::stop_for(std::uint32_t cause) noexcept {
    if ((stopping & cause) != 0 || !supervisor.powered()) return;
    stopping |= cause;
    supervisor.disarm();
    disarm_claims();
}

/// Seconds. A rate like 3000 Hz has no whole number of nanoseconds: a gap within one nanosecond of the period
/// counts as the period.
double Servo::Impl::nominal(Nanoseconds gap) const noexcept {
    if (gap >= period - 1 && gap <= period + 1) return 1 / options.rate;
    return static_cast<double>(gap) * 1e-9;
}

void Servo::Impl::read_device(Nanoseconds now) noexcept {
    const bool was_gone = unplugged;
    const Trouble found = tip.read(now, stages);
    read_ns = clock.now();
    unplugged = found.unplugged;
    trouble = found.faults;
    if (unplugged) {
        // The fault is reported for at least one cycle, its cause as long as the device is gone.
        if (supervisor.state() == DeviceState::fault && was_gone)
            supervisor.disconnected();
        else if (supervisor.state() != DeviceState::disconnected)
            supervisor.raise(fault::unplugged);
        return;
    }
    if (supervisor.state() == DeviceState::disconnected || (supervisor.faults() & fault::unplugged) != 0)
        supervisor.reconnected();
    if (found.ramp_down) {
        supervisor.disarm();
        disarm_claims();  // a claim that arms during the ramp down arms only itself
    }
    if (trouble != 0) supervisor.raise(trouble);
    // These ramp down first: see stop_for.
    if (load.overloaded()) trouble |= fault::overload;
    if (guardian_still) trouble |= fault::unguarded;
}

Wrench Servo::Impl::evaluate_claims(Nanoseconds now, double dt) noexcept {
    const Probe probe{.position = tip.pose.position,
                      .orientation = tip.pose.orientation,
                      .velocity = tip.velocity,
                      .smooth_velocity = tip.smooth_velocity,
                      .angular_velocity = tip.angular_velocity};
    const double gain_step = dt / options.supervisor.claim_ramp;
    evaluated = 0;
    present = claims.sleeping().present;
    in_contact = nullptr;
    Nanoseconds from = load.looks() ? clock.now() : 0;
    for (const std::size_t place : claims.awake()) {
        Claim::Impl& c = claims[place];
        if (!c.channels) continue;
        if (options.silence) c.watch_silence(now);
        c.advance_gain(gain_step);
        c.scene.set_scales(budget.scales());
        if (!c.shed) evaluate_scene(place, probe, dt);
        if (load.looks()) {
            from = charge(c, from);
            c.cost += (std::exchange(c.charged, 0.0) - c.cost) / 4;
        }
        evaluated += c.scene.evaluated();
        present += c.scene.size();
        if (c.touching && in_contact == nullptr) in_contact = &c;
    }
    passed_hand = probe;
    claims.pass_time(report.cycle, dt);
    if (options.clamp_stiffness && options.budget) keep_within_budget(probe, dt);
    settles = false;
    Wrench sum;
    for (const std::size_t place : claims.awake()) {
        Claim::Impl& c = claims[place];
        if (!c.channels) continue;
        c.scales = budget.scales();
        if (c.gain > 0 && !c.quiet()) sum += c.device_wrench();
    }
    return sum;
}

// A scene out of the hand's reach has no force, so sleeping scenes add no load.
void Servo::Impl::keep_within_budget(const Probe& probe, double dt) noexcept {
    const auto felt = [](const Claim::Impl& c) {
        return c.channels && (c.gain > 0 || c.gain_lost > 0) && !c.quiet() && !c.shed;
    };
    LoadBound bound{.surfaces = claims.sleeping().surfaces};
    for (const std::size_t place : claims.awake()) {
        const Claim::Impl& c = claims[place];
        if (felt(c)) bound += c.scene.load_bound();
    }
    if (budget.rests() && !bound.exceeds()) return;
    const HandScales before = budget.scales();
    SceneLoad load{.surfaces = claims.sleeping().surfaces};
    for (const std::size_t place : claims.awake()) {
        const Claim::Impl& c = claims[place];
        if (!felt(c)) continue;
        const SceneLoad whole = c.scene.load();
        load += c.gain * whole;
        load.in_contacts.freed += c.gain_lost * whole.in_contacts.held;
        load.in_effects.freed += c.gain_lost * whole.in_effects.held;
    }
    const double spent = own_damping * dt * tip.smooth_velocity.squaredNorm();
    budget.advance(load, spent, settles ? std::numeric_limits<double>::infinity() : dt);
    if (!settles || budget.scales() == before) return;
    for (const std::size_t place : claims.awake()) {
        Claim::Impl& c = claims[place];
        if (!felt(c)) continue;
        c.scene.set_scales(budget.scales());
        c.evaluate(probe, 0);
    }
}

Supervised Servo::Impl::supervise(const Wrench& sum, double dt) noexcept {
    int armed = claims.sleeping().armed;
    bool kept_on = claims.sleeping().keep_on;
    for (const std::size_t place : claims.awake()) {
        const Claim::Impl& claim = claims[place];
        if (!claim.wants_force()) continue;
        ++armed;
        kept_on = kept_on || !claim.joined;
    }
    // When the last claim that keeps the device on has gone, the device ramps down under those that joined.
    if (!kept_on) armed = 0;
    const Supervised out = tip.has_pose
                               ? supervisor.supervise(sum, tip.pose.position, tip.velocity, tip.jacobian,
                                                      device.mechanism().joints(), armed, dt)
                               : supervisor.cut(armed, dt);
    // Enabling is never automatic: after a fault, a lost device or a complete ramp down every claim must arm
    // again.
    const DeviceState state = supervisor.state();
    if (state == DeviceState::idle || state == DeviceState::fault || state == DeviceState::disconnected)
        disarm_claims();
    return out;
}

void Servo::Impl::disarm_claims() noexcept {
    for (std::size_t place = 0; place < claims.size(); ++place) {
        if (claims.sleeps_unarmed(place)) continue;  // the usual case on an idle device
        if (std::exchange(claims[place].armed, false)) claims.wake(place);
    }
}

void Servo::Impl::notify_device() noexcept {
    if (supervisor.powered() != enabled) {
        enabled = !enabled;
        device.notify(enabled ? drivers::Notice::enabled : drivers::Notice::disabled);
        wake_claims();
    }
    for (const std::size_t place : claims.awake()) {
        Claim::Impl& c = claims[place];
        if (c.gain < 1 || !enabled) c.announced = false;
        if (c.announced || c.gain < 1 || supervisor.state() != DeviceState::active) continue;
        c.announced = true;
        device.notify(drivers::Notice::claim_active);
    }
}

void Servo::Impl::write_device(Nanoseconds now, const Supervised& out) noexcept {
    written = !unplugged && device.write(now, out.efforts);
    if (!unplugged && !written) {
        supervisor.raise(fault::unplugged);
        disarm_claims();
    }
    write_ns = clock.now();
}

void Servo::Impl::let_go() noexcept {
    const auto awake = claims.awake();
    if (std::none_of(awake.begin(), awake.end(), [this](std::size_t i) { return claims[i].dropping; }))
        return;
    claims.let_go([this](Claim& claim) {
        const Claim::Impl& c = *claim.impl;
        const bool holds = c.channels.has_value();  // read first: a posted claim may be freed
        const std::uint64_t number = c.number;
        if (!c.dropping || c.gain > 0 || !outbox.post(&claim)) return false;
        held -= holds;
        if (holds && scene_log != nullptr) put_scene(SceneRecord::claim_gone, number);
        return true;
    });
}

// ------------------------------------------------------------------------------------------ around it

Servo::Servo(drivers::Device& device, Clock& clock, std::byte* segment, const ServoOptions& options)
    : impl_(std::make_unique<Impl>(device, clock, segment, options)) {}
Servo::~Servo() = default;

bool Servo::adopt(Claim* claim) noexcept {
    return impl_->inbox.post({.what = Message::What::adopt, .claim = claim});
}
bool Servo::drop(Claim* claim) noexcept {
    return impl_->inbox.post({.what = Message::What::drop, .claim = claim});
}
bool Servo::abandon(Claim* claim) noexcept {
    return impl_->abandoned.post(claim);
}
bool Servo::drop_all() noexcept {
    return impl_->inbox.post({.what = Message::What::drop_all});
}
bool Servo::record(InputLog* input_log) noexcept {
    return impl_->inbox.post({.what = Message::What::input_log, .input_log = input_log});
}

bool Servo::show_scenes(RecordLog* scene_log) noexcept {
    return impl_->inbox.post({.what = Message::What::scene_log, .scene_log = scene_log});
}

Claim* Servo::released() noexcept {
    Claim* claim = nullptr;
    return impl_->outbox.take(claim) ? claim : nullptr;
}

std::span<const shm::WakeTarget> Servo::wake_targets() const noexcept {
    return impl_->claims.wake_targets();
}

const Report& Servo::last() const noexcept {
    return impl_->report;
}
const Supervisor& Servo::supervisor() const noexcept {
    return impl_->supervisor;
}

void Servo::guardian_acted() noexcept {
    impl_->guardian = true;
    ++impl_->guardian_zeroings;
}

void Servo::guardian_is_still(bool still) noexcept {
    impl_->guardian_still = still;
}

void Servo::took(Nanoseconds time) noexcept {
    impl_->load.took(time);
}

void Servo::clock_jumped() noexcept {
    impl_->jumped = true;
    impl_->supervisor.raise(fault::clock_jump);
}

}  // namespace knurl::servo
