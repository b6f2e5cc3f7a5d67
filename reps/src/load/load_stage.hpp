#pragma once
// The stiffness and damping of the scene at the hand: of the contacts as they were solved, and of the effects
// at the probes.

#include <knurl/reps/hand_budget.hpp>

#include "contact/contact_sets.hpp"
#include "effects/effect_stage.hpp"

namespace knurl::detail {

class LoadStage {
  public:
    LoadStage(const SceneState& state, const ContactSets& sets, const EffectStage& effects)
        : state_(state), sets_(sets), effects_(effects) {}

    /// At full strength.
    SceneLoad load() const noexcept;
    /// An upper bound of its eigenvalues, at low cost.
    LoadBound bound() const noexcept;

  private:
    Demand bound_of(const ContactSet& set) const noexcept;
    Demand bound_of(std::uint32_t probe) const noexcept;
    void add(const ContactSet& set, double share, HandLoad& load) const noexcept;
    HandLoad at_probe(const ContactState& contact) const noexcept;
    HandLoad of_contacts() const noexcept;
    HandLoad of_effects() const noexcept;
    double bound_of_turning(const Eigen::Vector3d& force, std::uint32_t probe) const noexcept;
    double bound_of_turning_effects() const noexcept;
    bool has_arm(std::uint32_t probe) const noexcept;
    void move_to_hand(HandLoad& sum, const HandLoad& at_probe, std::uint32_t probe) const noexcept;
    void turn(HandLoad& sum, const Eigen::Vector3d& force, std::uint32_t probe) const noexcept;

    const SceneState& state_;
    const ContactSets& sets_;
    const EffectStage& effects_;
};

}  // namespace knurl::detail
