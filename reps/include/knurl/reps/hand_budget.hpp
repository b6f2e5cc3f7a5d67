#pragma once
// One budget for the hand. Each representation is clamped to what the device stands, but the hand feels their sum:
// probes, surfaces, springs, fields, of all claims. Colgate and Schenkel (1997) bound stiffness and damping of the whole
// loop, so the largest eigenvalues of the summed loads are held at 1 by three scales:
//
//   bounds of all parts > 1 ──> loads summed ──> largest eigenvalues ──> targets ──> scales, slewed
//        (else nothing is done)                                                        │
//   next cycle's scenes: contacts * force, effects * wrench, damping * what velocity makes of both <──┘
//
// Contacts and effects have scales of their own, since the hand must come to rest. Were a spring scaled because a
// surface is touched, it would pull the hand off the surface, be whole again, and pull it back, for ever. So the scale
// of effects does not know what is touched. A contact that is scaled gives way by more, which as a rule keeps it one.

#include <cstdint>

#include <knurl/reps/hand_load.hpp>

namespace knurl {

/// What the hand feels of a scene at full strength, as shares of what the device stands (as_shares).
struct SceneLoad {
    Matrix6 contacts = Matrix6::Zero();  // stiffness of surfaces and their friction, as they are touched
    Matrix6 effects = Matrix6::Zero();   // stiffness
    Matrix6 damping = Matrix6::Zero();   // of both
    bool surfaces = false;               // there are some, touched or not

    SceneLoad& operator+=(const SceneLoad& other) noexcept;
};
SceneLoad operator*(double gain, const SceneLoad& load) noexcept;

/// At least the eigenvalues of a SceneLoad, for next to nothing.
struct LoadBound {
    double contacts = 0, effects = 0, damping = 0;
    bool surfaces = false;

    LoadBound& operator+=(const LoadBound& other) noexcept;
    /// The sum of the parts may be more than there is. Rounding does not make it so.
    bool exceeds() const noexcept;
};

/// What a scene applies to what it feels.
struct HandScales {
    double contacts = 1;  // 0-1, of the forces of surfaces
    double effects = 1;   // 0-1, of the wrenches of effects
    double damping = 1;   // 0-1, of what velocity adds to either
    friend bool operator==(const HandScales&, const HandScales&) = default;
};

class HandBudget {
  public:
    /// Where there are surfaces, effects together get no more than this share: the rest is the surfaces', even when
    /// none is touched.
    static constexpr double effects_share = 0.5;
    /// A scale falls by no more than a share dt / fall_time of itself in a cycle, and rises by no more than
    /// dt / rise_time: a finger that lands or lifts changes the force of the others no faster.
    static constexpr double fall_time = 10e-3, rise_time = 100e-3;  // s

    const HandScales& scales() const noexcept { return scales_; }
    /// All are 1: a load need not be known unless its bound exceeds.
    bool rests() const noexcept { return scales_ == HandScales{}; }
    /// One cycle, with the load of all parts at full strength. An infinite dt: at once.
    void advance(const SceneLoad& load, double dt) noexcept;
    /// One cycle in which the bound did not exceed.
    void advance_within(double dt) noexcept;
    /// Cycles in which eigenvalues were computed.
    std::uint64_t computed() const noexcept { return computed_; }

    /// All that the next cycle depends on, for a recording.
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(scales_.contacts, scales_.effects, scales_.damping);
    }

  private:
    void move(const HandScales& targets, double dt) noexcept;

    HandScales scales_;
    std::uint64_t computed_ = 0;
};

/// Of a symmetric matrix; but 1 where that is not above 1, which costs less to find out.
double largest_eigenvalue_above_1(const Matrix6& matrix) noexcept;

}  // namespace knurl
