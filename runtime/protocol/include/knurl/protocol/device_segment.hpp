#pragma once

/// @file
/// The report memory of one device: mapped read-only by every client, written by the servo and (the table's
/// identity part) by the broker. It outlives the servo in the guardian's hands: it is the flight recorder.
///
///     DeviceInfo | counters | ClientRow[max_clients] | report ring

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/bounds.hpp>
#include <knurl/shm/broadcast_ring.hpp>

namespace knurl::protocol {

/// What a device is. Written once, before the segment is shared.
struct DeviceInfo {
    /// segment_magic.
    std::uint64_t magic = 0;
    /// wire_hash().
    std::uint64_t layout_hash = 0;
    /// Name of the servo.
    char servo[name_bytes] = {};
    /// Name by which it is claimed: "right".
    char name[name_bytes] = {};
    /// Address: "sim:premium15".
    char address[name_bytes] = {};
    /// LinkConfig::name.
    char profile[name_bytes] = {};
    /// Serial number; empty: it has none.
    char serial[name_bytes] = {};
    /// Number of sensed joints.
    std::uint32_t joints = 0;
    /// 0: torque is discarded.
    std::uint32_t renders_torque = 0;
    /// 0: the orientation is that of the base.
    std::uint32_t senses_orientation = 0;
    /// Process number of the servo.
    std::uint32_t servo_pid = 0;
    /// Rate of its loop (Hz).
    double rate = 0;
    /// Middle of the workspace (m), device frame.
    Vec3 workspace_centre;
    /// Radius of the workspace (m).
    double workspace_radius = 0;
    /// Peak force (N).
    double peak_force = 0;
    /// Peak torque (N m); 0: it renders none.
    double peak_torque = 0;
    /// Largest stiffness k_max (N/m), device frame: what k is clamped to.
    double max_stiffness = 0;
    /// The device's own damping b (N s/m).
    double damping = 0;
    /// Sum of all delays tau (s).
    double lag = 0;
    /// When the servo began (ns of CLOCK_REALTIME).
    std::int64_t started_ns = 0;
};

/// Counters that anyone may read; single writer each (the servo thread, unless said otherwise).
enum class Count : std::uint32_t {
    /// Cycles.
    cycles,
    /// Cycles whose write ended after the next deadline.
    late_cycles,
    /// Cycles that began more than a period after their deadline.
    overruns,
    /// Gaps between cycles that set the gain to 0.
    stalls,
    /// Batches taken.
    batches_taken,
    /// Batches refused.
    batches_refused,
    /// Batches that were merged into a later one.
    batches_merged,
    /// Commands done.
    commands_done,
    /// Commands refused.
    commands_refused,
    /// Bad samples of the joints.
    bad_samples,
    /// Cycles without a new sample.
    stale_samples,
    /// Samples for which the mechanism had no pose.
    kinematics_failures,
    /// Cycles in which the slew gate clipped.
    slew_clips,
    /// Clamps of force or torque to its peak.
    force_clamps,
    /// Cycles in which the thermal limit clamped the force.
    thermal_clamps,
    /// Cycles in which the joint efforts were clamped.
    joint_clamps,
    /// Faults.
    faults,
    /// Cycles in which a client was woken.
    wakes,
    /// Times that the guardian put the motors to zero.
    guardian_zeroings,
    /// Representations of all claims.
    reps_present,
    /// Representations that the last cycle evaluated.
    reps_evaluated,
    /// Claims and observers.
    clients,
    /// Time from the begin of the last cycle to the end of its write (ns).
    last_step_ns,
    /// The longest such time of any cycle (ns).
    longest_step_ns,
    /// Times that a claim was shed, because the cycles had no time for it.
    claims_shed,
    /// DeviceState.
    device_state,
    /// Bit mask of faults.
    fault_mask,
    /// Energy put into the hand since contact began (µJ), by the passivity observer.
    generated_energy_uj,
    /// Cycles whose parts were timed, one in 64; the following are the sums over these.
    stamped_cycles,
    /// Time for reading the joints (ns).
    read_ns,
    /// Time for the kinematics (ns).
    kinematics_ns,
    /// Time for taking commands and batches (ns).
    take_ns,
    /// Time for evaluating the scenes (ns).
    scenes_ns,
    /// Time for the supervisor (ns).
    supervise_ns,
    /// Time for writing the efforts (ns).
    write_ns,
    /// Time for publishing report and feedback (ns).
    publish_ns,
    /// How many counters there are.
    size_
};
/// Their names, in order.
inline constexpr std::string_view count_names[] = {
    "cycles",           "late_cycles",     "overruns",          "stalls",
    "batches_taken",    "batches_refused", "batches_merged",    "commands_done",
    "commands_refused", "bad_samples",     "stale_samples",     "kinematics_failures",
    "slew_clips",       "force_clamps",    "thermal_clamps",    "joint_clamps",
    "faults",           "wakes",           "guardian_zeroings", "reps_present",
    "reps_evaluated",   "clients",         "last_step_ns",      "longest_step_ns",
    "claims_shed",      "device_state",    "fault_mask",        "generated_energy_uj",
    "stamped_cycles",   "read_ns",         "kinematics_ns",     "take_ns",
    "scenes_ns",        "supervise_ns",    "write_ns",          "publish_ns",
};
static_assert(sizeof(count_names) / sizeof(count_names[0]) == static_cast<std::size_t>(Count::size_));

/// One client of the device. All words are relaxed atomics. The identity (sequence to name) is written by the
/// broker; `sequence` is odd while it is written, as a seqlock of its own, since it changes only on attach
/// and hang-up. The rest is written by the servo.
struct alignas(128) ClientRow {
    /// Odd while the broker writes the identity; 0: never used.
    std::atomic<std::uint64_t> sequence;
    /// Process number; 0: the row is free.
    std::atomic<std::uint64_t> pid;
    /// 1: claim; 2: observer.
    std::atomic<std::uint64_t> role;
    /// 1: it allows others on the device.
    std::atomic<std::uint64_t> shared;
    /// Its name.
    std::atomic<std::uint64_t> name[name_bytes / 8];
    /// Batches taken.
    alignas(128) std::atomic<std::uint64_t> commits;
    /// Batches refused.
    std::atomic<std::uint64_t> refused;
    /// Batches that were merged into a later one.
    std::atomic<std::uint64_t> merged;
    /// Age at use of the newest batch (ns).
    std::atomic<std::uint64_t> age_ns;
    /// Time between commits, as measured (ns).
    std::atomic<std::uint64_t> interval_ns;
    /// Gain of the claim (millionths).
    std::atomic<std::uint64_t> gain_ppm;
    /// 1: silent, so that its representations act by their on_silence.
    std::atomic<std::uint64_t> silent;
    /// 1: armed.
    std::atomic<std::uint64_t> armed;
    /// 1: shed, because the cycles had no time for it.
    std::atomic<std::uint64_t> shed;
    /// Reports missed, as the client itself says; some cycles late.
    std::atomic<std::uint64_t> missed;
    /// What the hand's budget takes from surfaces, 1 - HandScales::contacts (millionths); 0: nothing.
    std::atomic<std::uint64_t> contacts_cut_ppm;
    /// What it takes from effects, 1 - HandScales::effects (millionths).
    std::atomic<std::uint64_t> effects_cut_ppm;
    /// What it takes from damping, 1 - HandScales::damping (millionths).
    std::atomic<std::uint64_t> damping_cut_ppm;
    /// Number of representations of each kind.
    std::atomic<std::uint64_t> present[max_kinds];
};

/// "Knurl0".
inline constexpr std::uint64_t segment_magic = 0x306c72756e4b;

/// Where the parts of a device's segment lie (bytes from its beginning).
struct DeviceLayout {
    /// DeviceInfo.
    std::size_t info = 0;
    /// Counters.
    std::size_t counters = 0;
    /// Rows of clients.
    std::size_t clients = 0;
    /// Report ring.
    std::size_t reports = 0;
    /// Bytes of the segment.
    std::size_t total = 0;
};

/// The layout of a device's segment.
constexpr DeviceLayout device_layout() {
    const auto align = [](std::size_t n) { return (n + 127) / 128 * 128; };
    DeviceLayout layout;
    layout.counters = align(sizeof(DeviceInfo));
    layout.clients = layout.counters + align(static_cast<std::size_t>(Count::size_) * 8);
    layout.reports = layout.clients + max_clients * sizeof(ClientRow);
    layout.total =
        (layout.reports + align(shm::broadcast_bytes(report_slots, sizeof(Report))) + 4095) / 4096 * 4096;
    return layout;
}

}  // namespace knurl::protocol
