#ifndef KNURL_H
#define KNURL_H

/// @file
/// Knurl for C, and for every language with a foreign function interface: libknurl.so.0.
///
///     knurl_client* client = NULL;
///     knurl_hand* hand = NULL;
///     knurl_id floor_id = 0;
///     knurl_plane floor;
///     knurl_default_plane(&floor);              // its size, and every parameter's default
///     floor.offset = 0.005;                     // m
///     floor.stiffness = 800;                    // N/m
///     if (knurl_connect(NULL, NULL, &client) || knurl_claim(client, NULL, NULL, &hand) ||
///         knurl_add_plane(hand, &floor, NULL, &floor_id) || knurl_arm(hand)) {
///         fprintf(stderr, "%s\n", knurl_error(NULL));
///         return 1;
///     }
///     knurl_frame frame = {.size = sizeof frame};
///     while (knurl_newest(hand, 50000000, &frame) >= 0) {
///         floor.offset = 0.005 + 0.002 * sin(frame.report.read_ns * 1e-9);
///         knurl_set_plane(hand, floor_id, &floor);
///         knurl_commit(hand, NULL);             // takes effect in one cycle; "I am alive"
///     }
///     knurl_close(client);                      // and all that was claimed through it
///
/// What each call does to the hand is said in knurl/client/client.hpp, whose functions these are.
///
/// Codes. Every function returns a knurl_code: KNURL_OK (0); KNURL_NOTHING (1) where nothing was there in
/// time; below 0 an error, of which knurl_error() has one line. A call that fails changes nothing. No
/// function throws, aborts, prints (but hints where knurl_connect_options asks for them), or changes a
/// signal, the locale or the mode of the floating-point unit.
///
/// Handles are numbers in the guise of pointers. They are looked up in each call, so one that was closed, is
/// of another type or was never given is refused with KNURL_BAD_HANDLE. Handles that were made before a fork
/// are refused in the child with KNURL_AFTER_FORK.
///
/// Structs begin with `size`: sizeof the struct as the caller's compiler knows it. A library that knows more
/// members gives the missing ones their defaults, and fills in those alone that fit; one that knows fewer
/// refuses a struct whose excess is not 0. Lengths are in m, forces in N, angles in rad, times in ns where
/// the name ends so, else in s; the frame is the world of the claim (knurl_claim_options).
///
/// Threads. Any function may be called from any thread, with any handle; waiting holds no lock. What is
/// sensible is said behind each function:
///
///     [any]      any number of threads at once, also beside the following two
///     [changes]  one thread at a time for each claim: calls of two are taken one after the other, in an order
///                that nobody promises, and a group is a group of both
///     [reads]    one thread at a time for each hand, beside one that changes it: two would share the reports
///
/// knurl_close from another thread ends calls that wait: they return KNURL_BAD_HANDLE.

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What the library exports.
#define KNURL_API __attribute__((visibility("default")))

/// What a function returns.
typedef enum knurl_code {
    /// Done.
    KNURL_OK = 0,
    /// Nothing was there in time: no report, no answer, no such row.
    KNURL_NOTHING = 1,
    /// Nobody listens under that name.
    KNURL_NO_SERVO = -1,
    /// This user may not open the socket; on another host: the key is wrong.
    KNURL_PERMISSION = -2,
    /// The servo is of another version or layout.
    KNURL_INCOMPATIBLE = -3,
    /// The servo has no such device.
    KNURL_NO_SUCH_DEVICE = -4,
    /// Another process holds the device: knurl_holder().
    KNURL_DEVICE_HELD = -5,
    /// Parameters are out of range; field, value and range are in the line.
    KNURL_BAD_PARAMETERS = -6,
    /// Too many commands at once; nothing was sent.
    KNURL_CHANNEL_FULL = -7,
    /// The device's state forbids it, or there is no place now.
    KNURL_REFUSED = -8,
    /// The servo is gone.
    KNURL_DISCONNECTED = -9,
    /// This is the child of a fork: it has no claim.
    KNURL_AFTER_FORK = -10,
    /// The representation was removed, or is of another claim.
    KNURL_STALE = -11,
    /// This process has no descriptor left, or the socket's path is too long.
    KNURL_EXHAUSTED = -12,
    /// The handle was closed, is of another type, or was never given.
    KNURL_BAD_HANDLE = -13,
    /// A pointer is null where it must not be, or a struct's size is none that the library knows.
    KNURL_BAD_ARGUMENT = -14,
    /// The callback said that it failed.
    KNURL_CALLBACK_FAILED = -15,
    /// No memory.
    KNURL_NO_MEMORY = -16,
    /// Anything else; the line says what.
    KNURL_UNKNOWN = -17
} knurl_code;

