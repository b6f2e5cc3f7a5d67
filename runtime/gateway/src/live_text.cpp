#include "live_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include <knurl/protocol/report_names.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/reps/all.hpp>

namespace knurl::gateway {

namespace {

using protocol::text_of;

Json vector_json(const Vec3& v) {
    return Json::array({number_json(v.x), number_json(v.y), number_json(v.z)});
}

/// Enough for what is drawn: 0.1 um, 0.1 mN.
void append(std::string& text, const Vec3& v) {
    fmt::format_to(std::back_inserter(text), "[{:.7g},{:.7g},{:.7g}]", v.x, v.y, v.z);
}

bool finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void append(std::string& text, std::string_view key, const Vec3& v) {
    fmt::format_to(std::back_inserter(text), ",\"{}\":", key);
    append(text, finite(v) ? v : Vec3{});
}

template <class Names>
void append_names(std::string& text, std::string_view key, const Names& names, std::uint32_t bits) {
    fmt::format_to(std::back_inserter(text), ",\"{}\":[", key);
    bool first = true;
    for (const protocol::ReportName& name : names) {
        if ((bits & name.value) == 0) continue;
        fmt::format_to(std::back_inserter(text), "{}\"{}\"", first ? "" : ",", name.name);
        first = false;
    }
    text += ']';
}

std::string_view state_of(DeviceState state) {
    const auto i = static_cast<std::size_t>(state);
    return i < protocol::state_names.size() ? protocol::state_names[i].name : "?";
}

std::string_view type_name(Field::Type type) {
    switch (type) {
        case Field::Type::real:
            return "real";
        case Field::Type::vector:
            return "vector";
        case Field::Type::choice:
            return "choice";
        case Field::Type::integer:
            return "integer";
        case Field::Type::quaternion:
            return "quaternion";
        case Field::Type::matrix:
            return "matrix";
        case Field::Type::points:
            return "points";
    }
    return "?";
}

template <class... R>
Json defaults_json(Kind kind, TypeList<R...>) {
    Json defaults;
    const auto take = [&]<class T>(T params) {
        if (kind == kind_of<T>) defaults = params_json(kind, std::as_bytes(std::span(&params, 1)));
    };
    (take(R{}), ...);
    return defaults;
}

Json kind_json(Kind kind) {
    const KindInfo& info = kinds()[kind];
    const Json defaults = defaults_json(kind, Representations{});
    Json fields = Json::array();
    for (const Field& field : info.fields) {
        Json row = {{"name", std::string(field.name)},
                    {"type", std::string(type_name(field.type))},
                    {"unit", std::string(field.unit)},
                    {"meaning", std::string(field.meaning)},
                    {"default", defaults.at(field.name)}};
        if (std::isfinite(field.minimum)) row["minimum"] = field.minimum;
        if (std::isfinite(field.maximum)) row["maximum"] = field.maximum;
        if (field.infinity_allowed) row["infinity"] = true;
        if (field.automatic_allowed) row["automatic"] = true;
        if (field.count > 0) row["count"] = field.count;
        if (!field.choices.empty()) {
            Json choices = Json::array();
            for (const std::string_view choice : field.choices) choices.push_back(std::string(choice));
            row["choices"] = std::move(choices);
        }
        fields.push_back(std::move(row));
    }
    return {{"name", std::string(info.name)}, {"surface", info.surface}, {"fields", std::move(fields)}};
}

Json client_json(const view::ClientRates& rates) {
    const view::ClientView& client = rates.client;
    Json present = Json::object();
    for (std::size_t kind = 0; kind < client.present.size() && kind < kinds().size(); ++kind)
        if (client.present[kind] > 0) present[std::string(kinds()[kind].name)] = client.present[kind];
    return {{"row", client.row},
            {"pid", client.pid},
            {"name", client.name},
            {"observer", client.observer},
            {"armed", client.armed},
            {"silent", client.silent},
            {"shed", client.shed},
            {"gain", client.gain},
            {"rate", rates.updates},
            {"age", client.age},
            {"commits", client.commits},
            {"refused", client.refused},
            {"merged", client.merged},
            {"missed", client.missed},
            {"representations", std::move(present)},
            {"scales",
             {{"contacts", client.scales.contacts},
              {"effects", client.scales.effects},
              {"damping", client.scales.damping}}}};
}

const view::ClientView* client_in(const SeenDevice& seen, std::uint32_t row) {
    for (const view::ClientView& client : seen.rates.device.clients)
        if (client.row == row) return &client;
    return nullptr;
}

Json claim_json(const SeenClaim& claim, const SeenDevice& seen, bool mine) {
    Json probes = Json::array();
    for (const auto& [number, placement] : claim.probes)
        probes.push_back(Json::array({number, vector_json(placement.offset), placement.radius}));
    const view::ClientView* client = client_in(seen, claim.row);
    return {{"claim", claim.number},
            {"row", claim.row},
            {"pid", client == nullptr ? 0 : client->pid},
            {"name", client == nullptr ? std::string() : client->name},
            {"mine", mine},
            {"frame",
             {{"scale", claim.frame.scale},
              {"device_centre", vector_json(claim.frame.device_centre)},
              {"world_centre", vector_json(claim.frame.world_centre)},
              {"force_scale", claim.frame.force_scale}}},
            {"probes", std::move(probes)}};
}

}  // namespace

std::string_view name_of(Role role) noexcept {
    return role == Role::control ? "control" : role == Role::render ? "render" : "observe";
}

Json kinds_json() {
    Json all = Json::array();
    for (Kind kind = 0; kind < kinds().size(); ++kind) all.push_back(kind_json(kind));
    return all;
}

std::string servo_text(const LiveView& view, const std::vector<bool>& can_pull) {
    Json devices = Json::array();
    std::size_t i = 0;
    for (const SeenDevice& seen : view.devices()) {
        const protocol::DeviceInfo& info = seen.info;
        devices.push_back({{"i", i},
                           {"name", text_of(info.name)},
                           {"address", text_of(info.address)},
                           {"profile", text_of(info.profile)},
                           {"serial", text_of(info.serial)},
                           {"rate", info.rate},
                           {"centre", vector_json(info.workspace_centre)},
                           {"radius", info.workspace_radius},
                           {"peak_force", info.peak_force},
                           {"peak_torque", info.peak_torque},
                           {"max_stiffness", info.max_stiffness},
                           {"damping", info.damping},
                           {"lag", info.lag},
                           {"renders_torque", info.renders_torque != 0},
                           {"senses_orientation", info.senses_orientation != 0},
                           {"pull", i < can_pull.size() && can_pull[i]}});
        ++i;
    }
    const Json servo = {
        {"op", "servo"},     {"connected", view.connected()}, {"name", view.name()},
        {"pid", view.pid()}, {"trouble", view.trouble()},     {"devices", std::move(devices)}};
    return servo.dump();
}

// 60 times a second for each servo: written as text directly, in a fifth of the time.
std::string frame_text(std::span<const SeenDevice> devices) {
    std::string text;
    text.reserve(1024 * devices.size());
    std::int64_t newest = 0;
    for (const SeenDevice& seen : devices)
        if (seen.newest) newest = std::max(newest, seen.newest->read_ns);
    auto out = std::back_inserter(text);
    fmt::format_to(out, "{{\"op\":\"frame\",\"t\":{:.6f},\"devices\":[", static_cast<double>(newest) * 1e-9);
    bool first = true;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const SeenDevice& seen = devices[i];
        if (!seen.newest) continue;
        const Report& r = *seen.newest;
        fmt::format_to(out, "{}{{\"i\":{},\"cycle\":{},\"t\":{:.6f},\"state\":\"{}\"", first ? "" : ",", i,
                       r.cycle, static_cast<double>(r.read_ns) * 1e-9, state_of(r.state));
        first = false;
        append_names(text, "faults", protocol::fault_names, r.faults);
        append(text, "p", r.position);
        const Quat& q = r.orientation;
        fmt::format_to(out, ",\"q\":[{:.6g},{:.6g},{:.6g},{:.6g}]", q.w, q.x, q.y, q.z);
        append(text, "v", r.velocity);
        append(text, "w", r.angular_velocity);
        append(text, "scene_force", r.scene_force);
        append(text, "force", r.sent_force);
        append(text, "torque", r.sent_torque);
        append(text, "contact", r.contact_point);
        fmt::format_to(out, ",\"buttons\":{}", r.buttons);
        append_names(text, "flags", protocol::flag_names, r.flags);
        fmt::format_to(out, ",\"late\":{},\"gap\":{},\"arm\":[", r.late_count, seen.missed);
        for (std::size_t p = 0; p < seen.arm.size(); ++p) {
            if (p > 0) text += ',';
            append(text, seen.arm[p]);
        }
        text += "]}";
    }
    text += "]}";
    return text;
}

