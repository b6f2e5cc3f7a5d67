#pragma once
// What the hand can get out of a scene, and what of that fades take away: for the budget's scales, which rise by no more
// than is paid for.

#include "contact/contact_sets.hpp"

namespace knurl::detail {

/// J, of the world: of a probe's contacts, as they were solved.
PartEnergy energy_of(const ContactState& contact, const Arena& arena, const SceneState& state) noexcept;

/// J that are gone after this cycle's step (s) of a fade over `time` (s) from `before` to `after` (J at full strength).
double freed_by_fade(double before, double after, double time, double step) noexcept;

}  // namespace knurl::detail