/// A connection to a servo.
typedef struct knurl_client knurl_client;
/// A device: claimed (knurl_claim), or only read (knurl_observe); then what changes it is refused.
typedef struct knurl_hand knurl_hand;
/// A mesh or height field on its way to the servo.
typedef struct knurl_sending knurl_sending;

/// A representation of a claim; 0: none.
typedef uint64_t knurl_id;

/// A vector.
typedef struct knurl_vec3 {
    /// x.
    double x;
    /// y.
    double y;
    /// z.
    double z;
} knurl_vec3;

/// A quaternion, scalar first; turns vectors of the probe's frame into the world's.
typedef struct knurl_quat {
    /// Scalar part.
    double w;
    /// x of the vector part.
    double x;
    /// y of the vector part.
    double y;
    /// z of the vector part.
    double z;
} knurl_quat;

/// Value of `recovery`: 20 % of the measured time between updates, within 2 to 50 ms.
#define KNURL_AUTOMATIC (-1.0)
/// A time that never ends, for `timeout_ns`.
#define KNURL_FOREVER INT64_MAX

// ------------------------------------------------------------------------------------ the library itself

/// The library's version: "0.1.0". [any]
KNURL_API const char* knurl_version(void);
/// A number that two builds share if, and only if, they can talk: a servo refuses clients of another one.
/// [any]
KNURL_API uint64_t knurl_layout(void);
/// The line of the last call of this thread with this handle that failed; NULL: of the last one that failed.
/// Empty: none did. Valid until the next call of this thread that fails. [any]
KNURL_API const char* knurl_error(const void* handle);
/// After KNURL_DEVICE_HELD in this thread: the process that holds the device; 0: not known. [any]
KNURL_API int32_t knurl_holder(void);
/// Closes a handle of any type. Of a client: also all that was claimed, observed or is being sent through it.
/// Of a claim: its force fades and the device is free. [any]
KNURL_API int knurl_close(void* handle);

// --------------------------------------------------------------------------------------------- connecting

/// How to connect.
typedef struct knurl_connect_options {
    /// sizeof(knurl_connect_options).
    uint64_t size;
    /// Name that `knurl ls` shows; NULL: the program's.
    const char* name;
    /// How long to wait for a servo that starts, or is full (ns); 2 s by default.
    int64_t wait_ns;
    /// 1 (default): after a restart of the servo, attach and add everything again.
    uint32_t reattach;
    /// 1: print a line on standard error, once each, where a program forgets to arm or to commit, or reads
    /// fewer reports than come. 0 by default: this library prints nothing unless it is told to.
    uint32_t hints;
    /// Of a servo on another host: largest rate of reports (Hz); 0: every report.
    double report_rate;
    /// Of a servo on another host: path of a file with one line of knurl-bridge's keys file; NULL:
    /// $KNURL_KEY, or no key.
    const char* key_file;
} knurl_connect_options;
/// Fills in size and defaults. [any]
KNURL_API void knurl_default_connect_options(knurl_connect_options* options);

/// Connects to "knurl:NAME" (or NAME), the servo of that name on this box, or to "knurl://HOST:PORT". NULL:
/// "knurl:default". `options`: NULL for the defaults. [any]
KNURL_API int knurl_connect(const char* address, const knurl_connect_options* options, knurl_client** out);
/// 0: the servo is gone, and not back yet. Of a client or a hand. [any]
KNURL_API int knurl_connected(const void* handle, uint32_t* connected);
/// Process number of the servo; 0: not connected. [any]
KNURL_API int knurl_servo_pid(const knurl_client* client, int32_t* pid);

/// A device of the servo, in its own frame.
typedef struct knurl_device {
    /// sizeof(knurl_device).
    uint64_t size;
    /// Name by which it is claimed.
    char name[64];
    /// Address that the servo opened: "sim:premium15".
    char address[128];
    /// Name of its profile or product.
    char profile[64];
    /// Serial number; empty: it has none.
    char serial[64];
    /// Rate of its loop (Hz).
    double rate;
    /// Middle of the workspace (m).
    knurl_vec3 workspace_centre;
    /// Radius of the workspace (m).
    double workspace_radius;
    /// Peak force (N).
    double peak_force;
    /// Peak torque (N m).
    double peak_torque;
    /// Largest stiffness (N/m).
    double max_stiffness;
    /// 0: torque is discarded.
    uint32_t renders_torque;
    /// 0: the orientation is that of the base.
    uint32_t senses_orientation;
} knurl_device;
/// The servo's device of this number, from 0; KNURL_NOTHING: there are fewer. [any]
KNURL_API int knurl_device_at(const knurl_client* client, uint32_t index, knurl_device* out);
/// Leaves the fault of a device, whoever holds it. NULL: the only one. [any]
KNURL_API int knurl_reset_fault_of(knurl_client* client, const char* device);

