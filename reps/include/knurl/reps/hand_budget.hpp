#pragma once

/// @file
/// One budget for the hand. Each representation is clamped to what the device stands, but the hand feels
/// their sum: probes, surfaces, springs, fields, of all claims. Colgate and Schenkel (1997) bound stiffness
/// and damping of the whole loop, so the largest eigenvalues of the summed loads are held at 1 by three
/// scales:
///
///     bounds of all parts > 1 ──> loads summed ──> largest eigenvalues ──> targets ──> scales, slewed
///          (else nothing is done)                                                        │
///     next cycle's scenes: contacts * force, effects * wrench, damping * what velocity makes of both <──┘
///
/// Contacts and effects have scales of their own, since the hand must come to rest. Were a spring scaled
/// because a surface is touched, it would pull the hand off the surface, be whole again, and pull it back,
/// for ever. So the scale of effects does not know what is touched. A contact that is scaled gives way by
/// more, which as a rule keeps it one.
///
/// The loop stays passive while scales change. With V the potential of the parts at full strength the hand
/// has the energy E = m v^2 / 2 + s V, of which a scale that falls takes s' V away, and one that rises gives
/// s' V: a hand that slips off one surface, and is pushed back by another that has become stiffer, would go
/// to and fro for ever. So a scale rises by no more than is paid: freely where nothing is held (V = 0); else
/// by what fades take away where the hand is (an application that removes a surface), and by half of what
/// damping takes from the moving hand and the loop's delay does not give back. What scales took when they
/// fell pays for nothing: until they have fallen the loop is too stiff, and makes energy.

#include <knurl/reps/hand_load.hpp>

namespace knurl {

/// What the hand feels of a scene at full strength, as shares of what the device stands (as_shares).
struct SceneLoad {
    /// Stiffness of surfaces and their friction, as they are touched.
    Matrix6 contacts = Matrix6::Zero();
    /// Stiffness of effects.
    Matrix6 effects = Matrix6::Zero();
    /// Damping of both.
    Matrix6 damping = Matrix6::Zero();
    /// Energy in surfaces (J of the device).
    PartEnergy in_contacts = {};
    /// Energy in effects (J of the device).
    PartEnergy in_effects = {};
    /// True: there are surfaces, touched or not.
    bool surfaces = false;

    /// Adds another scene's load.
    SceneLoad& operator+=(const SceneLoad& other) noexcept;
};
/// A scene's load at that gain.
SceneLoad operator*(double gain, const SceneLoad& load) noexcept;

/// At least the eigenvalues of a SceneLoad, for next to nothing.
struct LoadBound {
    /// Bound of SceneLoad::contacts (1).
    double contacts = 0;
    /// Bound of SceneLoad::effects (1).
    double effects = 0;
    /// Bound of SceneLoad::damping (1).
    double damping = 0;
    /// True: there are surfaces.
    bool surfaces = false;

    /// Adds another scene's bound.
    LoadBound& operator+=(const LoadBound& other) noexcept;
    /// True: the sum of the parts may be more than there is. Rounding does not make it so.
    bool exceeds() const noexcept;
};

/// What a scene applies to what it feels.
struct HandScales {
    /// Scale of the forces of surfaces, 0 to 1.
    double contacts = 1;
    /// Scale of the wrenches of effects, 0 to 1.
    double effects = 1;
    /// Scale of the damping part of both, 0 to 1.
    double damping = 1;
    friend bool operator==(const HandScales&, const HandScales&) = default;
};

/// Finds the three scales, cycle by cycle. The head of this file says why and how.
class HandBudget {
  public:
    /// Share that effects get together at most where there are surfaces (1). The rest is for the surfaces,
    /// even when none is touched.
    static constexpr double effects_share = 0.5;
    /// A scale falls by no more than a share dt / fall_time of itself in a cycle (s).
    static constexpr double fall_time = 10e-3;
    /// A scale rises by no more than dt / rise_time in a cycle (s): a finger that lands or lifts changes the
    /// force of the others no faster.
    static constexpr double rise_time = 100e-3;
    /// Share (1) of what damping takes from the hand and the loop's delay does not give back that pays for
    /// scales that rise.
    static constexpr double spent_share = 0.5;

    /// The scales for the next cycle.
    const HandScales& scales() const noexcept { return scales_; }
    /// True: all scales are 1, so a load need not be known unless its bound exceeds.
    bool rests() const noexcept { return scales_ == HandScales{}; }
    /// One cycle, with the load of all parts at full strength. `spent`: what the damping on which k_max
    /// stands takes from the hand in this cycle (J). An infinite dt: at once.
    void advance(const SceneLoad& load, double spent, double dt) noexcept;

    /// All that the next cycle depends on, for a recording.
    template <class Visit>
    void state(Visit& visit) noexcept {
        visit(scales_.contacts, scales_.effects, scales_.damping, tank_);
    }

  private:
    HandScales slewed(const HandScales& targets, double dt) const noexcept;
    void pay(HandScales& next, const SceneLoad& load, double spent) noexcept;

    HandScales scales_;
    double tank_ = 0;  // J, for scales that wait to rise
};

/// Of a symmetric matrix; but 1 where that is not above 1, which costs less to find out.
double largest_eigenvalue_above_1(const Matrix6& matrix) noexcept;

}  // namespace knurl
