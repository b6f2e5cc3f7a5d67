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

Servo::Impl::Impl(drivers::Device& the_device, Clock& the_clock, std::byte* segment,
                  const ServoOptions& stated)
    : device(the_device),
      clock(the_clock),
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

void Servo::Impl::take_mail(Nanoseconds now) noexcept {
    Message message;
    for (std::size_t i = 0; i < mailbox_slots && inbox.take(message); ++i) {
        if (message.what == Message::What::adopt) adopt(message.claim, now);
        if (message.what == Message::What::asset || message.what == Message::What::forget)
            take_asset(message);
        if (message.what == Message::What::input_log) {
            command_processor.input_log = input_log = message.input_log;
            next_keyframe = 0;
        }
        if (message.what == Message::What::drop) drop(message.claim);
        if (message.what != Message::What::drop_all) continue;
        ending = true;
        if (input_log != nullptr) input_log->put(InputType::drop_all, {});
        supervisor.disarm();
        for (std::size_t place = 0; place < claims.size(); ++place) drop(place);
    }
    // After the inbox. Whoever was abandoned is dropped by the broker later, so a claim whose drop was read above
    // has its other message read below, before it is given back and its address is another claim's.
    Claim* claim = nullptr;
    for (std::size_t i = 0; i < mailbox_slots && abandoned.take(claim); ++i) drop(claim);
}

// By address: a claim that was already let go may be freed.
void Servo::Impl::drop(Claim* claim) noexcept {
    const std::size_t place = claims.find(claim);
    if (place == claims.size() || claims[place].dropping) return;
    drop(place);
    if (input_log != nullptr && claims[place].channels) put_claim(InputType::drop, claims[place].number);
}

void Servo::Impl::drop(std::size_t place) noexcept {
    claims[place].dropping = true;
    claims.wake(place);
}

void Servo::Impl::adopt(Claim* claim, Nanoseconds now) noexcept {
    if (ending || !claims.adopt(*claim)) {
        outbox.post(claim);  // the broker should have known that it is full
        return;
    }
    Claim::Impl& c = *claim->impl;
    if (c.channels) {
        c.number = ++claims_seen;
        ++held;
        if (input_log != nullptr) input_log->put(InputType::adopt, {as_bytes(c.number), as_bytes(c.terms)});
    }
    c.silence.begin(now);
    if (!options.clamp_stiffness) {
        c.terms.limits.max_stiffness = std::numeric_limits<double>::infinity();
        c.scene.set_limits(c.terms.limits);
    }
    c.scene.set_fade(fade_for(c));
    if (!options.start_active || !c.channels) return;
    c.armed = true;
    c.gain = 1;
    c.from_the_start = true;
    if (supervisor.state() != DeviceState::fault) supervisor.start_active();
}

FadePolicy Servo::Impl::fade_for(const Claim::Impl& claim) const noexcept {
    FadePolicy policy;
    policy.rise_speed = options.rise_speed;
    const double interval = claim.silence.interval();
    if (options.automatic_recovery > 0)
        policy.automatic = options.automatic_recovery;
    else if (interval > 0)
        policy.automatic = automatic_fade(interval);
    return policy;
}

void Servo::Impl::take_changes(Nanoseconds now) noexcept {
    const Authority authority{.supervisor = supervisor,
                              .calibrated = tip.connected && tip.sample.calibrated,
                              .speed = tip.velocity.norm(),
                              .ending = ending,
                              .trouble = trouble,
                              .load = load.mean()};
    const auto listening = [](const Claim::Impl& c) { return c.channels && !c.dropping && !c.faulted; };
    constexpr std::uint64_t shed_every = 16;  // cycles
    const auto heard_now = [&](const Claim::Impl& c) { return !c.shed || report.cycle % shed_every == 0; };
    // Two passes: cache lines that other cores wrote are fetched in parallel, not one after the other.
    const auto awake = claims.awake();
    for (const std::size_t place : awake)
        if (const Claim::Impl& c = claims[place]; listening(c)) c.channels->batches.prefetch();
    Intake intake(awake.size());
    const std::size_t first = std::exchange(first_taken, 0);
    bool somebody_waits = false;
    Nanoseconds taken = load.looks() ? clock.now() : 0;
    for (std::size_t turn = 0; turn < awake.size(); ++turn) {
        const std::size_t at = (first + turn) % awake.size();
        const std::size_t place = awake[at];
        Claim::Impl& c = claims[place];
        if (c.forgotten != 0) return_assets(claims.claim(place));
        c.batch_is_new = false;
        if (!listening(c) || !heard_now(c)) continue;
        if (intake.is_full() && !c.from_the_start) {
            if (!std::exchange(somebody_waits, true)) first_taken = at;
            c.commands_left = true;  // perhaps: it stays awake
            continue;
        }
        take_changes_of(c, authority, intake, now);
        if (load.looks()) taken = charge(c, taken);
    }
}

void Servo::Impl::take_changes_of(Claim::Impl& c, const Authority& authority, Intake& intake,
                                  Nanoseconds now) noexcept {
    intake.add(command_processor.take_commands(c, authority, intake.share(), now));
    if (!c.faulted) intake.add(command_processor.take_batch(c, report.cycle, now));
    if (c.batch_is_new) c.scene.set_fade(fade_for(c));
    // Scenes from before the first cycle start in full force.
    if (c.from_the_start) c.scene.settle();
    settles = settles || c.from_the_start;
    c.from_the_start = false;
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
        if (!c.dropping || c.gain > 0 || !outbox.post(&claim)) return false;
        held -= holds;
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