/// How to claim a device.
typedef struct knurl_claim_options {
    /// sizeof(knurl_claim_options).
    uint64_t size;
    /// 1: others may hold the device as well, if they say so too. 0 by default.
    uint32_t shared;
    /// Most representations at once, 1 to 1024; 128 by default.
    uint32_t representations;
    /// Radius of the workspace in the application's world (m); 0 (default): the device's own, scale 1.
    double workspace_radius;
    /// Where the centre of the device's workspace lies in the application's world (m).
    knurl_vec3 workspace_centre;
    /// How often the application means to commit (ns); 0 (default): measured.
    int64_t update_interval_ns;
} knurl_claim_options;
/// Fills in size and defaults. [any]
KNURL_API void knurl_default_claim_options(knurl_claim_options* options);

/// Claims a device by name. NULL: the only one. `options`: NULL for the defaults. [any]
KNURL_API int knurl_claim(knurl_client* client, const char* device, const knurl_claim_options* options,
                          knurl_hand** out);
/// Reads the reports of a device without claiming it. [any]
KNURL_API int knurl_observe(knurl_client* client, const char* device, knurl_hand** out);

// ------------------------------------------------------------------------------------------------ reports

/// State of a device.
typedef enum knurl_device_state {
    /// The device does not answer; no force.
    KNURL_STATE_DISCONNECTED = 0,
    /// Positions are read; no force.
    KNURL_STATE_IDLE = 1,
    /// Claimed and calibrated, gain 0; it waits for a slow hand.
    KNURL_STATE_ARMED = 2,
    /// The force ramps up.
    KNURL_STATE_RAMP_UP = 3,
    /// The whole force.
    KNURL_STATE_ACTIVE = 4,
    /// The force ramps down.
    KNURL_STATE_RAMP_DOWN = 5,
    /// No force, latched until a reset.
    KNURL_STATE_FAULT = 6
} knurl_device_state;

/// Bits of knurl_report::flags.
enum {
    /// The supervisor reduced the wrench in this cycle.
    KNURL_REPORT_CLAMPED = 1,
    /// No new joint sample in this cycle.
    KNURL_REPORT_STALE = 2,
    /// The guardian had put the motors to zero before this cycle.
    KNURL_REPORT_GUARDIAN = 4,
    /// A surface is touched.
    KNURL_REPORT_TOUCHING = 8,
    /// The arm hardly moves, and pushes badly, in one direction.
    KNURL_REPORT_NEAR_SINGULAR = 16,
    /// A joint is within 1 % of its range of a stop.
    KNURL_REPORT_AT_JOINT_LIMIT = 32
};

/// One cycle of a device, in the claim's world frame (of an observer: the device's).
typedef struct knurl_report {
    /// sizeof(knurl_report).
    uint64_t size;
    /// Number of the cycle.
    uint64_t cycle;
    /// When the cycle should have begun (ns of CLOCK_MONOTONIC).
    int64_t deadline_ns;
    /// When the joint sample had been read (ns).
    int64_t read_ns;
    /// When the efforts had been written (ns).
    int64_t write_ns;
    /// Positions of the joints (rad; m if prismatic).
    double joints[8];
    /// Position of the tip (m).
    knurl_vec3 position;
    /// Orientation of the tip.
    knurl_quat orientation;
    /// Velocity of the tip, smooth (m/s).
    knurl_vec3 velocity;
    /// Velocity of the tip by a first-order filter of 20 Hz, for prediction (m/s).
    knurl_vec3 slow_velocity;
    /// Angular velocity of the tip (rad/s).
    knurl_vec3 angular_velocity;
    /// Sum of the scenes' forces before the supervisor (N).
    knurl_vec3 scene_force;
    /// Sum of the scenes' torques about `position` (N m).
    knurl_vec3 scene_torque;
    /// Force after the supervisor (N).
    knurl_vec3 sent_force;
    /// Torque after the supervisor (N m).
    knurl_vec3 sent_torque;
    /// Contact point (m) of probe 0 of the first claim in contact; else the probe's position.
    knurl_vec3 contact_point;
    /// State of the device: knurl_device_state.
    uint32_t state;
    /// Bit mask of faults; what each means is in the reference of reports.
    uint32_t faults;
    /// Bit mask of the buttons that are down.
    uint32_t buttons;
    /// Bit mask of KNURL_REPORT_CLAMPED and the others.
    uint32_t flags;
    /// Cycles whose write ended after the next deadline.
    uint64_t late_count;
    /// A bit per button that flips whenever the button goes down.
    uint32_t presses;
    /// How often a touch began.
    uint32_t touches;
    /// Reports that this reader never saw, in all.
    uint64_t missed;
    /// Newer reports that are there.
    uint64_t unread;
} knurl_report;

