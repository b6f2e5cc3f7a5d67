#include "inverse_session.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <knurl/words/printable.hpp>

namespace knurl::gateway {

namespace {

constexpr std::size_t longest_message = 256 * 1024;  // bytes
constexpr std::size_t most_entries = 64;             // devices in a message, changes in a list
constexpr std::size_t most_unknown = 64;             // keys that are remembered by name
constexpr std::size_t most_texts = 64;
constexpr int most_a_second = 10;
constexpr std::chrono::seconds repeat_after{10};

std::string shown(std::string_view text) {
    return words::printable(text, 60);
}

double number_of(const Json& value, const std::string& what) {
    if (!value.is_number()) throw InverseMistake(what + " must be a number");
    return value.get<double>();
}

/// {x, y, z}.
Vec3 vector_of(const Json& value, const std::string& what) {
    if (!value.is_object())
        throw InverseMistake(what + " must be an object; write {\"x\": 0, \"y\": 0, \"z\": 0}");
    const auto part = [&](const char* key) {
        if (!value.contains(key)) throw InverseMistake(fmt::format("{}.{} is missing", what, key));
        return number_of(value.at(key), fmt::format("{}.{}", what, key));
    };
    return {part("x"), part("y"), part("z")};
}

const Json& member(const Json& value, const char* key, const std::string& what) {
    if (!value.is_object()) throw InverseMistake(what + " must be an object");
    if (!value.contains(key)) throw InverseMistake(fmt::format("{} needs {}", what, key));
    return value.at(key);
}

/// An object, or each object of a list.
template <class Do>
void each_of(const Json& stated, const std::string& what, Do act) {
    if (!stated.is_array()) return act(stated);
    if (stated.size() > most_entries)
        throw InverseMistake(fmt::format("{} has {} entries; give at most {} in a message", what,
                                         stated.size(), most_entries));
    for (const Json& one : stated) act(one);
}

InverseTransform transform_of(const Json& stated, InverseTransform transform) {
    const Json& given = stated.is_object() && stated.contains("transform") ? stated.at("transform") : stated;
    const std::string what = "set_transform";
    if (!given.is_object()) throw InverseMistake(what + " must be an object");
    constexpr double farthest = 1e6, least_scale = 1e-6;
    const auto within = [](const Vec3& v, double most) {
        return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
    };
    if (given.contains("position")) transform.position = vector_of(given.at("position"), what + ".position");
    if (given.contains("scale")) transform.scale = vector_of(given.at("scale"), what + ".scale");
    if (given.contains("rotation")) {
        const Json& rotation = given.at("rotation");
        const Vec3 axis = vector_of(rotation, what + ".rotation");
        const double w = number_of(member(rotation, "w", what + ".rotation"), what + ".rotation.w");
        const Eigen::Quaterniond q(w, axis.x, axis.y, axis.z);
        if (!(q.norm() > least_scale && q.norm() < 1 / least_scale))
            throw InverseMistake(what +
                                 ".rotation has no length; write {\"w\": 1, \"x\": 0, \"y\": 0, \"z\": 0}");
        transform.rotation = to_plain(q.normalized());
    }
    if (!within(transform.position, farthest))
        throw InverseMistake(fmt::format(
            "set_transform.position is out of range; each part must be -{0:g} to {0:g} m", farthest));
    for (const double scale : {transform.scale.x, transform.scale.y, transform.scale.z})
        if (!(std::abs(scale) >= least_scale && std::abs(scale) <= farthest))
            throw InverseMistake(
                fmt::format("set_transform.scale is {:g}; it must be {:g} to {:g}, either sign", scale,
                            least_scale, farthest));
    return transform;
}

}  // namespace

Vec3 InverseTransform::point(const Vec3& device) const {
    if (is_identity()) return device;
    return to_plain(to_eigen(position) +
                    to_eigen(rotation) * to_eigen(scale).cwiseProduct(to_eigen(device)).eval());
}
Vec3 InverseTransform::point_back(const Vec3& application) const {
    if (is_identity()) return application;
    const Eigen::Vector3d turned =
        to_eigen(rotation).conjugate() * (to_eigen(application) - to_eigen(position));
    return to_plain(turned.cwiseQuotient(to_eigen(scale)).eval());
}
Vec3 InverseTransform::rate(const Vec3& device) const {
    if (is_identity()) return device;
    return to_plain(to_eigen(rotation) * to_eigen(scale).cwiseProduct(to_eigen(device)).eval());
}
Vec3 InverseTransform::force(const Vec3& device) const {
    return is_identity() ? device : to_plain(to_eigen(rotation) * to_eigen(device));
}
Vec3 InverseTransform::force_back(const Vec3& application) const {
    return is_identity() ? application : to_plain(to_eigen(rotation).conjugate() * to_eigen(application));
}

InverseSession::InverseSession(std::shared_ptr<InverseService> service, Socket& socket)
    : service_(std::move(service)), socket_(socket), number_(service_->begin_session(*this)) {
    service_->look();
    answer(true);
}

InverseSession::~InverseSession() {
    service_->end_session(number_);
}

void InverseSession::binary(std::span<const std::byte>) {
    complain("message-refused", "a message of bytes came; this protocol has texts alone");
    service_->look();
    answer(false);
}

void InverseSession::tick(TimePoint) {
    service_->look();
    hear();
}

void InverseSession::text(std::string_view message) {
    service_->look();
    full_wanted_ = false;
    try {
        if (message.size() > longest_message)
            throw InverseMistake(
                fmt::format("a message has {} bytes; send at most {}", message.size(), longest_message));
        const Json json = Json::parse(message);
        if (!json.is_object()) throw InverseMistake("a message is an object; write {\"inverse3\": [...]}");
        read(json);
    } catch (const JsonError& error) {
        std::string_view what = error.what();
        if (what.starts_with('['))  // the parser's own number of it
            what.remove_prefix(std::min(what.find("] ") + 2, what.size()));
        complain("message-refused", fmt::format("a message is no JSON: {}", what));
    } catch (
        const std::exception& error) {  // a mistake of the client's; whatever it is, never a reason to close
        complain("message-refused", error.what());
    }
    for (auto& [id, hold] : holds_)
        if (hold.hand) hold.hand->sent();
    hear();
    answer(full_wanted_);
}

void InverseSession::read(const Json& message) {
    for (const Json::Item& item : message.items()) {
        const bool devices = item.key == "inverse3";
        const bool grips = item.key == "wireless_verse_grip" || item.key == "verse_grip";
        try {
            if ((devices || grips) && !item.value.is_array())
                throw InverseMistake(fmt::format("{} must be a list of devices", item.key));
            if (devices)
                each_of(item.value, item.key, [this](const Json& entry) { read_device(entry); });
            else if (grips)
                each_of(item.value, item.key, [this](const Json& entry) { read_grip(entry); });
            else if (item.key == "session")
                read_session(item.value);
            else
                unknown(item.key);
        } catch (const InverseMistake& mistake) {
            complain("message-refused", mistake.what());
        }
    }
}

void InverseSession::read_session(const Json& session) {
    if (!session.is_object()) throw InverseMistake("session must be an object");
    for (const auto& [key, value] : session.items()) {
        if (key == "force_render_full_state") {
            full_wanted_ = true;
        } else if (key == "configure") {
            if (!value.is_object()) throw InverseMistake("session.configure must be an object");
            for (const auto& [what, stated] : value.items()) {
                if (what == "basis")
                    read_basis(stated);
                else if (what != "profile")  // who the client is: of no use here
                    unknown("session.configure." + what);
            }
        } else {
            unknown("session." + key);
        }
    }
}

void InverseSession::read_basis(const Json& basis) {
    const Json& permutation = member(basis, "permutation", "session.configure.basis");
    if (!permutation.is_string() || !set_permutation(permutation.get<std::string>()))
        throw InverseMistake(fmt::format(
            "session.configure.basis.permutation is {}; it must name each of X, Y, Z once, each with - or + "
            "or nothing before it",
            shown(permutation.dump())));
}

bool InverseSession::set_permutation(const std::string& permutation) {
    const auto basis = Axes::parse(permutation);
    if (!basis) return false;
    permutation_ = permutation;
    axes_ = frames::haply.then(*basis);
    return true;
}

void InverseSession::read_device(const Json& entry) {
    if (!entry.is_object()) throw InverseMistake("an entry of inverse3 must be an object");
    const Json& id = member(entry, "device_id", "an entry of inverse3");
    const InverseDevice* const device = id.is_string() ? service_->find(id.get<std::string>()) : nullptr;
    if (device == nullptr) {
        std::string known;
        for (const InverseDevice& each : service_->devices()) known += (known.empty() ? "" : ", ") + each.id;
        throw InverseMistake(
            fmt::format("there is no inverse3 {}; {}", shown(id.dump()),
                        known.empty() ? "there is no device: " + service_->trouble() : "there are " + known));
    }
    for (const auto& [key, value] : entry.items()) {
        if (key == "commands") {
            if (!value.is_object()) throw InverseMistake("commands must be an object");
            read_commands(*device, value);
        } else if (key == "configure") {
            if (!value.is_object()) throw InverseMistake("configure must be an object");
            for (const auto& [what, stated] : value.items()) unknown("inverse3.configure." + what);
        } else if (key != "device_id") {
            unknown("inverse3." + key);
        }
    }
}

void InverseSession::read_grip(const Json& entry) {
    if (!entry.is_object()) throw InverseMistake("an entry of a grip must be an object");
    for (const auto& [key, value] : entry.items()) {
        if (key == "commands" && value.is_object()) {
            for (const auto& [command, stated] : value.items())
                if (command != "probe_orientation") unknown("wireless_verse_grip.commands." + command);
        } else if (key != "device_id") {
            unknown("wireless_verse_grip." + key);
        }
    }
}

void InverseSession::read_commands(const InverseDevice& device, const Json& commands) {
    for (const auto& [command, stated] : commands.items()) {
        try {
            read_command(device, command, stated);
        } catch (const InverseMistake& mistake) {
            complain("command-refused", mistake.what(), "warning", device.id);
        }
    }
}

void InverseSession::read_command(const InverseDevice& device, const std::string& command,
                                  const Json& stated) {
    if (command == "probe_position" || command == "probe_orientation") return;
    if (command == "set_cursor_force")
        push(device, stated);
    else if (command == "set_cursor_position")
        pull(device, stated);
    else if (command == "set_transform")
        holds_[device.id].transform = transform_of(stated, holds_[device.id].transform);
    else if (command == "set_angular_torques" || command == "set_angular_position")
        throw InverseMistake(command +
                             " is not supported: Knurl's forces act at the tip; use set_cursor_force, or a "
                             "representation under knurl");
    else if (command == "knurl")
        read_items(device, stated);
    else
        unknown("inverse3.commands." + command);
}

void InverseSession::push(const InverseDevice& device, const Json& stated) {
    const bool older = stated.is_object() && !stated.contains("vector") && stated.contains("values");
    const std::string field = older ? "set_cursor_force.values" : "set_cursor_force.vector";
    const Vec3 force = vector_of(member(stated, older ? "values" : "vector", "set_cursor_force"), field);
    Hold& hold = holds_[device.id];
    PeerCommands* const peer = hand(device);
    if (peer == nullptr) return;
    refuse_unless_empty(peer->push(axes_.back().direction(hold.transform.force_back(force)), field), device);
    hold.mode = "force";
    hold.mode_at = service_->now();
}

void InverseSession::pull(const InverseDevice& device, const Json& stated) {
    const std::string field = "set_cursor_position.position";
    const Vec3 target = vector_of(member(stated, "position", "set_cursor_position"), field);
    Hold& hold = holds_[device.id];
    PeerCommands* const peer = hand(device);
    if (peer == nullptr) return;
    refuse_unless_empty(peer->pull(axes_.back().position(hold.transform.point_back(target)), field), device);
    hold.mode = "position";
    hold.mode_at = service_->now();
}

void InverseSession::read_items(const InverseDevice& device, const Json& stated) {
    if (!stated.is_object()) throw InverseMistake("knurl must be an object; write {\"add\": {...}}");
    for (const auto& [verb, what] : stated.items()) {
        if (verb == "add")
            each_of(what, "knurl.add", [&](const Json& one) { add(device, one); });
        else if (verb == "set")
            each_of(what, "knurl.set", [&](const Json& one) { set(device, one); });
        else if (verb == "remove")
            each_of(what, "knurl.remove", [&](const Json& one) { remove(device, one); });
        else
            unknown("inverse3.commands.knurl." + verb);
    }
}

void InverseSession::add(const InverseDevice& device, const Json& stated) {
    InverseItem item = read_item(stated);
    PeerCommands* const peer = hand(device);
    if (peer == nullptr) return;
    Hold& hold = holds_[device.id];
    if (!hold.transform.is_identity())
        complain(
            "transform-ignored",
            "representations under knurl lie in the device's own space: set_transform does not move them",
            "notice", device.id);
    const std::string refused =
        peer->add(item.id, item.kind, in_axes(axes_.back(), item.kind, item.params), item.options);
    if (!refused.empty()) throw InverseMistake(refused);
    hold.items[item.id] = std::move(item);
}

void InverseSession::set(const InverseDevice& device, const Json& stated) {
    const std::string id = read_item_id(stated);
    auto& items = holds_[device.id].items;
    const auto found = items.find(id);
    if (found == items.end())
        throw InverseMistake(fmt::format("there is no representation '{}' to set; add it first", shown(id)));
    InverseItem changed = read_change(stated, found->second);
    PeerCommands* const peer = hand(device);
    if (peer == nullptr) return;
    refuse_unless_empty(peer->set(id, in_axes(axes_.back(), changed.kind, changed.params)), device);
    found->second = std::move(changed);
}

void InverseSession::remove(const InverseDevice& device, const Json& stated) {
    const std::string id = stated.is_string() ? stated.get<std::string>() : read_item_id(stated);
    auto& items = holds_[device.id].items;
    if (items.erase(id) == 0)
        throw InverseMistake(fmt::format("there is no representation '{}' to remove", shown(id)));
    if (PeerCommands* const peer = hand(device)) refuse_unless_empty(peer->remove(id), device);
}

PeerCommands* InverseSession::hand(const InverseDevice& device) {
    if (!service_->claimable(device))
        throw InverseMistake(fmt::format(
            "device '{0}' can be read here, not moved; start knurl-web with --inverse-device {0} to allow it",
            device.info.name));
    if (socket_.role() == Role::observe)
        throw InverseMistake("this connection may look only; it needs the role render or control");
    auto& made = holds_[device.id].hand;
    if (!made) made = service_->make_hand(device, socket_.peer(), socket_.role());
    return made.get();
}

void InverseSession::refuse_unless_empty(const std::string& text, const InverseDevice& device) {
    if (!text.empty()) complain("command-refused", text, "warning", device.id);
}

void InverseSession::hear() {
    for (auto& [id, hold] : holds_) {
        if (!hold.hand) continue;
        for (const Said& said : hold.hand->said()) {
            if (said.subject == "fault" || said.subject == "servo")
                continue;  // the service itself tells of those
            complain(said.subject == "claim" ? "device-busy"
                     : said.subject == "arm" ? "arm-refused"
                                             : "command-refused",
                     said.text, said.level == Said::Level::error ? "error" : "warning", id);
        }
    }
}

void InverseSession::unknown(const std::string& key) {
    const std::string known = shown(key);
    if (unknown_.size() >= most_unknown && !unknown_.contains(known)) return;
    if (unknown_[known]++ == 0)
        complain("unknown-key", fmt::format("{} is not known here, and is ignored from now on", known),
                 "notice");
}

void InverseSession::complain(const std::string& name, const std::string& text, const std::string& level,
                              const std::string& device) {
    const TimePoint now = service_->now();
    std::string line = words::printable(text, 500);
    if (complained_.size() >= most_texts)
        std::erase_if(complained_, [&](const auto& said) { return now >= said.second + repeat_after; });
    const auto found = complained_.find(line);
    if (now >= second_ + std::chrono::seconds(1)) {
        second_ = now;
        this_second_ = 0;
    }
    if ((found != complained_.end() && now < found->second + repeat_after) || this_second_ >= most_a_second) {
        ++held_back_;
        return;
    }
    ++this_second_;
    if (complained_.size() < most_texts || found != complained_.end()) complained_[line] = now;
    if (held_back_ > 0) line += fmt::format(" (and {} that were not said)", std::exchange(held_back_, 0));
    Json data = Json::object();
    data["session_id"] = number_;
    data["peer"] = socket_.peer();
    if (!device.empty()) data["device_id"] = device;
    to_say_.push_back(line);
    service_->publish({.name = name,
                       .category = device.empty() ? "session" : "device",
                       .level = level,
                       .data = std::move(data),
                       .message = std::move(line)});
}

std::vector<InverseLook> InverseSession::looks() const {
    std::vector<InverseLook> all;
    for (const InverseDevice& device : service_->devices()) {
        InverseLook look{.device = device};
        look.axes = axes_;
        look.permutation = permutation_;
        look.handedness = service_->handedness(device.id);
        look.claimable = service_->claimable(device);
        look.lapse = service_->options().lapse;
        if (const auto found = holds_.find(device.id); found != holds_.end()) {
            const Hold& hold = found->second;
            look.transform = hold.transform;
            if (hold.hand) look.peer = hold.hand->status();
            if (service_->now() < hold.mode_at + service_->options().lapse) look.control_mode = hold.mode;
        }
        all.push_back(std::move(look));
    }
    return all;
}

void InverseSession::answer(bool full) {
    std::string out;
    out.reserve(4096);
    out += fmt::format("{{\"session_id\":{},", number_);
    write_devices(out, looks(), full);
    if (!to_say_.empty() || (full && !unknown_.empty())) {
        Json ours = Json::object();
        if (!to_say_.empty()) ours["said"] = std::exchange(to_say_, {});
        if (full && !unknown_.empty()) ours["unknown_keys"] = Json(unknown_);
        out += ",\"knurl\":" + ours.dump();
    }
    out += '}';
    socket_.send_text(std::move(out));
}

InverseListener::InverseListener(std::shared_ptr<InverseService> service, Socket& socket)
    : service_(std::move(service)), socket_(socket) {
    service_->listen(socket_);
}

InverseListener::~InverseListener() {
    service_->stop_listening(socket_);
}

}  // namespace knurl::gateway
