// What changes a claim.

#include <knurl/link/clock.hpp>

#include "objects.hpp"

using namespace knurl;
using namespace knurl::capi;

namespace knurl::capi {

HandObject::HandObject(Claim claimed) : Object(its_type), claim_(std::move(claimed)) {}
HandObject::HandObject(Observer observer) : Object(its_type), observer_(std::move(observer)) {}

void HandObject::close() noexcept {
    grace_ns = -1;
    call(nullptr, [&]() -> int { return reader().release(), KNURL_OK; });
}

Claim& HandObject::claim() {
    if (!claim_)
        throw Failed(KNURL_REFUSED, "an observer changes nothing; knurl_claim gives a hand that may");
    return *claim_;
}

void HandObject::keep(const AnyHandle& added) {
    const std::lock_guard lock(mutex_);
    if (added_.size() <= added.id().slot) added_.resize(added.id().slot + std::size_t{1});
    added_[added.id().slot].emplace(added);
}

AnyHandle HandObject::named(knurl_id id) {
    claim();
    const RepresentationId wanted = from_c(id);
    const std::lock_guard lock(mutex_);
    if (wanted.slot >= added_.size() || !added_[wanted.slot] || added_[wanted.slot]->id() != wanted)
        throw Failed(KNURL_STALE, "this claim has no representation " + std::to_string(id) +
                                      "; it was removed, or is another's");
    return *added_[wanted.slot];
}

AnyHandle HandObject::named(knurl_id id, std::uint32_t kind) {
    layout_of(kind);
    AnyHandle found = named(id);
    if (found.kind() != kind)
        throw Failed(KNURL_BAD_ARGUMENT,
                     "the representation is a " + std::string(kinds()[found.kind()].name) +
                         ", and the parameters are those of a " + std::string(kinds()[kind].name));
    return found;
}

namespace {

template <class Body>
int with_claim(const knurl_hand* hand, Body&& body) noexcept {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        body(it.claim());
        return KNURL_OK;
    });
}

}  // namespace
}  // namespace knurl::capi

extern "C" {

void knurl_default_add_options(knurl_add_options* options) {
    if (options != nullptr) *options = default_add_options();
}

int knurl_add(knurl_hand* hand, uint32_t kind, const void* params, const knurl_add_options* options,
              knurl_id* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(out, "knurl_add: out");
        const Parameters given(kind, params);
        const AnyHandle added = it.claim().add_bytes(kind, given.bytes(), add_options_of(options));
        it.keep(added);
        *out = to_c(added.id());
        return KNURL_OK;
    });
}

int knurl_set(knurl_hand* hand, knurl_id id, uint32_t kind, const void* params) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        const Parameters given(kind, params);
        it.named(id, kind).set_bytes(given.bytes());
        return KNURL_OK;
    });
}

int knurl_get(knurl_hand* hand, knurl_id id, uint32_t kind, void* params) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        const Layout& layout = layout_of(kind);
        require_pointer(params, "knurl_get: params");
        require_size(params, layout.first_size, ~std::size_t{0}, "knurl_get: params");
        std::vector<std::byte> bytes(layout.defaults.size());
        it.named(id, kind).get_bytes(bytes);
        layout.write(bytes, params);
        return KNURL_OK;
    });
}

int knurl_remove(knurl_hand* hand, knurl_id id) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        it.named(id).remove();
        return KNURL_OK;
    });
}

int knurl_place_probe(knurl_hand* hand, uint32_t probe, const knurl_vec3* offset, double radius) {
    return with_claim(hand, [&](Claim& claim) {
        claim.place_probe(probe, {.offset = offset != nullptr ? from_c(*offset) : Vec3{}, .radius = radius});
    });
}

int knurl_begin_group(knurl_hand* hand) {
    return with_claim(hand, [](Claim& claim) { claim.begin_group(); });
}
int knurl_end_group(knurl_hand* hand) {
    return with_claim(hand, [](Claim& claim) { claim.end_group(); });
}
int knurl_cancel_group(knurl_hand* hand) {
    return with_claim(hand, [](Claim& claim) { claim.cancel_group(); });
}

int knurl_feedback_of(knurl_hand* hand, knurl_id id, knurl_feedback* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_feedback");
        const std::optional<HandFeedback> found = it.named(id).feedback();
        if (!found) return KNURL_NOTHING;
        write_struct(out, knurl_feedback{.size = 0,
                                         .force = to_c(found->force),
                                         .torque = to_c(found->torque),
                                         .contact_point = to_c(found->contact_point),
                                         .stiffness = found->stiffness,
                                         .tangential_stiffness = found->tangential_stiffness,
                                         .share = found->share,
                                         .damping_share = found->damping_share,
                                         .cycle = found->cycle,
                                         .flags = found->flags,
                                         .reserved = 0});
        return KNURL_OK;
    });
}

