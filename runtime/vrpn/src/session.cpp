#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include <fmt/format.h>

#include <knurl/vrpn/messages.hpp>
#include <knurl/vrpn/session.hpp>

#include "commands.hpp"

namespace knurl::vrpn {

namespace {

constexpr std::int32_t control = 0;  // this server's id of its own sender; its devices follow
constexpr std::int64_t second = 1'000'000'000;
constexpr std::size_t most_lines = 10;  // to a client, within a second

/// An old datagram is late, not from a clock that was set.
constexpr std::int64_t latest_datagram = 10 * second;

std::int64_t stamp_of(const Header& header) {
    return header.seconds * second + std::int64_t{header.microseconds} * 1000;
}

/// Ends a force, or asks for none: it claims nothing.
bool lets_go(Type type, std::span<const std::byte> payload) {
    switch (type) {
        case Type::plane: {
            const auto plane = read_plane(payload);
            return plane && plane->stops();
        }
        case Type::force_field: {
            const auto field = read_field(payload);
            return field && field->stops();
        }
        case Type::plane_effects:
            return read_plane_effects(payload) == PlaneEffectsMessage{};
        case Type::constraint_enable: {
            Payload in(payload);
            return in.take<std::int32_t>() == 0;
        }
        case Type::custom_effect: {
            const auto effect = read_effect(payload);
            return effect && effect->number != EffectMessage::buzz;
        }
        case Type::clear_trimesh:
        case Type::remove_object:
            return true;
        default:
            return false;
    }
}

/// The rotation within `dt`.
Quat turned_within(const Vec3& angular_velocity, double dt) {
    const Eigen::Vector3d turn = dt * to_eigen(angular_velocity);
    const double angle = turn.norm();
    if (angle < 1e-12) return {};
    return to_plain(Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)));
}

}  // namespace

struct Session::Impl {
    Impl(const SessionOptions& given, Surroundings& outside) : options(given), around(outside) {}

    /// What this client has to do with a sender.
    struct Link {
        std::unique_ptr<Commands> commands;
        bool asked = false;  // the client has named it
        std::int64_t due = 0;
        std::uint32_t buttons = 0;
        bool failed = false;  // it was told a Force_Error
    };

    const SessionOptions& options;
    Surroundings& around;
    std::vector<Link> links;
    std::vector<std::int32_t> their_senders = std::vector<std::int32_t>(most_ids, -1);  // which of the links
    std::vector<std::int32_t> their_types = std::vector<std::int32_t>(most_ids, -1);    // which Type
    std::optional<std::uint32_t> last_datagram;
    std::int64_t last_reliable = 0;  // stamp of the last command that came by TCP
    std::array<std::uint32_t, 2> sequence{};
    double rate = 0;
    Time heard{}, renewed{}, counting{};
    std::size_t lines = 0;
    bool unsent = false;
    std::deque<std::pair<std::string, Time>> said;
    PayloadWriter out;
    std::vector<std::byte> bytes;

    void add(Type type, std::int32_t sender, Service service, std::int64_t stamp);
    void send(Type type, std::size_t sender, Service service);
    void describe(std::int32_t system, std::int32_t id, std::string_view name);
    void tell(std::size_t sender, Severity severity, const std::string& line, Time now,
              std::optional<ForceError> error = {});
    void button_states(std::size_t sender);
    std::string system(const Message& message, Service from, Time now);
    std::string name_sender(std::int32_t id, const std::string& name);
    bool stale(const Message& message, Service from);
    void command(std::size_t sender, Type type, const Message& message, Service from, Time now);
    void answer(std::size_t sender, Type type, const Message& message, Time now);
    void buttons(std::size_t sender, std::span<const HandReport> reports);
    void motion(std::size_t sender, const HandReport& report, double period, std::int64_t to_wall);
    bool due(Link& link, std::int64_t read_ns) const;
    void look_after(std::size_t sender, Time now);
};

Session::Session(const SessionOptions& options, Surroundings& around)
    : impl_(std::make_unique<Impl>(options, around)) {
    impl_->rate = options.rate;
    impl_->links.resize(around.senders().size());
}
Session::~Session() = default;

void Session::Impl::add(Type type, std::int32_t sender, Service service, std::int64_t stamp) {
    const Header header{.seconds = static_cast<std::int32_t>(stamp / second),
                        .microseconds = static_cast<std::int32_t>(stamp % second / 1000),
                        .sender = sender,
                        .type = static_cast<std::int32_t>(type),
                        .sequence = sequence[service == Service::quick ? 1 : 0]++};
    append(bytes, header, out.bytes());
    out.clear();
}

