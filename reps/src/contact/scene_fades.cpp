// Cross-fades of contact sets: which set fades out, from where, and when the fade ends.

#include <algorithm>

#include "contact/contact_sets.hpp"
#include "scene/clamped.hpp"

namespace knurl::detail {

void ContactSets::keep_old(std::uint32_t i) noexcept {
    SetSlot& slot = slots_[i];
    slot.old_surface_of = state_.records.old(i).probe;
    slot.old_in_fade = 0;
    if (slot.old_listed) return;
    slot.old_listed = true;
    olds_.push_back(i);
}

bool ContactSets::old_fades(const SetSlot& slot) const noexcept {
    if (slot.old_surface_of < 0) return false;
    const CrossFade& fade = states_[static_cast<std::uint32_t>(slot.old_surface_of)].fade;
    return fade.under_way && !fade.frozen && fade.number == slot.old_in_fade;
}

bool ContactSets::old_in_use(std::uint32_t i) const noexcept {
    const SetSlot& slot = slots_[i];
    return slot.old_surface_of >= 0 && (slot.old_in_fade == 0 || old_fades(slot));
}

void ContactSets::release_old(std::uint32_t i) noexcept {
    SetSlot& slot = slots_[i];
    if (old_fades(slot)) {
        SetChange& change = states_[static_cast<std::uint32_t>(slot.old_surface_of)].change;
        change.edited = change.interrupted = true;
        edited_ = true;
    }
    slot.old_surface_of = -1;
}

void ContactSets::replace_probe(std::uint32_t p) noexcept {
    ContactState& contact = states_[p];
    // There was no force, and a larger probe reaches nothing.
    if (contact.now.count == 0 && !contact.fade.under_way && !candidates_.any(p)) return;
    contact.change.fade_over(0);
    contact.change.time = state_.policy.automatic;
    contact.change.interrupted = contact.change.replaced = true;
    edited_ = true;
}

// The plane that gives the present force here. The texture's part is dropped.
void ContactSets::freeze_fade(std::uint32_t p) noexcept {
    ContactState& contact = states_[p];
    const double force = contact.force.norm();
    double k = 0;
    for (const ContactSet* set : {&contact.now, &contact.old}) {
        for (std::uint32_t j = 0; j < set->layers; ++j) {  // only the pushing planes: the others may be far
                                                           // away
            if (!set->layer[j].solution.dx.isZero(0)) k = std::max(k, set->layer[j].stiffness);
        }
    }
    if (k == 0 && force > 0)
        k = std::min(world_stiffness(unlimited_stiffness, state_.limits),
                     state_.limits.max_stiffness);  // summed planes have no layer
    FrozenPlane& frozen_plane = contact.frozen_plane;
    frozen_plane.stiffness = force > 0 ? k : 0;
    if (frozen_plane.stiffness <= 0) return;
    frozen_plane.plane.normal = contact.force / force;
    const Eigen::Vector3d& at = contact.change.replaced ? state_.probes[p].probe.position : contact.position;
    frozen_plane.plane.offset = frozen_plane.plane.normal.dot(at) + force / k;
    TangentialState& tangential = contact.tangential;
    frozen_plane.law = tangential.law;
    if (tangential.relief == Eigen::Vector3d::Zero()) return;
    FrictionState& friction = tangential.friction;
    friction.released += tangential.relief;
    friction.released_per_newton = friction.released.norm() / force;
    friction.residual_time = residual_decay;
}

// Merges the accepted changes of this probe into one cross-fade. It starts from the active set or, where a
// fade was under way, from the plane that stands for it.
void ContactSets::begin_fade(std::uint32_t p, std::span<const std::uint32_t> renewed) noexcept {
    ContactState& contact = states_[p];
    const SetChange& change = contact.change;
    if (!change.edited || !(change.fades || change.interrupted)) return;
    CrossFade& fade = contact.fade;
    const double time = state_.settles ? 0 : change.fades ? change.time : fade.time;
    const bool overtaken = fade.under_way || change.interrupted;
    if (overtaken && time > 0) freeze_fade(p);
    fade.frozen = overtaken;
    fade.under_way = fade.fresh = time > 0;
    fade.elapsed = 0;
    fade.time = time;
    fade.number = fade.next_number();
    if (!fade.under_way) return;
    contact.old.held = contact.now.held;
    contact.old.held_by = contact.now.held_by;
    contact.old.led = contact.now.led;
    for (const std::uint32_t i : renewed) {
        SetSlot& slot = slots_[i];
        if (slot.old_in_fade == 0 && slot.old_surface_of == static_cast<std::int32_t>(p))
            slot.old_in_fade = fade.number;
        const Record& now = state_.records.current(i);
        if (state_.slots[i].active && kind_ops()[now.kind].surface && now.probe == p && !now.recovers)
            slot.new_in_fade = fade.number;
    }
}

// A plane that stood still, where another one stands now. The same order as in a copied set (reshape_sets),
// so that rounding is the same.
bool ContactSets::stands_in_for_old(std::uint32_t i, std::uint32_t p) const noexcept {
    const SetSlot& slot = slots_[i];
    const std::uint32_t fade = states_[p].fade.number;
    const Record& now = state_.records.current(i);
    return slot.new_in_fade == fade && slot.old_in_fade == fade &&
           slot.old_surface_of == static_cast<std::int32_t>(p) && state_.slots[i].active && now.probe == p &&
           now.stands && state_.records.old(i).stands;
}

// The owners of the fading set: changed surfaces by their old records, unchanged ones by their current
// records. Surfaces that recover by themselves are in both sets with their current record.
std::span<const Owner> ContactSets::list_old(std::uint32_t p) noexcept {
    CrossFade& fade = states_[p].fade;
    const Records& records = state_.records;
    fade.olds_left_out = false;
    std::uint32_t n = 0;
    const auto listed = [&] { return std::span<const Owner>(scratch_.data(), n); };
    if (!fade.under_way) return listed();
    if (fade.frozen) {
        if (states_[p].frozen_plane.stiffness > 0) scratch_[n++] = frozen_plane_owner;
        return listed();
    }
    for (const std::uint32_t i : olds_) {
        if (slots_[i].old_surface_of != static_cast<std::int32_t>(p) || stands_in_for_old(i, p)) continue;
        if (candidates_.any(p)) {
            const std::optional<Bound> ball = ball_now(records.old(i), state_.clock);
            if (ball && candidates_.passes_by(p, *ball, state_)) {
                fade.olds_left_out = true;
                continue;
            }
        }
        scratch_[n++] = records.owner(i, true);
    }
    const auto take = [&](std::uint32_t i) {
        if (slots_[i].new_in_fade != fade.number) scratch_[n++] = records.owner(i, false);
    };
    for (const std::uint32_t i : candidates_.always()) {
        if (stands_in_for_old(i, p)) {
            scratch_[n++] = records.owner(i, true);
        } else if (records.current(i).probe == p) {
            take(i);
        }
    }
    for (const std::uint32_t i : candidates_.of(p)) take(i);
    return listed();
}

void ContactSets::end_fade(std::uint32_t p) noexcept {
    ContactState& contact = states_[p];
    ContactSet& old = contact.old;
    old.slack = 0;
    old.count = old.summed = old.layers = old.moving_count = 0;
    CrossFade& fade = contact.fade;
    fade.under_way = fade.fresh = fade.frozen = false;
    contact.tangential.present = contact.now.has_tangential;
    contact.tangential.leave_anchor();
    if (!contact.empty()) return;
    used_ &= ~(1u << p);
    contact.release();
}

void ContactSets::forget_ended_olds() noexcept {
    std::erase_if(olds_, [this](std::uint32_t i) {
        SetSlot& slot = slots_[i];
        if (old_fades(slot)) return false;
        slot.old_surface_of = -1;
        slot.old_listed = false;
        return true;
    });
}

ContactSets::Starts ContactSets::starts_of_probe(std::uint32_t p) const noexcept {
    const ContactState& contact = states_[p];
    return {.now = starts_of(contact.now, contact, arena(), state_.clock),
            .old = starts_of(contact.old, contact, arena(), state_.clock)};
}

// The new set starts at its own solution. What begins to fade out continues from where it held the probe
// until now.
void ContactSets::take_starts_of_probe(std::uint32_t p, Arena& a, const Starts& starts) noexcept {
    ContactState& contact = states_[p];
    const bool begins = contact.change.edited && contact.fade.fresh;
    if (!contact.change.edited) take_starts(contact.now, a, starts.now);
    take_starts(contact.old, a, begins ? starts.now : starts.old);
}

void ContactState::release() noexcept {
    force.setZero();
    tangential.release();
}

}  // namespace knurl::detail
