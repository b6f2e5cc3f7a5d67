#pragma once
// A hand, a servo and a slow application around the library's prediction, on a virtual clock. The hand is a
// mass that follows a path, the servo evaluates a Scene at 1 kHz, and the application reads the hand at 20
// Hz. Its answer acts 25 ms later, cross-faded over 10 ms.

#include <functional>
#include <limits>

#include <knurl/client/predict.hpp>

namespace closed_loop {

using Eigen::Vector3d;
using Path = std::function<Vector3d(double seconds)>;  // where the hand wants to be, m
using Model = knurl::SurfaceModel;

inline constexpr double dt = 1e-3;        // s
inline constexpr int update_cycles = 50;  // 20 Hz
inline constexpr int latency_cycles = 25;
inline constexpr knurl::Lateness lateness{.latency = latency_cycles * dt, .interval = update_cycles * dt};

/// How the application responds.
enum class Way {
    none,       // with the plane where the hand was
    unchecked,  // with the plane where it will be, without a check
    safe,       // like the library
};

struct Hand {
    double mass = 0.1;             // kg
    double damping = 3;            // N s/m ...
    bool damped_to_path = false;   // ... against motion; true: against deviation from the path's motion
    Vector3d grip{300, 300, 300};  // N/m, towards the path
    double push = 0;               // N, downwards
    // The device in it.
    double device_damping = 0;                                    // N s/m
    double coulomb = 0;                                           // N
    double lag = 0;                                               // Hz, corner of the actuators; 0: none
    double quantum = 0;                                           // m, of the encoders
    double peak_force = std::numeric_limits<double>::infinity();  // N
};

/// The stroke of the goals: finger and tip 0.15 kg, 300 Hz actuators, 30 um encoders.
inline const Hand stroking{.mass = 0.15,
                           .damping = 3,
                           .damped_to_path = true,
                           .grip = {200, 200, 60},
                           .push = 1.5,
                           .device_damping = 0.2,
                           .coulomb = 0.05,
                           .lag = 300,
                           .quantum = 30e-6,
                           .peak_force = 8.5};

struct Run {
    Way way = Way::safe;
    double rim = 0;           // of caps; 0: planes
    double stiffness = 1000;  // N/m
    Hand hand{};
    double seconds = 1;
    double judged_from = 0;  // s
    double phase = 0;        // s, of the first update
    // The world's metre and newton for one of the device, for the model, the servo's scene and the library.
    // All else stays in the device's units.
    double metre = 1, newton = 1;
};

struct Outcome {
    double rms_error = 0;     // N, against the true surface's force
    double largest_side = 0;  // N, along x
    Vector3d lowest = Vector3d::Constant(std::numeric_limits<double>::infinity());  // m, each coordinate
    Vector3d highest = Vector3d::Constant(-std::numeric_limits<double>::infinity());
    Vector3d end = Vector3d::Zero();  // m
    double deepest = 0;               // m, below the true surface
    double largest_step = 0;          // N, of the force between two cycles
    double full_share = 0;            // of the updates, that used the whole look-ahead
    double cornered = 0;              // of the updates, that sent more than one face
    double undersampled = 0;          // of the updates
    double asked = 0;                 // calls of the model per update
};

/// The true surface's effect on a hand: from nearest points by default, else from several planes at once.
using Truth = std::function<Vector3d(const Vector3d& p)>;

Outcome run(const Run& how, const Model& model, const Path& path, const Truth& truth = {});

}  // namespace closed_loop