std::vector<std::byte> samples_of(std::uint32_t device, const SeenDevice& seen) {
    if (seen.fresh.empty()) return {};
    constexpr std::size_t columns = 14, head = 4 * sizeof(std::uint32_t) + sizeof(double);
    const auto count = static_cast<std::uint32_t>(seen.fresh.size());
    std::vector<std::byte> bytes(head + count * columns * sizeof(float));
    const std::uint32_t numbers[] = {1, device, count, 0};
    const double begin = static_cast<double>(seen.fresh.front().read_ns) * 1e-9;
    std::memcpy(bytes.data(), numbers, sizeof numbers);
    std::memcpy(bytes.data() + sizeof numbers, &begin, sizeof begin);
    std::byte* to = bytes.data() + head;
    for (const Report& r : seen.fresh) {
        const double force = std::hypot(r.scene_force.x, r.scene_force.y, r.scene_force.z);
        const double row[columns] = {static_cast<double>(r.read_ns - seen.fresh.front().read_ns) * 1e-9,
                                     r.position.x,
                                     r.position.y,
                                     r.position.z,
                                     r.velocity.x,
                                     r.velocity.y,
                                     r.velocity.z,
                                     r.sent_force.x,
                                     r.sent_force.y,
                                     r.sent_force.z,
                                     static_cast<double>(r.read_ns - r.deadline_ns) * 1e-3,
                                     static_cast<double>(r.write_ns - r.deadline_ns) * 1e-3,
                                     force,
                                     static_cast<double>(r.state)};
        for (const double value : row) {
            const auto single = static_cast<float>(value);
            std::memcpy(to, &single, sizeof single);
            to += sizeof single;
        }
    }
    return bytes;
}

