// Sending meshes and height fields.

#include "objects.hpp"
#include "shapes.hpp"

using namespace knurl;
using namespace knurl::capi;

namespace knurl::capi {

void SendingObject::close() noexcept {
    const std::lock_guard lock(mutex);
    sending.reset();  // calls it off, unless it was answered
}

namespace {

int begin(knurl_hand* hand, knurl_sending** out, auto&& start) noexcept {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(out, "the sending's address");
        auto object = std::make_shared<SendingObject>(start(it.claim()));
        object->parent = hand;
        *out = static_cast<knurl_sending*>(handles().add(std::move(object)));
        return KNURL_OK;
    });
}

int send(knurl_hand* hand, knurl_sent* out, auto&& start) noexcept {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_sent");
        Sending sending = start(it.claim());
        for (;;) {
            if (const std::optional<SentShape> sent = sending.done(slice)) {
                write_struct(out, sent_to_c(*sent));
                return KNURL_OK;
            }
            if (it.closed) throw Failed(KNURL_BAD_HANDLE, "the hand was closed by another thread meanwhile");
        }
    });
}

Sending start_mesh(Claim& claim, const knurl_mesh* mesh) {
    const GivenMesh given(mesh);
    return claim.begin_sending(given.triangles(), given.options());
}
Sending start_heights(Claim& claim, const knurl_heights* heights) {
    return claim.begin_sending(given_heights(heights));
}

}  // namespace
}  // namespace knurl::capi

extern "C" {

int knurl_send_mesh(knurl_hand* hand, const knurl_mesh* mesh, knurl_sent* out) {
    return send(hand, out, [&](Claim& claim) { return start_mesh(claim, mesh); });
}

int knurl_send_heights(knurl_hand* hand, const knurl_heights* heights, knurl_sent* out) {
    return send(hand, out, [&](Claim& claim) { return start_heights(claim, heights); });
}

int knurl_begin_sending_mesh(knurl_hand* hand, const knurl_mesh* mesh, knurl_sending** out) {
    return begin(hand, out, [&](Claim& claim) { return start_mesh(claim, mesh); });
}

int knurl_begin_sending_heights(knurl_hand* hand, const knurl_heights* heights, knurl_sending** out) {
    return begin(hand, out, [&](Claim& claim) { return start_heights(claim, heights); });
}

int knurl_sending_done(knurl_sending* sending, int64_t wait_ns, knurl_sent* out) {
    const auto until = std::chrono::steady_clock::now() + std::min(time_of(wait_ns), longest_wait);
    const int code = with<SendingObject>(sending, [&](SendingObject& it) -> int {
        require_room(out, "knurl_sent");
        for (;;) {
            const auto left = until - std::chrono::steady_clock::now();
            const std::lock_guard lock(it.mutex);
            // Who closes it waits for the lock, which is not fair.
            if (!it.sending || it.closed)
                throw Failed(KNURL_BAD_HANDLE, "the sending was closed by another thread meanwhile");
            const std::chrono::nanoseconds wait = std::clamp<std::chrono::nanoseconds>(left, {}, slice);
            if (const std::optional<SentShape> sent = it.sending->done(wait)) {
                write_struct(out, sent_to_c(*sent));
                return KNURL_OK;
            }
            if (left <= wait) return KNURL_NOTHING;
        }
    });
    // A shape that was refused has had its answer too; a mistake in the call is none.
    if (code == KNURL_OK || (code < 0 && code != KNURL_BAD_ARGUMENT && code != KNURL_BAD_HANDLE))
        call(nullptr, [&]() -> int { return handles().take(sending), KNURL_OK; });
    return code;
}

int knurl_sending_fd(knurl_sending* sending, int* fd) {
    return with<SendingObject>(sending, [&](SendingObject& it) -> int {
        require_pointer(fd, "knurl_sending_fd: fd");
        const std::lock_guard lock(it.mutex);
        if (!it.sending) throw Failed(KNURL_BAD_HANDLE, "the sending was closed by another thread meanwhile");
        *fd = it.sending->fd();
        return KNURL_OK;
    });
}

int knurl_forget(knurl_hand* hand, uint32_t asset) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        it.claim().forget(asset);
        return KNURL_OK;
    });
}
}