/// The newest report, and what happened since the call of knurl_newest before.
typedef struct knurl_frame {
    /// sizeof(knurl_frame).
    uint64_t size;
    /// A bit for each button that went down at least once.
    uint32_t pressed;
    /// A bit for each button that came up at least once.
    uint32_t released;
    /// 1: the hand touched a surface of any claim on the device, though it may not touch it now.
    uint32_t touched;
    /// Number of contacts that began.
    uint32_t touches;
    /// Cycles between the two frames.
    uint64_t skipped;
    /// The report. Its own `size` says how much of it there is room for; set the frame's alone, and it is all
    /// that the frame has.
    knurl_report report;
} knurl_frame;

/// The newest report, with all that happened since the call before; waits for one that was not read.
/// KNURL_NOTHING: none came in time, or not connected. [reads]
KNURL_API int knurl_newest(knurl_hand* hand, int64_t timeout_ns, knurl_frame* out);
/// The newest report, though it may have been read already. KNURL_NOTHING: before the first cycle, or not
/// connected. [reads]
KNURL_API int knurl_latest(knurl_hand* hand, knurl_report* out);
/// The next report in order, waiting for it. KNURL_NOTHING: none came in time, or not connected. [reads]
KNURL_API int knurl_next_report(knurl_hand* hand, int64_t timeout_ns, knurl_report* out);
/// Those reports that were not read, in order, at most `capacity`, without waiting; `out[0].size` says how
/// long each is, and is set by the caller if capacity is not 0. [reads]
KNURL_API int knurl_reports(knurl_hand* hand, knurl_report* out, size_t capacity, size_t* count);
/// A descriptor for poll: readable while a report is there that was not read, and once when the servo has
/// gone. It belongs to the library: do not close it. [reads]
KNURL_API int knurl_fd(knurl_hand* hand, int* fd);
/// Reports that were overwritten before they were read. [any]
KNURL_API int knurl_missed(const knurl_hand* hand, uint64_t* missed);
/// How often the servo came back. [any]
KNURL_API int knurl_reattachments(const knurl_hand* hand, uint64_t* count);
/// What the servo says about the device. [any]
KNURL_API int knurl_device_of(const knurl_hand* hand, knurl_device* out);
/// How old a report with this `read_ns` is now, by the servo's clock (ns), and within what that is right
/// (ns; may be NULL). [any]
KNURL_API int knurl_age(const knurl_hand* hand, int64_t read_ns, int64_t* age_ns, int64_t* uncertainty_ns);

/// What lies between an application and its servo; on one box all 0.
typedef struct knurl_network {
    /// sizeof(knurl_network).
    uint64_t size;
    /// Reports that never came.
    uint64_t lost;
    /// Reports that came after a newer one, and were dropped.
    uint64_t late;
    /// Copies of reports, which were dropped.
    uint64_t duplicated;
    /// Batches that were sent again because no answer had come.
    uint64_t resent;
    /// Shortest round trip of the last exchanges (ns).
    int64_t round_trip_ns;
    /// The servo's CLOCK_MONOTONIC minus ours (ns).
    int64_t clock_offset_ns;
    /// The offset is right within this (ns).
    int64_t clock_uncertainty_ns;
    /// How much faster the servo's clock runs (s/s).
    double drift;
    /// The drift is right within this (s/s).
    double drift_uncertainty;
    /// 1: what is sent is encrypted.
    uint32_t encrypted;
    /// 0.
    uint32_t reserved;
} knurl_network;
/// What lies between the application and its servo. [any]
KNURL_API int knurl_network_of(const knurl_hand* hand, knurl_network* out);

// ---------------------------------------------------------------------------------------- representations

