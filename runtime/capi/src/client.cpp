// Connecting, devices, claims.

#include <knurl/protocol/attach.hpp>

#include "objects.hpp"

using namespace knurl;
using namespace knurl::capi;

namespace {

knurl_device to_c(const DeviceDescription& from) {
    knurl_device to{};
    copy_text(to.name, from.name);
    copy_text(to.address, from.address);
    copy_text(to.profile, from.profile);
    copy_text(to.serial, from.serial);
    to.rate = from.rate;
    to.workspace_centre = capi::to_c(from.workspace_centre);
    to.workspace_radius = from.workspace_radius;
    to.peak_force = from.peak_force;
    to.peak_torque = from.peak_torque;
    to.max_stiffness = from.max_stiffness;
    to.renders_torque = from.renders_torque ? 1 : 0;
    to.senses_orientation = from.senses_orientation ? 1 : 0;
    return to;
}

template <class T>
void give(T** out, std::shared_ptr<Object> object, const void* parent) {
    object->parent = parent;
    *out = static_cast<T*>(handles().add(std::move(object)));
}

}  // namespace

extern "C" {

const char* knurl_version(void) {
    return capi::version;
}

const char* knurl_error(const void* handle) {
    return handle == nullptr ? last_line() : line_of(handle);
}

int32_t knurl_holder(void) {
    return last_holder();
}

uint64_t knurl_layout(void) {
    static const std::uint64_t of_this_build = protocol::wire_hash();
    return of_this_build;
}

int knurl_close(void* handle) {
    return call(handle, [&]() -> int {
        // Children first: they use what the parent has.
        std::vector<std::shared_ptr<Object>> taken = handles().take(handle);
        for (auto each = taken.rbegin(); each != taken.rend(); ++each) (*each)->close();
        return KNURL_OK;
    });
}

void knurl_default_connect_options(knurl_connect_options* options) {
    if (options == nullptr) return;
    const ConnectOptions usual;
    *options = {.size = sizeof *options,
                .name = nullptr,
                .wait_ns = std::chrono::nanoseconds(usual.wait).count(),
                .reattach = usual.reattach ? 1u : 0u,
                .hints = 0,
                .report_rate = usual.report_rate,
                .key_file = nullptr};
}

void knurl_default_claim_options(knurl_claim_options* options) {
    if (options == nullptr) return;
    const ClaimOptions usual;
    *options = {.size = sizeof *options,
                .shared = usual.shared ? 1u : 0u,
                .representations = usual.representations,
                .workspace_radius = usual.workspace_radius,
                .workspace_centre = capi::to_c(usual.workspace_centre),
                .update_interval_ns = usual.update_interval.count()};
}

int knurl_connect(const char* address, const knurl_connect_options* options, knurl_client** out) {
    return call(nullptr, [&]() -> int {
        require_pointer(out, "knurl_connect: out");
        knurl_connect_options defaults;
        knurl_default_connect_options(&defaults);
        const knurl_connect_options given = read_struct(options, defaults, "knurl_connect_options");
        Client client = Client::connect(text_or(address, "knurl:default"),
                                        {.name = text_or(given.name, ""),
                                         .wait = std::chrono::duration_cast<std::chrono::milliseconds>(
                                             std::min(time_of(given.wait_ns), longest_wait)),
                                         .reattach = given.reattach != 0,
                                         .hints = given.hints != 0,
                                         .report_rate = given.report_rate,
                                         .key_file = text_or(given.key_file, "")});
        give(out, std::make_shared<ClientObject>(std::move(client)), nullptr);
        return KNURL_OK;
    });
}

int knurl_connected(const void* handle, uint32_t* connected) {
    return call(handle, [&]() -> int {
        require_pointer(connected, "knurl_connected: connected");
        const std::shared_ptr<Object> found = handles().find(handle);
        if (found->type == Type::client)
            *connected = static_cast<ClientObject&>(*found).client.connected() ? 1 : 0;
        else
            *connected = object<HandObject>(handle)->reader().connected() ? 1 : 0;
        return KNURL_OK;
    });
}

int knurl_servo_pid(const knurl_client* client, int32_t* pid) {
    return with<ClientObject>(client, [&](ClientObject& it) -> int {
        require_pointer(pid, "knurl_servo_pid: pid");
        *pid = it.client.servo_pid();
        return KNURL_OK;
    });
}

int knurl_device_at(const knurl_client* client, uint32_t index, knurl_device* out) {
    return with<ClientObject>(client, [&](ClientObject& it) -> int {
        require_room(out, "knurl_device");
        const std::vector<DeviceDescription> devices = it.client.devices();
        if (index >= devices.size()) return KNURL_NOTHING;
        write_struct(out, to_c(devices[index]));
        return KNURL_OK;
    });
}

int knurl_reset_fault_of(knurl_client* client, const char* device) {
    return with<ClientObject>(client, [&](ClientObject& it) -> int {
        it.client.reset_fault(text_or(device, ""));
        return KNURL_OK;
    });
}

int knurl_claim(knurl_client* client, const char* device, const knurl_claim_options* options,
                knurl_hand** out) {
    return with<ClientObject>(client, [&](ClientObject& it) -> int {
        require_pointer(out, "knurl_claim: out");
        knurl_claim_options defaults;
        knurl_default_claim_options(&defaults);
        const knurl_claim_options given = read_struct(options, defaults, "knurl_claim_options");
        Claim claim = it.client.claim(text_or(device, ""),
                                      {.shared = given.shared != 0,
                                       .workspace_radius = given.workspace_radius,
                                       .workspace_centre = from_c(given.workspace_centre),
                                       .update_interval = std::chrono::nanoseconds(given.update_interval_ns),
                                       .representations = given.representations});
        give(out, std::make_shared<HandObject>(std::move(claim)), client);
        return KNURL_OK;
    });
}

int knurl_observe(knurl_client* client, const char* device, knurl_hand** out) {
    return with<ClientObject>(client, [&](ClientObject& it) -> int {
        require_pointer(out, "knurl_observe: out");
        give(out, std::make_shared<HandObject>(it.client.observe(text_or(device, ""))), client);
        return KNURL_OK;
    });
}

int knurl_device_of(const knurl_hand* hand, knurl_device* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_device");
        write_struct(out, to_c(it.reader().device()));
        return KNURL_OK;
    });
}
}
