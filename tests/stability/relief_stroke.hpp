#pragma once
// The stroke of scripts/demo in this process, on the virtual clock: a relief of apps/demos/surface under the
// simulated hand, all of Servo::step, and an application that answers after it has thought. The demo itself
// has one phase, whichever it happens to be, and a machine's own lateness; here every phase is there, twice
// the same.

#include <filesystem>

#include <surface/judge.hpp>
#include <surface/stroke.hpp>

#include "table.hpp"

namespace stability {

struct Conditions;

/// What knurl-surface strokes unless told otherwise.
struct ReliefStroke {
    surface::Terrain terrain;
    surface::Stroke path;
    /// Of an elevation model; throws std::runtime_error if it is none.
    static ReliefStroke of(const std::filesystem::path& model);
};

/// On sim:premium15, judged as the demo judges. Of the conditions those of the application and the method
/// count. `phase` in 0..1: when in its interval the application reads, counted from when it arms the device;
/// the demo's is 0.
surface::Judgement relief_stroke(const ReliefStroke& stroke, const Conditions& conditions, double stiffness,
                                 double phase);

/// Each way to follow the relief: mean and worst of so many phases, and the demo's.
Table relief_table(const ReliefStroke& stroke, unsigned phases);

}  // namespace stability