/// What a representation does when its application falls silent.
typedef enum knurl_on_silence {
    /// Fades out.
    KNURL_SILENCE_FADE = 0,
    /// Stands still and goes on acting.
    KNURL_SILENCE_HOLD = 1,
    /// Moves on for `silence_time`, then fades out.
    KNURL_SILENCE_MOVE = 2
} knurl_on_silence;

/// How a representation is used. Fixed when it is added.
typedef struct knurl_add_options {
    /// sizeof(knurl_add_options).
    uint64_t size;
    /// Probe on which it acts, 0 to 15.
    uint32_t probe;
    /// knurl_on_silence.
    uint32_t on_silence;
    /// Time for which KNURL_SILENCE_MOVE goes on (s); 0.1 by default.
    double silence_time;
    /// 0: its wrench and contact point are not reported. 1 by default.
    uint32_t feedback;
    /// 0.
    uint32_t reserved;
} knurl_add_options;
/// Fills in size and defaults. [any]
KNURL_API void knurl_default_add_options(knurl_add_options* options);

/// Adds a representation, in force from the next cycle on. `kind`: KNURL_PLANE and the others of
/// knurl_kinds.h, `params`: knurl_plane and the others, which has a function of its own for each
/// (knurl_add_plane). `options`: NULL for the defaults. [changes]
KNURL_API int knurl_add(knurl_hand* hand, uint32_t kind, const void* params, const knurl_add_options* options,
                        knurl_id* out);
/// New parameters, sent with the next commit. [changes]
KNURL_API int knurl_set(knurl_hand* hand, knurl_id id, uint32_t kind, const void* params);
/// The parameters as they were set last. params->size says how much of them there is room for. [any]
KNURL_API int knurl_get(knurl_hand* hand, knurl_id id, uint32_t kind, void* params);
/// Removes a representation: it fades over its `recovery`. [changes]
KNURL_API int knurl_remove(knurl_hand* hand, knurl_id id);
/// Checks parameters, as knurl_add does, without a servo. [any]
KNURL_API int knurl_validate(uint32_t kind, const void* params);
/// Fills in size and defaults of parameters. [any]
KNURL_API int knurl_default(uint32_t kind, void* params, uint64_t size);
/// Makes parameters of that material: "rubber". What a material does not say stays. [any]
KNURL_API int knurl_made_of(uint32_t kind, const char* material, void* params);
/// Name of the material of this number, from 0; NULL: there are fewer. [any]
KNURL_API const char* knurl_material(uint32_t index);

/// Places a probe (0 to 15) on the hand, in the frame of the device's tool. `offset`: m, NULL for 0;
/// `radius`: m. [changes]
KNURL_API int knurl_place_probe(knurl_hand* hand, uint32_t probe, const knurl_vec3* offset, double radius);

/// From here on, commands (add, remove, place_probe, arm) are one group, which takes effect in one cycle or
/// not at all, until knurl_end_group sends it or knurl_cancel_group forgets it. Groups may lie within others.
/// [changes]
KNURL_API int knurl_begin_group(knurl_hand* hand);
/// Sends the group. [changes]
KNURL_API int knurl_end_group(knurl_hand* hand);
/// Forgets the group. [changes]
KNURL_API int knurl_cancel_group(knurl_hand* hand);

/// Bits of knurl_feedback::flags.
enum {
    /// It acts on the hand in this cycle.
    KNURL_FEEDBACK_TOUCHING = 1,
    /// It is less stiff than the application set.
    KNURL_FEEDBACK_STIFFNESS_CLAMPED = 2,
    /// Its contact set contradicts itself; the force is bounded.
    KNURL_FEEDBACK_INFEASIBLE = 4,
    /// A change is still being cross-faded.
    KNURL_FEEDBACK_FADING = 8,
    /// Its application has fallen silent.
    KNURL_FEEDBACK_SILENT = 16
};

