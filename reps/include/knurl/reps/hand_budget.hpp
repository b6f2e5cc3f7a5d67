#pragma once
// One budget for the hand. Each representation is clamped to what the device stands, but the hand feels their sum:
// probes, surfaces, springs, fields, of all claims. Colgate and Schenkel (1997) bound the stiffness and the damping
// of the whole loop, so the largest eigenvalues of the summed loads are held at 1 by two scales:
//
//   bounds of all parts > 1 ──> loads summed ──> largest eigenvalues ──> targets ──> scales, slewed
//        (else nothing is done)                                                    │
//   next cycle's scenes damp with damping()/stiffness() <──────────────────────────┤
//   wrench on the hand = stiffness() * sum of all wrenches <───────────────────────┘
//
// The scale is one for all parts: directions keep their proportions, a friction cone stays one, and nothing pulls
// that did not.

#include <cstdint>

#include <knurl/reps/hand_load.hpp>

namespace knurl {

/// At least the eigenvalues of a load in shares (as_shares), for next to nothing.
struct LoadBound {
    double stiffness = 0, damping = 0;

    LoadBound& operator+=(const LoadBound& other) noexcept {
        stiffness += other.stiffness;
        damping += other.damping;
        return *this;
    }
    /// The sum of the parts may be more than the device stands. Rounding does not make it so.
    bool exceeds() const noexcept { return stiffness > 1 + 1e-9 || damping > 1 + 1e-9; }
};

class HandBudget {
  public:
    /// A scale falls by no more than a share dt / fall_time of itself in a cycle, and rises by no more than
    /// dt / rise_time: a finger that lands or lifts changes the force of the others no faster.
    static constexpr double fall_time = 10e-3, rise_time = 100e-3;  // s

    /// Both scales are 1: a load need not be known unless its bound exceeds.
    bool rests() const noexcept { return stiffness_ == 1 && damping_ == 1; }
    /// One cycle, with the load of all parts in shares, at full strength (neither scale in it).
    void advance(const HandLoad& shares, double dt) noexcept;
    /// One cycle in which the bound did not exceed.
    void advance_within(double dt) noexcept;

    double stiffness() const noexcept { return stiffness_; }  // 0-1, of all forces
    double damping() const noexcept { return damping_; }      // 0-1, of what velocity adds to them
    /// What scenes are told (Scene::set_damping_scale), since the sum is scaled by stiffness() afterwards.
    double damping_in_scene() const noexcept { return damping_ / stiffness_; }
    /// Cycles in which eigenvalues were computed.
    std::uint64_t computed() const noexcept { return computed_; }

    /// All that the next cycle depends on, for a recording.
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(stiffness_, damping_);
    }

  private:
    void move(double stiffness, double damping, double dt) noexcept;

    double stiffness_ = 1, damping_ = 1;
    std::uint64_t computed_ = 0;
};

/// Of a symmetric matrix; but 1 where that is not above 1, which costs less to find out.
double largest_eigenvalue_above_1(const Matrix6& matrix) noexcept;

}  // namespace knurl