void Session::Impl::send(Type type, std::size_t sender, Service service) {
    add(type, static_cast<std::int32_t>(sender) + 1, service, around.wall_clock());
    around.send(service, bytes);
    bytes.clear();
}

void Session::Impl::describe(std::int32_t system, std::int32_t id, std::string_view name) {
    put_name(out, name);
    add(static_cast<Type>(system), id, Service::reliable, around.wall_clock());
}

void Session::begin(const std::string& address, std::uint16_t udp_port, Time now) {
    Impl& s = *impl_;
    s.heard = s.renewed = s.counting = now;
    if (udp_port != 0) {
        s.out.put_text(address, address.size() + 1);
        s.add(static_cast<Type>(system_type::udp), udp_port, Service::reliable, s.around.wall_clock());
    }
    s.describe(system_type::sender, control, "VRPN Control");
    const auto senders = s.around.senders();
    for (std::size_t i = 0; i < senders.size(); ++i)
        s.describe(system_type::sender, static_cast<std::int32_t>(i) + 1, senders[i].name);
    for (std::size_t i = 0; i < type_count; ++i)
        s.describe(system_type::type, static_cast<std::int32_t>(i), name_of(static_cast<Type>(i)));
    s.around.send(Service::reliable, s.bytes);
    s.bytes.clear();
    for (std::size_t i = 0; i < senders.size(); ++i) s.button_states(i);
}

void Session::Impl::button_states(std::size_t sender) {
    const auto& newest = around.senders()[sender].newest;
    links[sender].buttons = newest ? newest->buttons : 0;
    payload::button_states(out, links[sender].buttons, options.buttons);
    send(Type::button_states, sender, Service::reliable);
}

/// A line to the client, and what its force device is told. The same error comes again after ten times `repeat`, a warning
/// never; and ten lines within a second are enough.
void Session::Impl::tell(std::size_t sender, Severity severity, const std::string& line, Time now,
                         std::optional<ForceError> error) {
    if (now - counting >= options.repeat) {
        counting = now;
        lines = 0;
    }
    const auto again = [&](const auto& each) {
        return each.first == line && now - each.second < 10 * options.repeat;
    };
    if (std::any_of(said.begin(), said.end(), again) || ++lines > most_lines) return;
    std::erase_if(said, [&](const auto& each) { return each.first == line; });
    if (said.size() >= 32) said.pop_front();
    said.emplace_back(line, now);
    payload::text(out, severity, line);
    send(Type::text, sender, Service::reliable);
    if (severity != Severity::normal) around.log(fmt::format("{}: {}", around.senders()[sender].name, line));
    if (!error) return;
    links[sender].failed = *error != ForceError::none;
    payload::force_error(out, *error);
    send(Type::force_error, sender, Service::reliable);
}

std::string Session::Impl::name_sender(std::int32_t id, const std::string& name) {
    const auto senders = around.senders();
    const auto found = std::find_if(senders.begin(), senders.end(),
                                    [&](const SenderInfo& each) { return each.name == name; });
    if (found != senders.end()) {
        const auto index = static_cast<std::size_t>(found - senders.begin());
        their_senders[static_cast<std::size_t>(id)] = static_cast<std::int32_t>(index);
        links[index].asked = true;
        return {};
    }
    their_senders[static_cast<std::size_t>(id)] = -1;
    if (name.starts_with("VRPN ") || name.starts_with("vrpn ")) return {};
    std::string all;
    for (const SenderInfo& each : senders) all += (all.empty() ? "" : ", ") + each.name;
    if (lines++ < most_lines) around.log(fmt::format("it asks for '{}'; this server has {}", name, all));
    return {};
}

std::string Session::Impl::system(const Message& message, Service from, Time now) {
    const Header& header = message.header;
    if (from == Service::quick) return {};  // a datagram describes nothing
    switch (header.type) {
        case system_type::sender:
        case system_type::type: {
            const char* what = header.type == system_type::sender ? "sender" : "type";
            if (header.sender < 0 || header.sender >= most_ids)
                return fmt::format("it describes {} {}, and ids are 0 to {}", what, header.sender,
                                   most_ids - 1);
            const auto name = described_name(message.payload);
            if (!name) return fmt::format("the name of its {} {} has a wrong length", what, header.sender);
            if (header.type == system_type::sender) return name_sender(header.sender, *name);
            const auto type = type_of(*name);
            their_types[static_cast<std::size_t>(header.sender)] =
                type ? static_cast<std::int32_t>(*type) : -1;
            return {};
        }
        case system_type::udp:
            // The address in it may be anybody's: datagrams go to the host from which it has connected.
            if (header.sender < 1024 || header.sender > 65535)
                return fmt::format("it wants datagrams at port {}; that must be 1024 to 65535",
                                   header.sender);
            around.takes_datagrams(static_cast<std::uint16_t>(header.sender));
            return {};
        case system_type::log:
            if (header.sender != 0 && !links.empty())
                tell(0, Severity::warning, "this server writes no log file for a client", now);
            return {};
        default:
            return {};
    }
}