/// What a representation does to the hand. The application's end feels the opposite.
typedef struct knurl_feedback {
    /// sizeof(knurl_feedback).
    uint64_t size;
    /// Force on the hand (N).
    knurl_vec3 force;
    /// Torque on the hand (N m), about the probe's position.
    knurl_vec3 torque;
    /// Contact point (m).
    knurl_vec3 contact_point;
    /// Stiffness as applied (N/m).
    double stiffness;
    /// Stiffness of its friction as applied (N/m); 0: it has none.
    double tangential_stiffness;
    /// Share of `force` that reached the hand (0 to 1).
    double share;
    /// Share of the force's damping part that reached the hand (0 to 1).
    double damping_share;
    /// Cycle to which this belongs.
    uint64_t cycle;
    /// Bit mask of KNURL_FEEDBACK_TOUCHING and the others.
    uint32_t flags;
    /// 0.
    uint32_t reserved;
} knurl_feedback;
/// Feedback of the newest cycle. KNURL_NOTHING: the servo has not evaluated it yet. [any]
KNURL_API int knurl_feedback_of(knurl_hand* hand, knurl_id id, knurl_feedback* out);
/// Stiffness after clamping to what the device allows (N/m). KNURL_NOTHING: the servo has not answered yet.
/// [any]
KNURL_API int knurl_applied_stiffness(knurl_hand* hand, knurl_id id, double* stiffness);

// ----------------------------------------------------------------------------------------------- the claim

/// Allows force: it ramps up over 0.5 s once the hand is slow. Waits for the servo's answer, at most a second.
/// [changes]
KNURL_API int knurl_arm(knurl_hand* hand);
/// Takes this claim's force away. [changes]
KNURL_API int knurl_disarm(knurl_hand* hand);
/// Leaves a fault: the device is idle then, without force, until knurl_arm. [changes]
KNURL_API int knurl_reset_fault(knurl_hand* hand);
/// Sends all changes since the last commit as one batch, which takes effect in one cycle, and renews the
/// claim. `number`: of the batch; may be NULL. KNURL_REFUSED is about something that was sent before: this
/// batch was sent. [changes]
KNURL_API int knurl_commit(knurl_hand* hand, uint64_t* number);
/// Waits until the batch `number` (0: the newest committed) has taken effect. KNURL_NOTHING: not in that time.
/// [any]
KNURL_API int knurl_wait_applied(knurl_hand* hand, uint64_t number, int64_t timeout_ns);

/// From now on a thread of the library renews the claim (all signals are blocked in it), so that it is not
/// taken for dead while nobody commits: as long as knurl_progress() was called within `grace_ns`. 0: as long
/// as this process runs. Below 0: no more. [any]
KNURL_API int knurl_keep_alive(knurl_hand* hand, int64_t grace_ns);
/// Says that the program makes progress, though it does not commit. Cheap: any thread may call it at any rate.
/// [any]
KNURL_API int knurl_progress(knurl_hand* hand);

/// What the device and its rate allow, in world units.
typedef struct knurl_limits {
    /// sizeof(knurl_limits).
    uint64_t size;
    /// Largest stiffness (N/m).
    double max_stiffness;
    /// Peak force (N).
    double max_force;
    /// Peak torque (N m).
    double max_torque;
    /// Largest torsional stiffness (N m/rad).
    double max_torsion;
    /// The device's own damping (N s/m).
    double damping;
    /// Apparent mass at the tip (kg); 0: not known.
    double mass;
    /// Sum of all delays (s).
    double lag;
    /// Nominal period of the servo (s).
    double period;
    /// Resolution at the tip (m).
    double resolution;
    /// Metres of the world that one metre of the device is.
    double metre;
    /// Newtons of the world that one newton of the device is.
    double newton;
} knurl_limits;
/// The device's limits. [any]
KNURL_API int knurl_limits_of(knurl_hand* hand, knurl_limits* out);

/// How late this application is, as measured by the servo.
typedef struct knurl_timing {
    /// sizeof(knurl_timing).
    uint64_t size;
    /// Age of a report when the first force that was computed from its answer had been written (ns); 0: not
    /// measured yet.
    int64_t age_at_use_ns;
    /// Time between commits (ns).
    int64_t interval_ns;
    /// Batches that the servo has taken.
    uint64_t batches;
    /// Batches that the servo refused by its own check.
    uint64_t refused;
    /// Calls of knurl_follow that were too seldom for the surface's curvature.
    uint64_t undersampled;
} knurl_timing;
/// How late this application is. [any]
KNURL_API int knurl_timing_of(knurl_hand* hand, knurl_timing* out);
/// Where the hand will be (m) when an update computed now is half-way through its life. [any]
KNURL_API int knurl_predicted_position(knurl_hand* hand, knurl_vec3* out);

// ----------------------------------------------------------------------------------------- following a model

