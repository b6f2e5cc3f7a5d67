#pragma once
// The stroke of scripts/demo in this process, on the virtual clock: a relief of apps/demos/surface under the
// simulated hand, the whole of Servo::step, and an application that answers after it has thought. The demo
// has one phase, by chance, and the machine's own lateness; here every phase is tested, reproducibly.

#include <filesystem>

#include <surface/judge.hpp>
#include <surface/stroke.hpp>

#include "table.hpp"

namespace stability {

struct Conditions;

/// The default stroke of knurl-surface.
struct ReliefStroke {
    surface::Terrain terrain;
    surface::Stroke path;
    /// From an elevation model; throws std::runtime_error if it is none.
    static ReliefStroke of(const std::filesystem::path& model);
};

/// On sim:premium15, judged like the demo. Uses the conditions' application and method. `phase` in 0..1: when
/// in its interval the application reads, counted from arming the device; the demo's is 0.
surface::Judgement relief_stroke(const ReliefStroke& stroke, const Conditions& conditions, double stiffness,
                                 double phase);

/// Each way to follow the relief: mean and worst of so many phases, and the demo's phase.
Table relief_table(const ReliefStroke& stroke, unsigned phases);

}  // namespace stability
