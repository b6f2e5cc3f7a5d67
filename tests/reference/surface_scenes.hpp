#pragma once
// Shared by the tests of all surfaces: one surface in a scene, felt by a probe.

#include <optional>

#include "exact/cap.hpp"
#include "exact/contact.hpp"
#include "judge.hpp"

namespace judge {

/// Draws stiffness (sometimes infinite: the device's largest) and damping. Returns the stiffness as applied.
template <class R>
Real any_material(Rng& rng, R& surface, const Limits& limits) {
    surface.stiffness = rng.one_in(10) ? infinity : rng.uniform(1, 3000);
    if (rng.one_in(3)) surface.damping = rng.uniform(0, 20);
    const Real k = std::isinf(surface.stiffness)
                       ? (std::isinf(limits.max_stiffness) ? Real(1000) : Real(limits.max_stiffness))
                       : Real(surface.stiffness);
    return std::min(k, Real(limits.max_stiffness));
}

inline Limits any_limits(Rng& rng) {
    Limits limits;
    if (rng.one_in(3)) limits.max_stiffness = rng.uniform(500, 3000);
    if (rng.one_in(4)) limits.max_force = rng.uniform(0.1, 10);
    return limits;
}

/// Compares the scene's force with F = max(0, k depth - b v.n) n. `reach` (m): the largest length that
/// enters.
inline void check_one(Case& c, const Vector& got, const exact::Foot& want, Real k, Real damping,
                      const Probe& hand, const Limits& limits, Real reach, bool direction_known = true) {
    const Real depth = std::max(Real(0), -want.height), speed = exact::length(real(hand.velocity));
    const Real rounding = 4e-15L * reach;
    Real size = std::max(Real(0), k * depth - damping * exact::dot(real(hand.velocity), want.normal));
    if (!(depth > 0)) size = 0;
    size = std::min(size, Real(limits.max_force));
    // Rounding turns the normal by rounding / clear. Damping has a step at depth 0.
    Real slack = std::fabs(want.height) < rounding ? damping * speed : 0;
    slack += std::min(Real(2), rounding / want.clear) * (size + (depth > 0 ? damping * speed : 0));
    c.say("  height %Lg normal %Lg %Lg %Lg clear %Lg k %Lg reach %Lg\n", want.height, want.normal.x,
          want.normal.y, want.normal.z, want.clear, k, reach);
    c.require(got.allFinite(), "finite");
    if (direction_known) {
        c.compare_within(got, size * want.normal, slack, k * reach + damping * speed);
    } else {
        // The direction is not defined here, but the magnitude follows from the depth.
        slack = damping > 0 ? 2 * damping * speed : 0;
        c.compare_within({got.norm(), 0, 0}, {size, 0, 0}, slack, k * reach + damping * speed);
    }
    const Real felt = exact::length(real(got));
    c.require(felt <= limits.max_force * (1 + 1e-12L), "at most the device's force");
    if (damping == 0) c.require(felt <= k * (depth + 1e-12L * reach), "no stiffer than its stiffness");
}

/// Evaluates a surface without a scene, to compare its contact also where it is not touched.
template <class R>
class Alone {
  public:
    Alone(const R& surface, const Limits& limits) : params_(prepared(surface, limits)) {
        adopt(params_, nullptr, state_, {});
    }
    /// `want` empty: no contact is expected. A height has the rounding of `reach` (m). A normal has that of
    /// reach / clear, or of reach / `size` where it follows from points that are `size` (m) apart.
    void check(Case& c, const Probe& hand, double radius, double dt, const std::optional<exact::Foot>& want,
               Real reach, bool direction_known = true, Real size = INFINITY) {
        Probe probe = hand;
        probe.radius = radius;
        const knurl::Contact got = contact(params_, state_, probe, dt);
        if (!want) return c.require(got.height == infinity, "no contact at all");
        c.compare({got.height, 0, 0}, {want->height, 0, 0}, reach);
        if (direction_known)
            c.compare_within(got.normal, want->normal, 4e-15L * reach / std::min(want->clear, size), 1);
    }

  private:
    R params_;
    typename R::State state_{};
};

}  // namespace judge
