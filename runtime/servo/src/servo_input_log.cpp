// The cycle's entries in the input log during a recording. CommandProcessor adds what claims send, when it
// takes it.

#include "servo_impl.hpp"
#include "state_words.hpp"

namespace knurl::servo {

/// Only if one is due and nobody holds the device: a claim's scene is not plain state.
void Servo::Impl::put_keyframe() noexcept {
    if (held > 0 || report.cycle < next_keyframe) return;
    next_keyframe = report.cycle + InputLog::keyframe_every;
    std::array<std::uint64_t, max_keyframe_words> words;
    StateWords writer(words, StateWords::To::words);
    state(writer);
    input_log->put(InputType::keyframe, {std::as_bytes(std::span(words).first(writer.visited()))});
}

void Servo::Impl::put_claim(InputType type, std::uint64_t number) noexcept {
    input_log->put(type, {as_bytes(number)});
}

void Servo::Impl::put_cycle(Nanoseconds deadline, Nanoseconds now) noexcept {
    const drivers::JointSample& given = tip.received;
    CycleInput record{.cycle = report.cycle,
                      .deadline = deadline,
                      .now = now,
                      .read_ns = read_ns,
                      .write_ns = write_ns,
                      .status = static_cast<std::uint32_t>(tip.status),
                      .buttons = given.buttons,
                      .load_ppm = load.ppm(),
                      .position = given.position};
    if (given.has_velocity) record.velocity = given.velocity;
    record.flags = (given.has_velocity ? CycleInput::has_velocity : 0) |
                   (given.calibrated ? CycleInput::calibrated : 0) | (written ? CycleInput::written : 0) |
                   (guardian ? CycleInput::guardian : 0) | (jumped ? CycleInput::jumped : 0) |
                   (guardian_still ? CycleInput::guardian_still : 0);
    input_log->put(InputType::cycle, {as_bytes(record).first(record.bytes())});
}

}  // namespace knurl::servo
