#pragma once
// Shared by the tests of single effects: one evaluation like the servo's, loops.

#include "scene_tools.hpp"

namespace knurl::test {

/// The wrench of an effect that was just added.
template <class R>
Wrench felt(const R& raw, const Probe& probe, const Limits& limits = {}, double step = dt) {
    const R params = prepared(raw, limits);
    typename R::State state{};
    adopt(params, static_cast<const R*>(nullptr), state, probe);
    return evaluate(params, state, probe, step);
}

/// J, the work of the field on the hand over one turn of path(0) to path(1). By trapezoids, which converge at
/// any rate on a loop.
template <class R, class Path>
double work_of_loop(const R& raw, Path path, int steps = 4000) {
    double work = 0;
    Vector last = path(0.0), last_force = felt(raw, at(last)).force;
    for (int i = 1; i <= steps; ++i) {
        const Vector p = path(static_cast<double>(i) / steps), force = felt(raw, at(p)).force;
        work += 0.5 * (force + last_force).dot(p - last);
        last = p;
        last_force = force;
    }
    return work;
}

}  // namespace knurl::test
