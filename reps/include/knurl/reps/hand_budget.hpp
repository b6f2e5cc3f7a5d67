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
//
// The loop stays passive while scales change. With V the potential of the parts at full strength the hand has the energy
// E = m v^2 / 2 + s V, of which a scale that falls takes s' V away, and one that rises gives s' V: a hand that slips off
// one surface, and is pushed back by another that has become stiffer, would go to and fro for ever. So a scale rises by no
// more than is paid: freely where nothing is held (V = 0); else by what fades take away where the hand is (an application
// that removes a surface), and by half of what damping takes from the moving hand and the loop's delay does not give
// back. What scales took when they fell pays for nothing: until they have fallen the loop is too stiff, and makes energy.

#include <knurl/reps/hand_load.hpp>

namespace knurl {

/// What the hand feels of a scene at full strength, as shares of what the device stands (as_shares).
struct SceneLoad {
    Matrix6 contacts = Matrix6::Zero();  // stiffness of surfaces and their friction, as they are touched
    Matrix6 effects = Matrix6::Zero();   // stiffness
    Matrix6 damping = Matrix6::Zero();   // of both
    PartEnergy in_contacts = {}, in_effects = {};  // of the device
    bool surfaces = false;                         // there are some, touched or not

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
    /// Of what damping takes and the loop's delay does not give back, so much pays for scales that rise.
    static constexpr double spent_share = 0.5;

    const HandScales& scales() const noexcept { return scales_; }
    /// All are 1: a load need not be known unless its bound exceeds.
    bool rests() const noexcept { return scales_ == HandScales{}; }
    /// One cycle, with the load of all parts at full strength. `spent`: what the damping that k_max stands on takes
    /// from the hand in it (J). An infinite dt: at once.
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
