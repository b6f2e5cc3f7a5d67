#pragma once
// Shared by the tests of polygon, half_plane and box: one of them without a scene, and the force of its contact.

#include <array>
#include <vector>

#include <knurl/reps/concepts.hpp>

#include "random_polygon.hpp"
#include "scene_tools.hpp"

namespace knurl::test {

inline constexpr double step = 1e-3;  // s, a cycle

inline Probe probe_at(const Vector& position, double radius = 0) {
    Probe probe;
    probe.position = position;
    probe.radius = radius;
    return probe;
}

/// N; k = 1000 N/m.
inline Vector force_of(const Contact& contact) {
    return contact.height < 0 ? Vector(-1000 * contact.height * contact.normal) : Vector(0, 0, 0);
}

/// A representation and its state, as in a scene. Parameters are used as given, unless illegal.
template <class R>
struct Touchable {
    R params;
    typename R::State state{};

    explicit Touchable(const R& raw) : params(prepared(raw, Limits{})) {
        adopt(params, nullptr, state, Probe{});
    }
    void change(const R& raw) {
        const R before = params;
        params = prepared(raw, Limits{});
        adopt(params, &before, state, Probe{});
    }
    Contact at(const Vector& p, double radius = 0, double dt = step) {
        return contact(params, state, probe_at(p, radius), dt);
    }
};

}  // namespace knurl::test
