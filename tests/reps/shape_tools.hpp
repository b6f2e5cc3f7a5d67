#pragma once
// Shared by the tests of curved surfaces: one surface evaluated without a scene.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

namespace knurl::test {

/// A surface as in the servo: prepared, adopted, evaluated once per cycle.
template <class R>
struct Evaluated {
    R params;
    typename R::State state{};

    explicit Evaluated(const R& raw, const Limits& limits = {}) : params(prepared(raw, limits)) {
        const Verdict verdict = kinds()[kind_of<R>].validate(&raw);
        EXPECT_TRUE(verdict) << "field " << verdict.field;
        adopt(params, nullptr, state, Probe{});
    }
    Contact operator()(const Vector& p, double radius = 0, double step = dt) {
        Probe probe = at(p);
        probe.radius = radius;
        return contact(params, state, probe, step);
    }
    void update(const R& raw) {
        const R next = prepared(raw, Limits{});
        adopt(next, &params, state, Probe{});
        params = next;
    }
};

inline Vector force_of(const Contact& c) {
    return c.stiffness * std::max(0.0, -c.height) * c.normal;
}

/// A smooth closed curve, up to about 3 mm across: three harmonics about a centre.
struct SmallLoop {
    Vector centre, a[3], b[3];
    SmallLoop(Rng& rng, const Vector& about, double size = 0.001) : centre(about) {
        for (int h = 0; h < 3; ++h) {
            a[h] = size / (h + 1) * direction(rng);
            b[h] = size / (h + 1) * direction(rng);
        }
    }
    Vector at(double t) const {
        Vector p = centre;
        for (int h = 0; h < 3; ++h) p += a[h] * std::cos((h + 1) * t) + b[h] * std::sin((h + 1) * t);
        return p;
    }
};

/// Work on the hand along the loop (J), force(p, way) in N.
template <class Force>
double work_along(const SmallLoop& loop, int steps, Force&& force) {
    double sum = 0;
    Vector p = loop.at(0);
    for (int i = 0; i < steps; ++i) {
        const Vector next = loop.at(2 * M_PI * (i + 1) / steps);
        sum += force(Vector((p + next) / 2), Vector(next - p)).dot(next - p);
        p = next;
    }
    return sum;
}

}  // namespace knurl::test