std::string status_text(std::span<const SeenDevice> devices,
                        const std::map<std::size_t, std::string>& recordings) {
    Json all = Json::array();
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const view::DeviceRates& rates = devices[i].rates;
        Json parts = Json::object(), counters = Json::object(), clients = Json::array();
        if (rates.parts)
            for (std::size_t p = 0; p < view::cycle_parts.size(); ++p)
                parts[std::string(view::cycle_parts[p])] = (*rates.parts)[p];
        for (const auto& [name, value] : rates.device.counters) counters[name] = value;
        for (const view::ClientRates& client : rates.clients) clients.push_back(client_json(client));
        const auto recording = recordings.find(i);
        all.push_back({{"i", i},
                       {"recording", recording == recordings.end() ? Json() : Json(recording->second)},
                       {"rate", rates.rate},
                       {"late", rates.late},
                       {"overruns", rates.overruns},
                       {"busy", rates.busy},
                       {"step", rates.step},
                       {"parts", std::move(parts)},
                       {"late_median", rates.late_median ? Json(*rates.late_median) : Json()},
                       {"late_max", rates.late_max ? Json(*rates.late_max) : Json()},
                       {"counters", std::move(counters)},
                       {"clients", std::move(clients)}});
    }
    const Json status = {{"op", "status"}, {"devices", std::move(all)}};
    return status.dump();
}

std::string scene_text(std::uint32_t device, const SeenDevice& seen, std::uint64_t since,
                       const std::set<std::uint64_t>& mine) {
    Json claims = Json::array(), items = Json::array(), gone = Json::array();
    if (since > 0) {
        for (const SeenDevice::Gone& one : seen.gone) {
            if (one.version <= since) continue;
            Json entry = Json::array({one.claim});
            if (one.slot) entry.push_back(*one.slot);
            gone.push_back(std::move(entry));
        }
    }
    for (const auto& [number, claim] : seen.claims) {
        claims.push_back(claim_json(claim, seen, mine.contains(number)));
        for (const auto& [slot, item] : claim.items) {
            if (item.version <= since) continue;
            items.push_back({{"claim", number},
                             {"slot", slot},
                             {"generation", item.id.generation},
                             {"kind", std::string(kinds()[item.kind].name)},
                             {"params", params_json(item.kind, item.params)},
                             {"probe", item.options.probe}});
        }
    }
    const Json scene = {{"op", "scene"},
                        {"device", device},
                        {"full", since == 0},
                        {"claims", std::move(claims)},
                        {"items", std::move(items)},
                        {"gone", std::move(gone)}};
    return scene.dump();
}

std::string mesh_bytes(const SeenAsset& mesh) {
    const std::uint32_t counts[] = {static_cast<std::uint32_t>(mesh.vertices.size() / 3),
                                    static_cast<std::uint32_t>(mesh.triangles.size() / 3)};
    const auto bytes = [](const auto& values) {
        return std::string_view(reinterpret_cast<const char*>(std::data(values)),
                                sizeof(values[0]) * std::size(values));
    };
    std::string text(bytes(counts));
    text += bytes(mesh.vertices);
    text += bytes(mesh.triangles);
    return text;
}

std::string felt_text(std::uint32_t device, const SeenDevice& seen, bool& before) {
    std::string items;
    constexpr std::uint32_t asleep = 32;
    auto out = std::back_inserter(items);
    for (const auto& [number, claim] : seen.claims) {
        const view::ClientView* client = client_in(seen, claim.row);
        const std::uint32_t of_all =
            (claim.asleep ? asleep : 0) | (client != nullptr && client->silent ? Feedback::silent : 0);
        for (const auto& [slot, item] : claim.items) {
            const std::uint32_t flags = item.feedback.flags | of_all;
            if (flags == 0) continue;
            const Vec3 &f = item.feedback.force, &c = item.feedback.contact;
            fmt::format_to(out, "{}[{},{},{},{:.6g},{:.6g},{:.6g},{:.7g},{:.7g},{:.7g}]",
                           items.empty() ? "" : ",", number, slot, flags, f.x, f.y, f.z, c.x, c.y, c.z);
        }
    }
    const bool something = !items.empty();
    if (!std::exchange(before, something) && !something) return {};
    return fmt::format("{{\"op\":\"felt\",\"device\":{},\"items\":[{}]}}", device, items);
}

}  // namespace knurl::gateway
