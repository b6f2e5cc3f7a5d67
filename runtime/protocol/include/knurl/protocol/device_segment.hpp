#pragma once
// The report memory of one device: mapped read-only by every client, written by the servo and (the table's
// identity part) by the broker. It outlives the servo in the guardian's hands: it is the flight recorder.
//
//   DeviceInfo | counters | ClientRow[max_clients] | report ring

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/shm/broadcast_ring.hpp>

namespace knurl::protocol {

/// Written once, before the segment is shared.
struct DeviceInfo {
    std::uint64_t magic = 0;  // segment_magic
    std::uint64_t layout_hash = 0;
    char servo[name_bytes] = {};
    char name[name_bytes] = {};     // what claim() calls it: "right"
    char address[name_bytes] = {};  // "sim:premium15"
    char profile[name_bytes] = {};  // LinkConfig::name
    char serial[name_bytes] = {};
    std::uint32_t joints = 0;
    std::uint32_t renders_torque = 0;
    std::uint32_t senses_orientation = 0;
    std::uint32_t servo_pid = 0;
    double rate = 0;              // Hz
    Vec3 workspace_centre;        // m
    double workspace_radius = 0;  // m
    double peak_force = 0;        // N
    double peak_torque = 0;       // N m; 0: it renders none
    double max_stiffness = 0;     // N/m: what k is clamped to, device frame
    double damping = 0;           // N s/m
    double lag = 0;               // s
    std::int64_t started_ns = 0;  // CLOCK_REALTIME
};

/// Counters that anyone may read; single writer each (the servo thread, unless said otherwise).
enum class Count : std::uint32_t {
    cycles,
    late_cycles,
    overruns,
    stalls,
    batches_taken,
    batches_refused,
    batches_merged,
    commands_done,
    commands_refused,
    bad_samples,
    stale_samples,
    kinematics_failures,
    slew_clips,
    force_clamps,
    thermal_clamps,
    joint_clamps,
    faults,
    wakes,
    guardian_zeroings,
    reps_present,
    reps_evaluated,
    clients,
    last_step_ns,
    device_state,
    fault_mask,
    generated_energy_uj,
    // Of one cycle in 64: how many were stamped, and how long its parts took in all of those together.
    stamped_cycles,
    read_ns,
    kinematics_ns,
    take_ns,
    scenes_ns,
    supervise_ns,
    write_ns,
    publish_ns,
    size_
};
inline constexpr std::string_view count_names[] = {
    "cycles",
    "late_cycles",
    "overruns",
    "stalls",
    "batches_taken",
    "batches_refused",
    "batches_merged",
    "commands_done",
    "commands_refused",
    "bad_samples",
    "stale_samples",
    "kinematics_failures",
    "slew_clips",
    "force_clamps",
    "thermal_clamps",
    "joint_clamps",
    "faults",
    "wakes",
    "guardian_zeroings",
    "reps_present",
    "reps_evaluated",
    "clients",
    "last_step_ns",
    "device_state",
    "fault_mask",
    "generated_energy_uj",
    "stamped_cycles",
    "read_ns",
    "kinematics_ns",
    "take_ns",
    "scenes_ns",
    "supervise_ns",
    "write_ns",
    "publish_ns",
};
static_assert(sizeof(count_names) / sizeof(count_names[0]) == static_cast<std::size_t>(Count::size_));

/// One client of the device. All words are relaxed atomics; `identity` is written by the broker (sequence
/// first odd, then even, as a seqlock of its own, since it changes only on attach and hang-up), the rest by
/// the servo.
struct alignas(128) ClientRow {
    std::atomic<std::uint64_t> sequence;  // odd while the broker writes the identity; 0: never used
    std::atomic<std::uint64_t> pid;       // 0: free
    std::atomic<std::uint64_t> role;      // 1 claim, 2 observer
    std::atomic<std::uint64_t> shared;    // 1: allows others on the device
    std::atomic<std::uint64_t> name[name_bytes / 8];
    alignas(128) std::atomic<std::uint64_t> commits;  // batches taken
    std::atomic<std::uint64_t> refused;
    std::atomic<std::uint64_t> merged;       // batches of the client's that never were seen alone
    std::atomic<std::uint64_t> age_ns;       // of the newest batch at its use
    std::atomic<std::uint64_t> interval_ns;  // measured between commits
    std::atomic<std::uint64_t> gain_ppm;
    std::atomic<std::uint64_t> silent;  // 1 while its representations act on silence
    std::atomic<std::uint64_t> armed;   // 1: its force may follow
    std::atomic<std::uint64_t> missed;  // reports, as it says itself; some cycles late
    // What the hand's budget takes away (a millionth each), HandScales less from 1: 0 is nothing.
    std::atomic<std::uint64_t> contacts_cut_ppm, effects_cut_ppm, damping_cut_ppm;
    std::atomic<std::uint64_t> present[Representations::size];  // representations of each kind
};

inline constexpr std::uint64_t segment_magic = 0x306c72756e4b;  // "Knurl0"

struct DeviceLayout {
    std::size_t info = 0, counters = 0, clients = 0, reports = 0, total = 0;  // offsets
};

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
