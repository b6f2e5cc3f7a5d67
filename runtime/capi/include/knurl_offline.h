#ifndef KNURL_OFFLINE_H
#define KNURL_OFFLINE_H

/// @file
/// A servo in this process, on a virtual clock: libknurl-offline.so.0. The same cycle as of a running servo
/// and of `knurl eval`, as fast as the processor is: for tests, plots and programs that learn.
///
///     knurl_offline* servo = NULL;
///     knurl_offline_open(NULL, NULL, &servo);      // a probe that is exactly where step() puts it
///     knurl_offline_add(servo, KNURL_PLANE, &floor, NULL, &floor_id);
///     knurl_pose pose = KNURL_POSE_INIT;
///     pose.position.z = -0.001;
///     knurl_cycle felt = {.size = sizeof felt};
///     knurl_offline_step(servo, &pose, &felt);     // felt.force.z: 0.8 N
///
/// Codes, handles and structs are as in knurl.h, but for two things: a handle is of this library alone
/// (knurl_offline_close, knurl_offline_error), and one thread at a time may use it: a second one waits.

#include "knurl.h"

#ifdef __cplusplus
extern "C" {
#endif

/// A servo in this process.
typedef struct knurl_offline knurl_offline;

/// How to open.
typedef struct knurl_offline_options {
    /// sizeof(knurl_offline_options).
    uint64_t size;
    /// Cycles a second (Hz); 1000 by default.
    double rate;
    /// Most representations at once, 1 to 1024; 128 by default.
    uint32_t representations;
    /// 0.
    uint32_t reserved;
} knurl_offline_options;
/// Fills in size and defaults.
KNURL_API void knurl_offline_default_options(knurl_offline_options* options);

/// Where the probe is.
typedef struct knurl_pose {
    /// Position (m).
    knurl_vec3 position;
    /// Orientation, of any length but 0.
    knurl_quat orientation;
    /// Velocity (m/s).
    knurl_vec3 velocity;
    /// Angular velocity (rad/s).
    knurl_vec3 angular_velocity;
    /// 1: the velocities are given; 0: they are those of the way since the cycle before, and 0 in the first.
    uint32_t has_velocity;
    /// Bit mask of the buttons that are down.
    uint32_t buttons;
} knurl_pose;
/// At the origin, not turned, velocity to be measured.
#define KNURL_POSE_INIT \
    { {0, 0, 0}, {1, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0, 0 }

/// One cycle.
typedef struct knurl_cycle {
    /// sizeof(knurl_cycle).
    uint64_t size;
    /// Time (s); the first cycle is at 0.
    double time;
    /// Position of the hand (m).
    knurl_vec3 position;
    /// Velocity of the hand, smooth (m/s).
    knurl_vec3 velocity;
    /// Force of the scene on the hand (N).
    knurl_vec3 force;
    /// Torque on the hand (N m), about `position`.
    knurl_vec3 torque;
    /// Contact point (m) of probe 0; without contact, the probe itself.
    knurl_vec3 contact_point;
    /// Bit mask of KNURL_REPORT_TOUCHING and the others.
    uint32_t flags;
    /// Bit mask of the buttons that are down.
    uint32_t buttons;
} knurl_cycle;

/// Opens a servo. `device`: NULL for a probe that is exactly where step() puts it, or the address of a
/// simulated device with a hand of its own ("sim:premium15"), whose limits then hold.
KNURL_API int knurl_offline_open(const char* device, const knurl_offline_options* options,
                                 knurl_offline** out);
/// Closes it.
KNURL_API int knurl_offline_close(knurl_offline* servo);
/// The line of the last call of this thread that failed; empty: none did.
KNURL_API const char* knurl_offline_error(void);

/// Adds a representation, in force in the next cycle. `options`: NULL for the defaults.
KNURL_API int knurl_offline_add(knurl_offline* servo, uint32_t kind, const void* params,
                                const knurl_add_options* options, knurl_id* out);
/// New parameters, in force in the next cycle.
KNURL_API int knurl_offline_set(knurl_offline* servo, knurl_id id, uint32_t kind, const void* params);
/// Removes a representation: it fades over its `recovery`.
KNURL_API int knurl_offline_remove(knurl_offline* servo, knurl_id id);
/// Places a probe (0 to 15) on the hand. `offset`: m, NULL for 0; `radius`: m.
KNURL_API int knurl_offline_place_probe(knurl_offline* servo, uint32_t probe, const knurl_vec3* offset,
                                        double radius);
/// Builds a triangle mesh; knurl_shape::asset then names it.
KNURL_API int knurl_offline_send_mesh(knurl_offline* servo, const knurl_mesh* mesh, knurl_sent* out);
/// Builds a height field, likewise.
KNURL_API int knurl_offline_send_heights(knurl_offline* servo, const knurl_heights* heights, knurl_sent* out);

/// One cycle. `pose`: where the probe is; NULL, and only so, with a device that has a hand of its own.
KNURL_API int knurl_offline_step(knurl_offline* servo, const knurl_pose* pose, knurl_cycle* out);
/// `count` cycles in one call: `poses` (NULL as in step) and `out` have `count` entries; out[0].size says how
/// long each is. Ends with the first cycle that cannot be.
KNURL_API int knurl_offline_run(knurl_offline* servo, const knurl_pose* poses, size_t count,
                                knurl_cycle* out);
/// Feedback of the last cycle. KNURL_NOTHING: it was not evaluated yet.
KNURL_API int knurl_offline_feedback_of(knurl_offline* servo, knurl_id id, knurl_feedback* out);
/// Everything as knurl_offline_open left it: no representation, time 0. Assets stay.
KNURL_API int knurl_offline_reset(knurl_offline* servo);

#ifdef __cplusplus
}
#endif

#endif
