#pragma once
// Evaluates a scene along a motion, offline, through the servo's own cycle and its rings, on the virtual
// clock.

#include <string>
#include <vector>

#include <knurl/drivers/motion.hpp>
#include <knurl/reps/vec.hpp>
#include <knurl/scenefile/scene_file.hpp>

namespace knurl::cli {

struct EvaluationOptions {
    double rate = 1000;       // Hz
    std::string device;       // "sim:PROFILE"; empty: no device, and the probe is exactly on the motion
    std::string motion_file;  // the motion's file, which the simulated hand reads too
};

/// One cycle, in world coordinates (those of the motion).
struct EvaluatedCycle {
    double t = 0;        // s
    Vec3 position;       // m, of the hand
    Vec3 force;          // N, of the scene, before the supervisor
    Vec3 torque;         // N m, about `position`
    Vec3 contact_point;  // m, of probe 0; without contact, the probe itself
};

struct Evaluation {
    std::vector<EvaluatedCycle> cycles;
    std::vector<std::string> remarks;  // one line each: an applied value differs from the requested one
};

/// Throws std::runtime_error: no cycle within the motion, a device that cannot be opened, or a scene that
/// exceeds a bound of the servo.
Evaluation evaluate(const scenefile::SceneFile& scene, const drivers::Motion& motion,
                    const EvaluationOptions& options);

}  // namespace knurl::cli
