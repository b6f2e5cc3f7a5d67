#pragma once
// Shared by the tests of polygon, half_plane and box: random poses, the force of a contact, and references in
// long double that share no code with reps/.

#include <array>
#include <limits>
#include <vector>

#include <knurl/reps/concepts.hpp>

#include "random_polygon.hpp"
#include "scene_tools.hpp"

namespace knurl::test {

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;

inline constexpr double step = 1e-3;  // s, a cycle

inline Vec exact(const Vec3& v) {
    return {v.x, v.y, v.z};
}
inline Vec exact(const Vector& v) {
    return v.cast<Real>();
}

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
