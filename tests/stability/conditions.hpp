#pragma once
// All parameters of one simulated stroke. The defaults are the stated centre of the sweep; README.md explains
// each figure.

#include <cmath>
#include <string>

#include <knurl/reps/plane.hpp>

#include "network_profile.hpp"
#include "ridge.hpp"

namespace stability {

/// How the application's model of the surface reaches the hand.
struct Method {
    enum class Kind { force, plane, cap };
    Kind kind = Kind::plane;
    bool predicted = false;  // evaluated where the hand will be (the client library's safe form)
    double recovery = 0;     // s; knurl::automatic: knurl::automatic_fade of the update interval
    knurl::PlaneUpdate update = knurl::PlaneUpdate::fade;
    bool passivity = false;  // with a passivity controller (Hannaford & Ryu 2002)
    double slew = 0;         // N/s, limit on the force; 0: none
};

/// The timetable of every run, s.
inline constexpr double judged_from = 1.0;  // until then the hand comes to rest on the surface
inline constexpr double speed_up = 0.2;     // in which the stroke reaches its speed, loses it, turns round
inline constexpr double rest_from = 6.0;    // the stroke is over
inline constexpr double cycle_from = 7.5;   // from here to the end a limit cycle is measured
inline constexpr double run_end = 8.0;

/// Metres of the application's world per metre of the device, unless stated otherwise: --world.
inline double stated_world = 1;

struct Conditions {
    // The device, at the tip.
    double mass = 0.10;       // kg, its own
    double damping = 0.2;     // N s/m
    double coulomb = 0.05;    // N
    double quantum = 30e-6;   // m, one encoder count
    double lag = 300;         // Hz, corner of the actuators' first-order lag
    double delay = 0;         // s, transport to the actuators
    double peak_force = 8.5;  // N
    double weight = 0;        // N, downwards
    // The hand: grip (K (x_wanted - x) + b (v_wanted - v) - push), and its finger's mass.
    double grip = 1;              // 0: no hand holds the device
    double hand_stiffness = 200;  // N/m, along and across the stroke
    double hand_press = 60;       // N/m, into the surface
    double hand_damping = 3;      // N s/m
    double push = 1.5;            // N, into the surface
    double finger = 0.05;         // kg
    // The servo.
    double rate = 1000;  // Hz
    // The application.
    double update_rate = 20;  // Hz
    double answer = 25e-3;    // s, from reading the hand to its update
    bool remote = false;      // on another host; between it and the servo:
    knurl::bridge::proxy::NetworkProfile network;
    // The stroked surface, and the speed.
    Ridge ridge = gentle_ridge;
    double speed = 0.15;  // m/s; 0: the hand drops on the surface and rests
    double reach = 0;     // m, to and fro over -reach..reach; 0: one way
    // How it is rendered.
    Method method;
    double virtual_damping = 0;   // N s/m, of the surface
    double world = stated_world;  // m, of the application's world and of the scene: a metre of the device's
    bool rate_is_servos = false;  // the application answers in every cycle of the servo

    double total_mass() const { return mass + grip * finger; }
    double total_damping() const { return damping + grip * hand_damping; }
    double period() const { return 1 / rate; }
    double interval() const { return 1 / update_rate; }
    /// All delay between reading a position and the resulting force: tau.
    double lateness() const { return (lag > 0 ? 1 / (2 * M_PI * lag) : 0) + delay; }
};

/// The hand's path: its speed along x at a time, m/s.
double wanted_speed(const Conditions& c, double t);

}  // namespace stability
