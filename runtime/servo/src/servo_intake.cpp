// What comes into a cycle from outside: claims from the broker, deaths, commands and batches.

#include <limits>
#include <utility>

#include "servo_impl.hpp"

namespace knurl::servo {

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
        if (message.what == Message::What::scene_log) watch_scenes(message.scene_log);
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
        if (scene_log != nullptr) c.unshown.all();
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

}  // namespace knurl::servo