int knurl_applied_stiffness(knurl_hand* hand, knurl_id id, double* stiffness) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(stiffness, "knurl_applied_stiffness: stiffness");
        const std::optional<double> found = it.named(id).applied_stiffness();
        if (!found) return KNURL_NOTHING;
        *stiffness = *found;
        return KNURL_OK;
    });
}

int knurl_arm(knurl_hand* hand) {
    return with_claim(hand, [](Claim& claim) { claim.arm(); });
}
int knurl_disarm(knurl_hand* hand) {
    return with_claim(hand, [](Claim& claim) { claim.disarm(); });
}
int knurl_reset_fault(knurl_hand* hand) {
    return with_claim(hand, [](Claim& claim) { claim.reset_fault(); });
}

int knurl_commit(knurl_hand* hand, uint64_t* number) {
    return with_claim(hand, [&](Claim& claim) {
        const std::uint64_t committed = claim.commit();
        if (number != nullptr) *number = committed;
    });
}

int knurl_wait_applied(knurl_hand* hand, uint64_t number, int64_t timeout_ns) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        return it.claim().wait_applied(number, time_of(timeout_ns)) ? KNURL_OK : KNURL_NOTHING;
    });
}

int knurl_keep_alive(knurl_hand* hand, int64_t grace_ns) {
    return call(hand, [&]() -> int {
        const std::shared_ptr<HandObject> it = object<HandObject>(hand);
        it->claim();
        it->progress_ns = detail::monotonic_ns();
        it->grace_ns = grace_ns;
        if (grace_ns >= 0) keep_alive_from_now_on(it);
        return KNURL_OK;
    });
}

int knurl_progress(knurl_hand* hand) {
    return with<HandObject>(hand, [](HandObject& it) -> int {
        it.progress_ns = detail::monotonic_ns();
        return KNURL_OK;
    });
}

int knurl_limits_of(knurl_hand* hand, knurl_limits* out) {
    return with_claim(hand, [&](Claim& claim) {
        require_room(out, "knurl_limits");
        const Limits from = claim.limits();
        write_struct(out, knurl_limits{.size = 0,
                                       .max_stiffness = from.max_stiffness,
                                       .max_force = from.max_force,
                                       .max_torque = from.max_torque,
                                       .max_torsion = from.max_torsion,
                                       .damping = from.damping,
                                       .mass = from.mass,
                                       .lag = from.lag,
                                       .period = from.period,
                                       .resolution = from.resolution,
                                       .metre = from.metre,
                                       .newton = from.newton});
    });
}

int knurl_timing_of(knurl_hand* hand, knurl_timing* out) {
    return with_claim(hand, [&](Claim& claim) {
        require_room(out, "knurl_timing");
        const Timing from = claim.timing();
        write_struct(out, knurl_timing{.size = 0,
                                       .age_at_use_ns = from.age_at_use.count(),
                                       .interval_ns = from.interval.count(),
                                       .batches = from.batches,
                                       .refused = from.refused,
                                       .undersampled = from.undersampled});
    });
}

int knurl_predicted_position(knurl_hand* hand, knurl_vec3* out) {
    return with_claim(hand, [&](Claim& claim) {
        require_pointer(out, "knurl_predicted_position: out");
        *out = to_c(claim.predicted_position());
    });
}

int knurl_follow(knurl_hand* hand, knurl_id id, knurl_surface_model model, void* user, double step,
                 knurl_followed* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        if (model == nullptr)
            throw Failed(KNURL_BAD_ARGUMENT, "knurl_follow: model is NULL; give a function");
        if (out != nullptr) require_room(out, "knurl_followed");
        if (!(step >= 0 && step < 1e6))
            throw Failed(KNURL_BAD_PARAMETERS, "knurl_follow: step is no length; give metres, or 0");
        SurfaceModel nearest = [&](const Vec3& near) -> SurfacePoint {
            const knurl_vec3 at = to_c(near);
            knurl_surface_point found{};
            if (const int code = model(user, &at, &found); code != 0)
                throw Failed(KNURL_CALLBACK_FAILED,
                             "the surface model failed with " + std::to_string(code) + "; nothing was set");
            if (from_c(found.normal) == Vec3{})
                throw Failed(
                    KNURL_CALLBACK_FAILED,
                    "the surface model returned without a normal (normal is 0 0 0); nothing was set");
            return {.foot = from_c(found.foot),
                    .normal = from_c(found.normal),
                    .curvature = found.curvature,
                    .curvature2 = found.curvature2,
                    .axis = from_c(found.axis)};
        };
        if (step > 0) nearest = curved(std::move(nearest), step);
        const Followed followed = it.named(id).follow_model(nearest);
        if (out != nullptr)
            write_struct(out, knurl_followed{.size = 0,
                                             .faces = followed.faces.count,
                                             .asked = followed.asked,
                                             .look_ahead = followed.look_ahead,
                                             .trust = followed.trust,
                                             .kept_side = followed.kept_side ? 1u : 0u,
                                             .undersampled = followed.undersampled ? 1u : 0u});
        return KNURL_OK;
    });
}
}