/// Where a model is nearest to a point.
typedef struct knurl_surface_point {
    /// Nearest point of the surface (m).
    knurl_vec3 foot;
    /// Normal there, towards free space; of any length but 0.
    knurl_vec3 normal;
    /// Curvature along `axis` (1/m). Positive: hollow.
    double curvature;
    /// Curvature across `axis` (1/m).
    double curvature2;
    /// Tangent direction of `curvature`; 0 0 0: that curvature in every direction.
    knurl_vec3 axis;
} knurl_surface_point;

/// A model: fills in the nearest point of its surface to a place (m); `out` comes as zeros. Called from
/// within knurl_follow, in its thread. Other than 0, or a normal that is left at zero: it failed, and
/// knurl_follow returns KNURL_CALLBACK_FAILED. It must return: an exception or longjmp must not leave it.
typedef int (*knurl_surface_model)(void* user, const knurl_vec3* near, knurl_surface_point* out);

/// What knurl_follow found.
typedef struct knurl_followed {
    /// sizeof(knurl_followed).
    uint64_t size;
    /// Planes or caps that it set, 0 to 3; 0: there is no report yet.
    uint32_t faces;
    /// Evaluations of the model.
    uint32_t asked;
    /// Share of the look-ahead that passed the check: 1, 1/2, 1/4 or 0.
    double look_ahead;
    /// Factor by which the look-ahead was shortened before.
    double trust;
    /// 1: the nearest face was not the one by which the hand came in: the last face stays.
    uint32_t kept_side;
    /// 1: between two updates the hand passes more of the surface than a plane or cap can follow.
    uint32_t undersampled;
} knurl_followed;
/// Evaluates `model` where the hand will be when this update takes effect, checks the answer and sets it, of
/// a plane or cap. `step`: other than 0, the model has no curvatures, and they are measured from how its
/// normals turn that far (m) apart. `out`: may be NULL. [changes]
KNURL_API int knurl_follow(knurl_hand* hand, knurl_id id, knurl_surface_model model, void* user, double step,
                           knurl_followed* out);

// -------------------------------------------------------------------------------------------------- assets

/// What a material makes of the representation's stiffness, damping and friction: factors.
typedef struct knurl_asset_material {
    /// On the stiffness, 0 to 1.
    double stiffness;
    /// On the damping, 0 or more.
    double damping;
    /// On the friction, 0 or more.
    double friction;
} knurl_asset_material;

/// A triangle mesh in memory of the caller, which is read during the call.
typedef struct knurl_mesh {
    /// sizeof(knurl_mesh).
    uint64_t size;
    /// x y z of each vertex; one of the two is NULL.
    const double* vertices;
    /// The same in single precision.
    const float* vertices_float;
    /// How many vertices.
    uint64_t vertex_count;
    /// Three vertices of each triangle, counter-clockwise as seen from free space.
    const uint32_t* triangles;
    /// How many triangles.
    uint64_t triangle_count;
    /// Material of each triangle; NULL: all are of material 0.
    const uint8_t* triangle_materials;
    /// The materials; NULL: all triangles feel as the representation says.
    const knurl_asset_material* materials;
    /// How many materials, at most 256.
    uint64_t material_count;
    /// Length of one unit of the vertices (m); 0 means 1.
    double scale;
    /// Vertices nearer to each other than this become one, as a share of the mesh's size; 0 means 1e-6.
    double weld;
    /// 1: corners as double: 32 bytes more a triangle, exact to 1e-11 m.
    uint32_t exact;
    /// 1: crossings are not looked for, which saves 0.6 s per million triangles.
    uint32_t no_crossings;
} knurl_mesh;

/// Heights over a regular grid, in memory of the caller, which is read during the call.
typedef struct knurl_heights {
    /// sizeof(knurl_heights).
    uint64_t size;
    /// Heights (m) row by row, x first; one of the two is NULL.
    const double* heights;
    /// The same in single precision.
    const float* heights_float;
    /// Number of heights along x, 2 or more.
    uint32_t columns;
    /// Number of heights along y, 2 or more.
    uint32_t rows;
    /// Distance from one height to the next along x (m).
    double dx;
    /// Distance from one height to the next along y (m).
    double dy;
    /// Where the first height is, at height 0 (m).
    knurl_vec3 corner;
    /// What the material makes of the representation's parameters; all 0 means all 1.
    knurl_asset_material material;
} knurl_heights;