/// A datagram that was overtaken: by a newer one, or by a command that came by TCP (a plane that was stopped).
bool Session::Impl::stale(const Message& message, Service from) {
    const std::int64_t stamp = stamp_of(message.header);
    if (from == Service::reliable) {
        last_reliable = stamp;
        return false;
    }
    const std::uint32_t sequence_said = message.header.sequence;
    if (last_datagram && static_cast<std::int32_t>(sequence_said - *last_datagram) <= 0) return true;
    last_datagram = sequence_said;
    return stamp < last_reliable && last_reliable - stamp < latest_datagram;
}

std::string Session::receive(const Message& message, Service from, Time now) {
    Impl& s = *impl_;
    s.heard = now;
    const Header& header = message.header;
    if (header.type < 0) return s.system(message, from, now);
    if (header.type >= most_ids || header.sender < 0 || header.sender >= most_ids) return {};
    const std::int32_t type = s.their_types[static_cast<std::size_t>(header.type)];
    const std::int32_t sender = s.their_senders[static_cast<std::size_t>(header.sender)];
    if (type < 0 || sender < 0) return {};
    const auto known = static_cast<Type>(type);
    if (commands_force(known))
        s.command(static_cast<std::size_t>(sender), known, message, from, now);
    else
        s.answer(static_cast<std::size_t>(sender), known, message, now);
    return {};
}

void Session::Impl::command(std::size_t sender, Type type, const Message& message, Service from, Time now) {
    if (stale(message, from)) return;
    Link& link = links[sender];
    if (!link.commands) {
        if (lets_go(type, message.payload)) return;
        const std::string refused = around.hold(sender);
        if (!refused.empty()) return tell(sender, Severity::error, refused, now, ForceError::other);
        link.commands = std::make_unique<Commands>(around.make_hand(sender), options.mapping);
    }
    const SenderInfo& info = around.senders()[sender];
    if (!info.device)
        return tell(sender, Severity::error,
                    "the device is not there yet: start its servo, and send it again", now,
                    ForceError::other);
    const Outcome outcome = link.commands->take(type, message.payload, info.device->max_stiffness);
    unsent = true;
    const auto line = [&](const std::string& what) { return fmt::format("{}: {}", name_of(type), what); };
    if (!outcome.refused.empty())
        tell(sender, Severity::error, line(outcome.refused), now, ForceError::range);
    if (!outcome.remark.empty()) tell(sender, Severity::warning, line(outcome.remark), now);
}

void Session::Impl::answer(std::size_t sender, Type type, const Message& message, Time now) {
    const SenderInfo& info = around.senders()[sender];
    switch (type) {
        case Type::ping:
            send(Type::pong, sender, Service::reliable);
            return button_states(sender);
        case Type::request_workspace: {
            if (!info.device) return;
            const Vec3 centre = options.mapping.axes.position(info.device->workspace_centre);
            const double radius = info.device->workspace_radius;
            payload::workspace(out, {centre.x - radius, centre.y - radius, centre.z - radius},
                               {centre.x + radius, centre.y + radius, centre.z + radius});
            return send(Type::workspace, sender, Service::reliable);
        }
        case Type::request_to_room:
            payload::pose(out, {}, {});
            return send(Type::to_room, sender, Service::reliable);
        case Type::request_unit_to_sensor:
            payload::pos_quat(out, 0, {}, {});
            return send(Type::unit_to_sensor, sender, Service::reliable);
        case Type::set_update_rate: {
            Payload in(message.payload);
            const auto asked = in.take<double>();
            if (!in.complete() || !(asked > 0 && asked <= 1e6))
                return tell(sender, Severity::error,
                            "set_update_rate: the rate must be above 0 and at most 1e6 Hz", now);
            rate = options.rate > 0 ? std::min(options.rate, asked) : asked;
            return;
        }
        case Type::reset_origin:
            return tell(sender, Severity::warning,
                        "Reset_Origin: the origin is the middle of the device's workspace, and stays", now);
        default:
            return;  // what only servers say
    }
}

