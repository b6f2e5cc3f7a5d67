#pragma once
// An application of a few hertz at the servo: each way is one claim and one stroke.

#include <atomic>
#include <string>

#include <knurl/client/client.hpp>

#include "recording.hpp"
#include "terrain.hpp"

namespace surface {

struct StrokeRun {
    std::string device;       // empty: the only one
    double rate = 20;         // Hz, of the application's updates
    double think = 0.025;     // s from reading the hand to answering: the time that a real application takes
                              // to draw
    double stiffness = 2000;  // N/m requested; k_max if that is less
    Span span;                // s since the claim became active
};

/// Claims the device (after a fault: waits until the hand is slow, and resets it), strokes, releases. Returns
/// early on a fault, and when `stop` becomes true. Throws knurl::Error, and std::runtime_error if the device
/// never becomes active.
Recording stroke(knurl::Client& client, Way way, const Terrain& terrain, const StrokeRun& run,
                 const std::atomic<bool>& stop);

}  // namespace surface
