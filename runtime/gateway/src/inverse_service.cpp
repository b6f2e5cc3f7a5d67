#include "inverse_service.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include <knurl/protocol/report_names.hpp>
#include <knurl/words/printable.hpp>

#include "inverse_session.hpp"

namespace knurl::gateway {

namespace {

constexpr std::size_t longest_body = 4096;  // bytes

/// What is wrong with a request.
struct HttpMistake {
    unsigned status;
    std::string text;
};

std::string faults_in_words(std::uint32_t faults) {
    std::string text;
    for (const auto& name : protocol::fault_names)
        if (faults & name.value) text += (text.empty() ? "" : ", ") + std::string(name.name);
    return text;
}

InverseReply failed(unsigned status, const std::string& text) {
    Json body = Json::object();
    body["ok"] = false;
    body["error"] = words::printable(text, 500);
    return {.status = status, .body = body.dump()};
}

InverseReply done(const Json& data) {
    Json body = Json::object();
    body["ok"] = true;
    body["data"] = data;
    return {.status = 200, .body = body.dump()};
}

std::vector<std::string> parts_of(std::string_view path) {
    std::vector<std::string> parts;
    while (!path.empty()) {
        const auto end = std::min(path.find('/'), path.size());
        if (end > 0) parts.emplace_back(path.substr(0, end));
        path.remove_prefix(std::min(end + 1, path.size()));
    }
    return parts;
}

std::optional<long> number_in(std::string_view text) {
    long number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    if (text.empty() || read.ec != std::errc{} || read.ptr != text.data() + text.size()) return std::nullopt;
    return number;
}

/// ":0" the first, ":-1" the last, "#7" or "7" that of this number.
InverseSession& session_of(const std::map<std::uint64_t, InverseSession*>& sessions,
                           std::string_view selector) {
    const bool by_index = selector.starts_with(':');
    const auto number = number_in(by_index || selector.starts_with('#') ? selector.substr(1) : selector);
    if (!number)
        throw HttpMistake{400, fmt::format("session '{}' names none; write :0, :-1 or #7", selector)};
    if (by_index) {
        const long count = static_cast<long>(sessions.size());
        const long index = *number < 0 ? count + *number : *number;
        if (index >= 0 && index < count) return *std::next(sessions.begin(), index)->second;
    } else if (const auto found = sessions.find(static_cast<std::uint64_t>(*number));
               found != sessions.end()) {
        return *found->second;
    }
    throw HttpMistake{404, fmt::format("there is no session '{}'; {} are open", selector, sessions.size())};
}

std::vector<const InverseDevice*> devices_of(std::span<const InverseDevice> all, std::string_view selector) {
    std::vector<const InverseDevice*> found;
    const auto index = number_in(selector);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (selector == "*" || selector == all[i].id ||
            (index && selector.size() < 4 && static_cast<std::size_t>(*index) == i))
            found.push_back(&all[i]);
    if (found.empty())
        throw HttpMistake{404, fmt::format("there is no inverse3 '{}'; GET /devices lists them", selector)};
    return found;
}

bool flag_of(const Json& body, const char* key) {
    if (!body.is_object() || !body.contains(key) || !body.at(key).is_boolean())
        throw HttpMistake{400, fmt::format("the body must have {0}; write {{\"{0}\": true}}", key)};
    return body.at(key).get<bool>();
}

/// A member of what a POST states; null: it has none.
Json stated_in(const Json& given, const char* key) {
    return given.is_object() ? given.value(key, nullptr) : Json();
}

/// What a POST states.
Json body_of(const InverseRequest& request) {
    if (request.role == Role::observe) throw HttpMistake{403, "this caller may look only"};
    if (request.body.size() > longest_body)
        throw HttpMistake{413, fmt::format("the body is longer than {} bytes", longest_body)};
    try {
        return Json::parse(request.body);
    } catch (const JsonError& error) {
        throw HttpMistake{400, error.what()};
    }
}

}  // namespace

InverseService::InverseService(InverseOptions options)
    : options_(std::move(options)), source_(std::move(options_.source)) {}

void InverseService::look() {
    source_->look(now());
    for (const InverseDevice& device : devices()) {
        Json data = Json::object();
        data["device_family"] = "inverse";
        data["device_id"] = device.id;
        data["device_name"] = device.info.name;
        tell_of_connection(device, data);
        if (device.report) tell_of_faults(device, data);
    }
}

void InverseService::tell_of_connection(const InverseDevice& device, const Json& data) {
    const auto [was, fresh] = was_connected_.try_emplace(device.id, false);
    if (std::exchange(was->second, device.connected) == device.connected) return;
    publish({.name = device.connected ? "device-connected" : "device-disconnected",
             .category = "device",
             .level = device.connected ? "info" : "warning",
             .data = data,
             .message = device.connected
                            ? fmt::format("device '{}' is there", device.info.name)
                            : fmt::format("the servo of device '{}' has gone", device.info.name)});
}

void InverseService::tell_of_faults(const InverseDevice& device, Json data) {
    const std::uint32_t faults = device.report->state == DeviceState::fault ? device.report->faults : 0;
    if (std::exchange(was_fault_[device.id], faults) == faults) return;
    data["safety_type"] = faults != 0 ? "ebrake_triggered" : "ebrake_released";
    if (faults != 0) data["faults"] = faults_in_words(faults);
    publish({.name = "device-safety-triggered",
             .category = "device",
             .level = faults != 0 ? "error" : "notice",
             .data = data,
             .message = faults != 0
                            ? fmt::format("device '{}' is in fault ({}): no force until somebody resets it "
                                          "(`knurl reset`)",
                                          device.info.name, faults_in_words(faults))
                            : fmt::format("device '{}' is out of its fault", device.info.name)});
}

const InverseDevice* InverseService::find(std::string_view id) const {
    const auto all = devices();
    const auto found =
        std::ranges::find_if(all, [&](const InverseDevice& device) { return device.id == id; });
    return found == all.end() ? nullptr : &*found;
}

bool InverseService::claimable(const InverseDevice& device) const {
    if (!options_.claimable) return device.info.address.starts_with("sim:");
    return std::ranges::find(*options_.claimable, device.info.name) != options_.claimable->end();
}

std::unique_ptr<PeerCommands> InverseService::make_hand(const InverseDevice& device, const std::string& peer,
                                                        Role role) const {
    PeerOptions options{.servo = options_.servo,
                        .device = device.info.name,
                        .peer = words::printable("inverse " + peer, 50),
                        .may_arm = role == Role::control,
                        .lapse = options_.lapse};
    options.clock = options_.clock;
    return options_.make_hand(std::move(options));
}

std::string InverseService::handedness(const std::string& id) const {
    const auto found = handedness_.find(id);
    return found == handedness_.end() ? "right" : found->second;
}

void InverseService::publish(const InverseEvent& event) {
    options_.log(fmt::format("inverse: {}", event.message));
    if (listeners_.empty()) return;
    Json json = Json::object();
    json["name"] = event.name;
    json["category"] = event.category;
    json["level"] = event.level;
    json["data"] = event.data;
    json["message"] = event.message;
    const std::string text = json.dump();
    // A copy: who does not read is closed by this, and may be gone from the list before the next one.
    for (Socket* const socket : std::set<Socket*>(listeners_))
        if (listeners_.contains(socket)) socket->send_text(text);
}

std::uint64_t InverseService::begin_session(InverseSession& session) {
    sessions_[++last_session_] = &session;
    return last_session_;
}

InverseReply InverseService::http(const InverseRequest& request) {
    look();
    const auto path = parts_of(request.path);
    const bool gets = request.method == "GET";
    try {
        if (!gets && request.method != "POST") throw HttpMistake{405, "this service knows GET and POST"};
        if (path.size() == 1 && path[0] == "version" && gets) {
            Json version = Json::object();
            version["project_name"] = "knurl";
            version["project_version"] = options_.version;
            version["protocol_version"] = "3.5";
            return {.status = 200, .body = version.dump()};
        }
        if (path.size() == 1 && path[0] == "devices" && gets)
            return {.status = 200, .body = device_list(request.session)};
        if (path.size() != 4 || path[0] != "inverse3" || path[2] != "config")
            throw HttpMistake{
                404,
                fmt::format("there is no {} here; there are /version, /devices and "
                            "/inverse3/ID/config/gravity_compensation, handedness, torque_scaling, basis",
                            words::printable(request.path, 60))};
        if (gets && path[1] == "*") throw HttpMistake{400, "GET needs one device; write its id or its index"};
        const auto selected = devices_of(devices(), path[1]);
        return done(config(path[3], selected, request.session,
                           gets ? std::nullopt : std::optional(body_of(request))));
    } catch (const HttpMistake& mistake) {
        return failed(mistake.status, mistake.text);
    }
}

std::string InverseService::device_list(const std::string& session) {
    std::vector<InverseLook> looks;
    if (!session.empty()) {
        looks = session_of(sessions_, session).looks();
    } else {
        for (const InverseDevice& device : devices()) {
            InverseLook look{.device = device};
            look.handedness = handedness(device.id);
            look.claimable = claimable(device);
            look.lapse = options_.lapse;
            looks.push_back(std::move(look));
        }
    }
    std::string text = "{";
    write_devices(text, looks, true);
    return text + "}";
}

Json InverseService::config(const std::string& what, const std::vector<const InverseDevice*>& of,
                            const std::string& session, const std::optional<Json>& given) {
    if (what == "handedness") return handedness_config(of, given);
    if (what == "basis") return basis_config(session, given);
    if (what != "gravity_compensation" && what != "torque_scaling")
        throw HttpMistake{404,
                          fmt::format("there is no config '{}'; there are gravity_compensation, handedness, "
                                      "torque_scaling, basis",
                                      words::printable(what, 60))};
    // Honest: who asks for what is not done is told so.
    if (given && flag_of(*given, "enabled"))
        throw HttpMistake{409,
                          fmt::format("device '{}' has no {} that this service could switch on; a driver of "
                                      "Knurl does what its arm needs by itself",
                                      of.front()->info.name, what)};
    Json data = Json::object();
    data["enabled"] = false;
    if (what == "gravity_compensation") data["scaling_factor"] = 0;
    return data;
}

Json InverseService::handedness_config(const std::vector<const InverseDevice*>& of,
                                       const std::optional<Json>& given) {
    if (given) {
        const Json hand = stated_in(*given, "handedness");
        if (hand != "left" && hand != "right")
            throw HttpMistake{400, "handedness must be \"left\" or \"right\""};
        for (const InverseDevice* device : of) set_handedness(device->id, hand.get<std::string>());
    }
    Json data = Json::object();
    data["handedness"] = handedness(of.front()->id);
    return data;
}

Json InverseService::basis_config(const std::string& session, const std::optional<Json>& given) {
    if (session.empty()) throw HttpMistake{400, "a basis is a session's; add ?session=:0"};
    InverseSession& named = session_of(sessions_, session);
    if (given) {
        const Json permutation = stated_in(*given, "permutation");
        if (!permutation.is_string() || !named.set_permutation(permutation.get<std::string>()))
            throw HttpMistake{400, "permutation must name each of X, Y, Z once, as in \"XZY\" or \"X-YZ\""};
    }
    Json data = Json::object();
    data["permutation"] = named.permutation();
    return data;
}

Inverse serve_inverse(InverseOptions options) {
    const auto service = std::make_shared<InverseService>(std::move(options));
    return {.simulation = [service](Socket& socket, const std::string&) -> std::unique_ptr<SocketHandler> {
                return std::make_unique<InverseSession>(service, socket);
            },
            .events = [service](Socket& socket, const std::string&) -> std::unique_ptr<SocketHandler> {
                return std::make_unique<InverseListener>(service, socket);
            },
            .http = [service](const InverseRequest& request) { return service->http(request); }};
}

}  // namespace knurl::gateway