void Session::received(Time) {
    Impl& s = *impl_;
    if (!std::exchange(s.unsent, false)) return;
    for (Impl::Link& link : s.links)
        if (link.commands) link.commands->hand().sent();
}

bool Session::Impl::due(Link& link, std::int64_t read_ns) const {
    if (rate <= 0) return true;
    constexpr std::int64_t jitter = 200'000;  // ns: the servo's own, and not what a limit is for
    if (read_ns + jitter < link.due) return false;
    const auto interval = static_cast<std::int64_t>(1e9 / rate);
    link.due = (read_ns - link.due > interval ? read_ns : link.due) + interval;
    return true;
}

void Session::Impl::motion(std::size_t sender, const HandReport& report, double period,
                           std::int64_t to_wall) {
    const gateway::Axes& axes = options.mapping.axes;
    const std::int64_t stamp = report.read_ns + to_wall;
    const auto id = static_cast<std::int32_t>(sender) + 1;
    const Quat orientation = axes.orientation(report.orientation);
    payload::pos_quat(out, 0, axes.position(report.position), orientation);
    add(Type::pos_quat, id, Service::quick, stamp);
    payload::velocity(out, 0, axes.position(report.velocity),
                      turned_within(axes.axial(report.angular_velocity), period), period);
    add(Type::velocity, id, Service::quick, stamp);
    payload::force(out, axes.direction(report.sent_force));
    add(Type::force, id, Service::quick, stamp);
    payload::pose(out, axes.position(report.contact_point), orientation);
    add(Type::contact_point, id, Service::quick, stamp);
}

void Session::Impl::buttons(std::size_t sender, std::span<const HandReport> reports) {
    for (const HandReport& report : reports) {
        const std::uint32_t changed = report.buttons ^ links[sender].buttons;
        if (changed == 0) continue;
        links[sender].buttons = report.buttons;
        for (std::int32_t i = 0; i < options.buttons; ++i) {
            if ((changed >> i & 1u) == 0) continue;
            payload::button_change(out, i, (report.buttons >> i & 1u) != 0);
            send(Type::button_change, sender, Service::reliable);
        }
    }
}

void Session::report(std::size_t sender, std::span<const HandReport> reports, Time now) {
    Impl& s = *impl_;
    Impl::Link& link = s.links[sender];
    if (reports.empty() || !link.asked) return;
    const std::int64_t to_wall =
        s.around.wall_clock() -
        std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
    const auto& device = s.around.senders()[sender].device;
    const double period = device && device->rate > 0 ? 1 / device->rate : 1e-3;
    // The newest ones: a client that wants every report reads recordings.
    constexpr std::size_t most = 4;
    for (const HandReport& report : reports.last(std::min(most, reports.size())))
        if (s.due(link, report.read_ns)) s.motion(sender, report, period, to_wall);
    if (!s.bytes.empty()) s.around.send(Service::quick, s.bytes);
    s.bytes.clear();
    s.buttons(sender, reports);
    if (link.commands) link.commands->look(reports.back());
}

/// What the hand has to say, and its lease.
void Session::Impl::look_after(std::size_t sender, Time now) {
    Link& link = links[sender];
    gateway::PeerCommands& hand = link.commands->hand();
    for (const gateway::Said& line : hand.said()) {
        const bool bad = line.level != gateway::Said::Level::info;
        tell(sender, bad ? Severity::error : Severity::normal, line.text, now,
             !bad                      ? std::nullopt
             : line.subject == "fault" ? std::optional(ForceError::device)
                                       : std::optional(ForceError::other));
    }
    if (link.failed && hand.status().armed) {
        link.failed = false;
        payload::force_error(out, ForceError::none);
        send(Type::force_error, sender, Service::reliable);
    }
}

void Session::tick(Time now) {
    Impl& s = *impl_;
    const bool renews = now - s.renewed >= s.options.renew;
    const bool silent = s.options.silent_after.count() > 0 && now - s.heard > s.options.silent_after;
    for (std::size_t i = 0; i < s.links.size(); ++i) {
        if (!s.links[i].commands) continue;
        s.look_after(i, now);
        // VRPN has no heartbeat: while the client is connected its force stays.
        if (renews && !silent) s.links[i].commands->hand().sent();
    }
    if (renews) s.renewed = now;
}

bool Session::commands(std::size_t sender) const {
    return impl_->links[sender].commands != nullptr;
}

}  // namespace knurl::vrpn
