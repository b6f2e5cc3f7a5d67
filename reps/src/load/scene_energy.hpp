#pragma once
// The energy that the hand can take out of a scene, and the part of it that fades remove. The budget's scales
// rise by no more than has been paid for.

#include "contact/contact_sets.hpp"

namespace knurl::detail {

/// J, in the world: of a probe's contacts, as they were solved.
PartEnergy energy_of(const ContactState& contact, const Arena& arena, const SceneState& state) noexcept;

/// J that this cycle's step (s) of a fade over `time` (s) from `before` to `after` (J at full strength)
/// removes.
double freed_by_fade(double before, double after, double time, double step) noexcept;

}  // namespace knurl::detail