/// What the servo made of a mesh or height field.
typedef struct knurl_sent {
    /// sizeof(knurl_sent).
    uint64_t size;
    /// Number of the asset, for knurl_shape::asset.
    uint32_t asset;
    /// 0.
    uint32_t reserved;
    /// Faces that are left after mending.
    uint64_t faces;
    /// Bytes of the servo's memory that it takes.
    uint64_t bytes;
    /// Lowest corner of its bounding box (m).
    knurl_vec3 low;
    /// Highest corner of its bounding box (m).
    knurl_vec3 high;
    /// Vertices that became one with another.
    uint64_t vertices_welded;
    /// Faces that were dropped: without area, given twice, with a vertex that is not finite or far away.
    uint64_t faces_dropped;
    /// Faces that were wound against their neighbours, and were turned.
    uint64_t faces_turned;
    /// Edges with one face: the mesh is not closed.
    uint64_t edges_open;
    /// Edges with more than two faces.
    uint64_t edges_non_manifold;
    /// Faces that others cross.
    uint64_t faces_crossed;
    /// Parts that hang together.
    uint64_t parts;
} knurl_sent;

/// Sends a triangle mesh and waits until the servo has it; meanwhile nobody commits, but knurl_keep_alive
/// helps. [changes]
KNURL_API int knurl_send_mesh(knurl_hand* hand, const knurl_mesh* mesh, knurl_sent* out);
/// Sends a height field, likewise. [changes]
KNURL_API int knurl_send_heights(knurl_hand* hand, const knurl_heights* heights, knurl_sent* out);
/// Begins to send a triangle mesh; does not wait. [changes]
KNURL_API int knurl_begin_sending_mesh(knurl_hand* hand, const knurl_mesh* mesh, knurl_sending** out);
/// Begins to send a height field; does not wait. [changes]
KNURL_API int knurl_begin_sending_heights(knurl_hand* hand, const knurl_heights* heights,
                                          knurl_sending** out);
/// What the servo made of it. KNURL_NOTHING: not yet. Once it was answered the handle is closed. [any]
KNURL_API int knurl_sending_done(knurl_sending* sending, int64_t wait_ns, knurl_sent* out);
/// A descriptor for poll: readable when knurl_sending_done has an answer. [any]
KNURL_API int knurl_sending_fd(knurl_sending* sending, int* fd);
/// Forgets an asset of which no representation is made any more. [changes]
KNURL_API int knurl_forget(knurl_hand* hand, uint32_t asset);

// ------------------------------------------------------------------------- what kinds there are, at run time

/// Type of a parameter.
typedef enum knurl_type {
    /// A double.
    KNURL_TYPE_REAL = 0,
    /// A knurl_vec3.
    KNURL_TYPE_VECTOR = 1,
    /// A uint32_t, one of the choices.
    KNURL_TYPE_CHOICE = 2,
    /// A uint32_t.
    KNURL_TYPE_INTEGER = 3,
    /// A knurl_quat.
    KNURL_TYPE_QUATERNION = 4,
    /// count x count doubles, row by row.
    KNURL_TYPE_MATRIX = 5,
    /// count knurl_vec3, then a uint32_t: how many are used.
    KNURL_TYPE_POINTS = 6
} knurl_type;

/// A parameter.
typedef struct knurl_field {
    /// sizeof(knurl_field).
    uint64_t size;
    /// Its name in scene files: "friction.dynamic"; in the struct '_' stands for '.'.
    const char* name;
    /// Its unit; "1" or "": none.
    const char* unit;
    /// What it means, in a few words.
    const char* meaning;
    /// knurl_type.
    uint32_t type;
    /// Of matrix and points, see knurl_type.
    uint32_t count;
    /// Its offset in the struct (bytes).
    uint64_t offset;
    /// Smallest legal value, of each component.
    double minimum;
    /// Largest legal value, of each component.
    double maximum;
    /// 1: infinity is legal, "as stiff as this device allows".
    uint32_t infinity_allowed;
    /// 1: KNURL_AUTOMATIC is legal besides the range.
    uint32_t automatic_allowed;
} knurl_field;

/// Name of the kind of this number, from 0, and the size of its struct (may be NULL); KNURL_NOTHING: there
/// are fewer. [any]
KNURL_API int knurl_kind_at(uint32_t kind, const char** name, uint64_t* size);
/// The parameter of this number, from 0; KNURL_NOTHING: the kind has fewer. [any]
KNURL_API int knurl_field_at(uint32_t kind, uint32_t row, knurl_field* out);
/// Name of the value of a choice, from 0; KNURL_NOTHING: there are fewer. [any]
KNURL_API int knurl_choice_at(uint32_t kind, uint32_t row, uint32_t value, const char** name);

#ifdef __cplusplus
}
#endif

#include "knurl_kinds.h"

#endif
