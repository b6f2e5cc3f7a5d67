// The outputs of a cycle: the report, each claim's feedback, the counters.

#include <algorithm>

#include "servo_impl.hpp"

namespace knurl::servo {

void Servo::Impl::publish(Nanoseconds deadline, const Wrench& sum, const Supervised& out) noexcept {
    if (write_ns > deadline + period) ++late;
    report.deadline_ns = deadline;
    report.read_ns = read_ns;
    report.write_ns = write_ns;
    report.joints = tip.sample.position;
    tip.look_at_posture();
    report.position = to_plain(tip.pose.position);
    report.orientation = to_plain(tip.pose.orientation);
    report.velocity = to_plain(tip.smooth_velocity);
    report.slow_velocity = to_plain(tip.slow_velocity);
    report.angular_velocity = to_plain(tip.angular_velocity);
    report.scene_force = to_plain(sum.force);
    report.scene_torque = to_plain(sum.torque);
    report.sent_force = to_plain(out.sent.force);
    report.sent_torque = to_plain(out.sent.torque);
    report.contact_point =
        to_plain(in_contact != nullptr ? in_contact->device_contact_point() : tip.pose.position);
    report.state = supervisor.state();
    report.faults = supervisor.faults();
    report.presses ^= tip.sample.buttons & ~report.buttons;
    report.buttons = tip.sample.buttons;
    report.touches += in_contact != nullptr && (report.flags & report_flags::touching) == 0 ? 1 : 0;
    report.flags = out.flags | (tip.stale ? report_flags::stale : 0) |
                   (guardian ? report_flags::guardian : 0) |
                   (in_contact != nullptr ? report_flags::touching : 0) |
                   (tip.near_singular ? report_flags::near_singular : 0) |
                   (tip.at_joint_limit ? report_flags::at_joint_limit : 0);
    report.late_count = late;
    guardian = jumped = false;
    reports.publish(&report);
    read_times[report.cycle % read_times.size()] = read_ns;

    for (const std::size_t place : claims.awake()) {
        Claim::Impl& c = claims[place];
        if (c.batch_is_new) {
            c.in_force.write_ns = write_ns;
            const std::uint64_t from = c.in_force.report_cycle;
            const bool known = from > 0 && from <= report.cycle && report.cycle - from < read_times.size();
            c.in_force.age_ns = known ? write_ns - read_times[from % read_times.size()] : 0;
        }
        c.publish(report.cycle);
        put_to_sleep(place);
    }
    // Claims take turns: the client's cache line may have to come from another core, and this counter is not
    // urgent.
    constexpr std::uint64_t missed_every = 64;  // cycles
    for (std::size_t i = report.cycle % missed_every; i < claims.size(); i += missed_every)
        claims[i].publish_missed();
}

void Servo::Impl::publish_counters(Nanoseconds now) noexcept {
    const auto set = [this](protocol::Count which, std::uint64_t value) {
        counters.set(static_cast<std::size_t>(which), value);
    };
    const CommandCounts& taken = command_processor.counts();
    const Supervisor::Counts& gate = supervisor.counts();
    set(protocol::Count::cycles, report.cycle);
    set(protocol::Count::late_cycles, late);
    set(protocol::Count::overruns, overruns);
    set(protocol::Count::stalls, stalls);
    set(protocol::Count::batches_taken, taken.batches_taken);
    set(protocol::Count::batches_refused, taken.batches_refused);
    set(protocol::Count::batches_merged, taken.batches_merged);
    set(protocol::Count::commands_done, taken.commands_done);
    set(protocol::Count::commands_refused, taken.commands_refused);
    set(protocol::Count::bad_samples, tip.bad_samples);
    set(protocol::Count::stale_samples, tip.stale_samples);
    set(protocol::Count::kinematics_failures, tip.kinematics_failures);
    set(protocol::Count::slew_clips, gate.slew_clips);
    set(protocol::Count::force_clamps, gate.force_clamps);
    set(protocol::Count::thermal_clamps, gate.thermal_clamps);
    set(protocol::Count::joint_clamps, gate.joint_clamps);
    set(protocol::Count::faults, gate.faults);
    set(protocol::Count::guardian_zeroings, guardian_zeroings);
    set(protocol::Count::reps_present, present);
    set(protocol::Count::reps_evaluated, evaluated);
    set(protocol::Count::clients, claims.size());
    const auto step = static_cast<std::uint64_t>(std::max<Nanoseconds>(0, write_ns - now));
    longest_step = std::max(longest_step, step);
    set(protocol::Count::last_step_ns, step);
    set(protocol::Count::longest_step_ns, longest_step);
    set(protocol::Count::claims_shed, claims_shed);
    set(protocol::Count::device_state, static_cast<std::uint64_t>(supervisor.state()));
    set(protocol::Count::fault_mask, supervisor.faults());
    set(protocol::Count::generated_energy_uj,
        static_cast<std::uint64_t>(std::min(gate.generated_energy * 1e6, 1e18)));
}

void Servo::Impl::publish_parts() noexcept {
    using protocol::Count;
    constexpr auto read = static_cast<std::size_t>(Count::read_ns);
    static_assert(static_cast<std::size_t>(Count::publish_ns) - read ==
                  static_cast<std::size_t>(Stage::publish));
    if (!stages.stamping()) return;
    counters.set(static_cast<std::size_t>(Count::stamped_cycles), stages.stamped());
    for (std::size_t i = 0; i < static_cast<std::size_t>(Stage::size_); ++i)
        counters.set(read + i, stages.sum(static_cast<Stage>(i)));
}

}  // namespace knurl::servo
