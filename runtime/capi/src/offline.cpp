// The functions of knurl_offline.h.

#include "offline_object.hpp"

namespace knurl::capi {

namespace {

template <class Body>
int with_servo(knurl_offline* handle, Body&& body) noexcept {
    return with<OfflineObject>(handle, [&](OfflineObject& it) -> int {
        const std::lock_guard lock(it.mutex);
        return body(it);
    });
}

int send(knurl_offline* handle, knurl_sent* out, auto&& source) noexcept {
    return with_servo(handle, [&](OfflineObject& it) -> int {
        require_room(out, "knurl_sent");
        SentShape sent;
        it.give(source(), sent);
        write_struct(out, sent_to_c(sent));
        return KNURL_OK;
    });
}

}  // namespace
}  // namespace knurl::capi

using namespace knurl;
using namespace knurl::capi;

extern "C" {

void knurl_offline_default_options(knurl_offline_options* options) {
    if (options != nullptr)
        *options = {.size = sizeof *options, .rate = 1000, .representations = 128, .reserved = 0};
}

int knurl_offline_open(const char* device, const knurl_offline_options* options, knurl_offline** out) {
    return call(nullptr, [&]() -> int {
        require_pointer(out, "knurl_offline_open: out");
        knurl_offline_options defaults;
        knurl_offline_default_options(&defaults);
        auto opened = std::make_shared<OfflineObject>(
            device != nullptr ? device : "", read_struct(options, defaults, "knurl_offline_options"));
        *out = static_cast<knurl_offline*>(handles().add(std::move(opened)));
        return KNURL_OK;
    });
}

int knurl_offline_close(knurl_offline* servo) {
    return call(servo, [&]() -> int {
        handles().take(servo);
        return KNURL_OK;
    });
}

const char* knurl_offline_error(void) {
    return last_line();
}

int knurl_offline_add(knurl_offline* servo, uint32_t kind, const void* params,
                      const knurl_add_options* options, knurl_id* out) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        require_pointer(out, "knurl_offline_add: out");
        const Parameters given(kind, params);
        *out = it.add(kind, given.bytes(), add_options_of(options));
        return KNURL_OK;
    });
}

int knurl_offline_set(knurl_offline* servo, knurl_id id, uint32_t kind, const void* params) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        const Parameters given(kind, params);
        it.set(id, kind, given.bytes());
        return KNURL_OK;
    });
}

int knurl_offline_remove(knurl_offline* servo, knurl_id id) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        it.remove(id);
        return KNURL_OK;
    });
}

int knurl_offline_place_probe(knurl_offline* servo, uint32_t probe, const knurl_vec3* offset, double radius) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        const Vec3 at = offset != nullptr ? Vec3{offset->x, offset->y, offset->z} : Vec3{};
        it.place_probe(probe, {.offset = at, .radius = radius});
        return KNURL_OK;
    });
}

int knurl_offline_send_mesh(knurl_offline* servo, const knurl_mesh* mesh, knurl_sent* out) {
    return send(servo, out, [&] {
        const GivenMesh given(mesh);
        return detail::source_of(given.triangles(), given.options());
    });
}

int knurl_offline_send_heights(knurl_offline* servo, const knurl_heights* heights, knurl_sent* out) {
    return send(servo, out, [&] { return detail::source_of(given_heights(heights)); });
}

int knurl_offline_step(knurl_offline* servo, const knurl_pose* pose, knurl_cycle* out) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        if (out != nullptr) require_room(out, "knurl_cycle");
        knurl_cycle cycle;
        it.step(pose, cycle);
        if (out != nullptr) write_struct(out, cycle);
        return KNURL_OK;
    });
}

int knurl_offline_run(knurl_offline* servo, const knurl_pose* poses, size_t count, knurl_cycle* out) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        if (count == 0) return KNURL_OK;
        require_room(out, "knurl_cycle");
        const std::uint64_t stride = out->size;
        auto* to = reinterpret_cast<std::byte*>(out);
        for (std::size_t i = 0; i < count; ++i, to += stride) {
            knurl_cycle cycle;
            it.step(poses != nullptr ? poses + i : nullptr, cycle);
            cycle.size = stride;
            std::memcpy(to, &cycle, std::min<std::size_t>(stride, sizeof cycle));
        }
        return KNURL_OK;
    });
}

int knurl_offline_feedback_of(knurl_offline* servo, knurl_id id, knurl_feedback* out) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        require_room(out, "knurl_feedback");
        const std::optional<knurl_feedback> found = it.feedback(id);
        if (!found) return KNURL_NOTHING;
        write_struct(out, *found);
        return KNURL_OK;
    });
}

int knurl_offline_reset(knurl_offline* servo) {
    return with_servo(servo, [&](OfflineObject& it) -> int {
        it.begin();
        return KNURL_OK;
    });
}
}
