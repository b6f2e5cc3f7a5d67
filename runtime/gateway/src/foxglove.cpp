#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <time.h>

#include <knurl/gateway/foxglove.hpp>
#include <knurl/json/json.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/messages/markers.hpp>
#include <knurl/messages/messages.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/view/text.hpp>
#include <knurl/words/printable.hpp>

#include "foxglove_scene.hpp"
#include "params_json.hpp"

namespace knurl::gateway {

namespace {

using messages::Bytes;
using messages::Channel;
using Time = std::chrono::steady_clock::time_point;

constexpr auto diagnostics_every = std::chrono::seconds(1);
constexpr auto parameters_every = std::chrono::milliseconds(250);  // however often they change
constexpr std::size_t most_listed = 256;                           // items in the parameters
constexpr std::size_t most_reports = 1024;                         // for a peer that stood still for a while
constexpr std::int64_t millisecond = 1'000'000;                    // ns

std::int64_t clock_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

/// A message, and when it was (ns of CLOCK_REALTIME).
struct Stamped {
    std::int64_t ns = 0;
    Bytes bytes;
};

/// A channel that is advertised. `sequence` counts its messages; a socket has the newest one if it has seen that.
struct Open {
    Channel channel{};
    std::size_t device = 0;
    std::string topic;
    std::size_t subscribers = 0;
    std::uint64_t sequence = 0;
    bool made_since = false;  // since somebody has subscribed
    std::uint64_t cycle = 0;  // of the newest report that was sent
    Stamped newest;
    // Of reports: the newest ones, the last of which is number `sequence`.
    std::deque<Stamped> reports;
    // Of parameters and diagnostics.
    std::uint64_t version = 0;
    std::optional<Time> made;
};

Json vector(const Vec3& v) {
    return Json::array({number_json(v.x), number_json(v.y), number_json(v.z)});
}

Json parameters_of(const SeenDevice& device) {
    const protocol::DeviceInfo& info = device.info;
    Json about = Json::object();
    about["name"] = protocol::printable(info.name);
    about["servo"] = protocol::printable(info.servo);
    about["address"] = protocol::printable(info.address);
    about["profile"] = protocol::printable(info.profile);
    about["serial"] = protocol::printable(info.serial);
    about["joints"] = info.joints;
    about["renders_torque"] = info.renders_torque != 0;
    about["senses_orientation"] = info.senses_orientation != 0;
    about["rate"] = number_json(info.rate);
    about["workspace_centre"] = vector(info.workspace_centre);
    about["workspace_radius"] = number_json(info.workspace_radius);
    about["peak_force"] = number_json(info.peak_force);
    about["peak_torque"] = number_json(info.peak_torque);
    about["max_stiffness"] = number_json(info.max_stiffness);
    about["damping"] = number_json(info.damping);
    about["lag"] = number_json(info.lag);
    Json items = Json::array();
    std::size_t left_out = 0;
    for (const auto& [claim, scene] : device.claims)
        for (const auto& [slot, item] : scene.items) {
            if (item.kind >= kinds().size() || item.params.size() != kinds()[item.kind].size ||
                items.size() >= most_listed) {
                ++left_out;
                continue;
            }
            Json one = Json::object();
            one["claim"] = claim;
            one["slot"] = slot;
            one["kind"] = kinds()[item.kind].name;
            one["probe"] = item.options.probe;
            one["params"] = params_json(item.kind, item.params);
            items.push_back(std::move(one));
        }
    Json all = Json::object();
    all["device"] = std::move(about);
    all["items"] = std::move(items);
    all["left_out"] = left_out;
    return all;
}

Bytes bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// State, rates and counters of a device.
messages::Diagnostic diagnostic_of(const SeenDevice& device) {
    const view::DeviceRates& rates = device.rates;
    messages::Diagnostic one;
    one.name = "knurl: " + protocol::printable(device.info.name);
    one.hardware_id = protocol::printable(device.info.serial);
    if (one.hardware_id.empty()) one.hardware_id = protocol::printable(device.info.address);
    using Level = messages::Diagnostic::Level;
    if (!device.newest) {
        one.level = Level::stale;
        one.message = "no report";
    } else {
        one.message = view::state_name(device.newest->state);
        if (device.newest->state == DeviceState::fault) {
            one.level = Level::error;
            one.message += ": " + view::fault_names(device.newest->faults);
        } else if (device.newest->state == DeviceState::disconnected) {
            one.level = Level::error;
        } else if (rates.late > 0 || rates.overruns > 0) {
            one.level = Level::warn;
            one.message += fmt::format("; {} cycles late", rates.late);
        }
    }
    const auto value = [&one](std::string key, std::string text) {
        one.values.emplace_back(std::move(key), std::move(text));
    };
    value("rate (Hz)", fmt::format("{:.1f}", rates.rate));
    value("late", std::to_string(rates.late));
    value("overruns", std::to_string(rates.overruns));
    value("busy", fmt::format("{:.3f}", rates.busy));
    value("step (us)", fmt::format("{:.1f}", rates.step));
    if (rates.parts)
        for (std::size_t i = 0; i < rates.parts->size(); ++i)
            value(fmt::format("{} (us)", view::cycle_parts[i]), fmt::format("{:.2f}", (*rates.parts)[i]));
    if (rates.late_median) value("lateness, median (us)", fmt::format("{:.1f}", *rates.late_median));
    if (rates.late_max) value("lateness, largest (us)", fmt::format("{:.1f}", *rates.late_max));
    for (const auto& [name, count] : rates.device.counters) value(name, std::to_string(count));
    for (const view::ClientRates& client : rates.clients)
        value(fmt::format("client {}", client.client.row),
              fmt::format("{} (pid {}){}, {:.1f} updates/s, {} merged, {} refused, {} missed",
                          protocol::printable(client.client.name), client.client.pid,
                          client.client.observer ? " observes" : "", client.updates, client.merged,
                          client.refused, client.missed));
    return one;
}

Json advertisement(std::uint32_t id, const Open& open) {
    const messages::ChannelInfo& info = messages::channels()[static_cast<std::size_t>(open.channel)];
    const messages::Schema& schema = info.schema();
    Json one = Json::object();
    one["id"] = id;
    one["topic"] = open.topic;
    one["encoding"] = info.encoding;
    one["schemaName"] = schema.name;
    one["schemaEncoding"] = schema.encoding;
    one["schema"] = schema.text;
    return one;
}

}  // namespace

std::int64_t FoxgloveSource::system_offset() {
    return clock_ns(CLOCK_REALTIME) - clock_ns(CLOCK_MONOTONIC);
}

struct FoxgloveSource::Impl {
    Impl(std::function<FoxgloveLook()> look, std::function<std::int64_t()> realtime_offset)
        : look_(std::move(look)), realtime_offset_(std::move(realtime_offset)), offset_(realtime_offset_()) {
        session = std::to_string(clock_ns(CLOCK_REALTIME));
    }

    /// Looks, once a tick.
    void tick(Time now) {
        if (ticked_ && now == *ticked_) return;
        ticked_ = now;
        now_ = look_();
        // A clock that is slewed gives another offset each time: adopting each would shake the stamps.
        if (const std::int64_t offset = realtime_offset_(); std::abs(offset - offset_) > millisecond)
            offset_ = offset;
        find_channels();
        for (auto& [id, open] : channels)
            if (open.subscribers > 0) make(open, now);
    }
    const FoxgloveLook& look() const { return now_; }

    /// The scene's changes for one subscription; none: nothing has changed.
    std::optional<Stamped> changes(const Open& open, FoxgloveScene& scene) const {
        const SeenDevice& device = now_.devices[open.device];
        const std::vector<messages::Marker> markers = scene.changes(device, *ticked_);
        if (markers.empty()) return std::nullopt;
        return Stamped{stamp(device),
                       messages::markers_message(messages::base_frame(name(device)), stamp(device), markers)};
    }
    void subscribe(std::uint32_t channel) { ++channels.at(channel).subscribers; }
    void unsubscribe(std::uint32_t channel) {
        const auto found = channels.find(channel);
        if (found == channels.end() || --found->second.subscribers > 0) return;
        found->second.reports.clear();
        found->second.made.reset();
        found->second.made_since = false;  // what it holds grows old
    }

    std::map<std::uint32_t, Open> channels;  // by number; numbers are not used again
    std::uint64_t version = 0;               // of the list of channels
    std::string session;

  private:
    static std::string name(const SeenDevice& device) { return protocol::printable(device.info.name); }
    std::int64_t stamp(const SeenDevice& device) const {
        return device.newest ? device.newest->read_ns + offset_ : clock_ns(CLOCK_MONOTONIC) + offset_;
    }

    void find_channels() {
        std::vector<std::string> names;
        if (now_.connected)
            for (const SeenDevice& device : now_.devices) names.push_back(name(device));
        if (version > 0 && names == names_ && (names.empty() || now_.epoch == epoch_)) return;
        names_ = std::move(names);
        epoch_ = now_.epoch;
        ++version;
        // Those of all devices stay.
        std::erase_if(channels, [](const auto& one) {
            return messages::channels()[static_cast<std::size_t>(one.second.channel)].of_device;
        });
        for (const messages::ChannelInfo& info : messages::channels())
            if (info.of_device)
                for (std::size_t i = 0; i < names_.size(); ++i) open(info.channel, i);
            else if (version == 1)
                open(info.channel, 0);
    }
    void open(Channel channel, std::size_t device) {
        Open& one = channels[next_++];
        one.channel = channel;
        one.device = device;
        one.topic = messages::topic(channel, device < names_.size() ? names_[device] : "");
    }

    static void step(Open& open) {
        ++open.sequence;
        open.made_since = true;
    }
    void make(Open& open, Time now) {
        switch (open.channel) {
            case Channel::tf:
                return make_transforms(open);
            case Channel::diagnostics:
                return make_diagnostics(open, now);
            default:
                return make(open, now_.devices[open.device], now);
        }
    }
    void make(Open& open, const SeenDevice& device, Time now) {
        if (open.channel == Channel::report) {
            for (const Report& report : device.fresh) {
                open.reports.push_back({report.read_ns + offset_, messages::report_message(report)});
                if (open.reports.size() > most_reports) open.reports.pop_front();
                step(open);
            }
            return;
        }
        if (open.channel == Channel::scene) return;  // each subscription has changes of its own
        if (open.channel == Channel::parameters) return make_parameters(open, device, now);
        if (!device.newest || (open.made_since && device.newest->cycle == open.cycle)) return;
        const Report& report = *device.newest;
        open.cycle = report.cycle;
        open.newest = {stamp(device), encoded(open.channel, device, report)};
        step(open);
    }
    Bytes encoded(Channel channel, const SeenDevice& device, const Report& report) const {
        const std::string called = name(device);
        const std::int64_t at = stamp(device);
        switch (channel) {
            case Channel::measured_cf:
                return messages::wrench_message(called, at, report);
            case Channel::measured_cv:
                return messages::twist_message(called, at, report);
            case Channel::measured_js:
                return messages::joints_message(called, at, report, device.info.joints);
            case Channel::joy:
                return messages::joy_message(called, at, report);
            default:
                return messages::pose_message(called, at, report);
        }
    }
    void make_transforms(Open& open) {
        std::vector<std::string> names;
        std::vector<messages::HandTransform> all;
        std::uint64_t cycles = 0;
        if (now_.connected)
            for (const SeenDevice& device : now_.devices) {
                if (!device.newest) continue;
                cycles += device.newest->cycle;
                names.push_back(name(device));
                all.push_back({.device = {}, .stamp_ns = stamp(device), .report = &*device.newest});
            }
        if (all.empty() || (open.made_since && cycles == open.cycle)) return;
        std::int64_t newest = all.front().stamp_ns;
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i].device = names[i];
            newest = std::max(newest, all[i].stamp_ns);
        }
        open.cycle = cycles;
        open.newest = {newest, messages::transforms_message(all)};
        step(open);
    }
    void make_diagnostics(Open& open, Time now) {
        if (open.made && now - *open.made < diagnostics_every) return;
        open.made = now;
        const std::int64_t at = clock_ns(CLOCK_MONOTONIC) + offset_;
        std::vector<messages::Diagnostic> all;
        if (now_.connected)
            for (const SeenDevice& device : now_.devices) all.push_back(diagnostic_of(device));
        else
            all.push_back({.level = messages::Diagnostic::error,
                           .name = "knurl: " + protocol::printable(now_.name),
                           .message = now_.trouble,
                           .hardware_id = {},
                           .values = {}});
        open.newest = {at, messages::diagnostics_message(at, all)};
        step(open);
    }
    void make_parameters(Open& open, const SeenDevice& device, Time now) {
        if (open.made && (open.version == device.scene_version || now - *open.made < parameters_every))
            return;
        open.made = now;
        open.version = device.scene_version;
        open.newest = {stamp(device), bytes_of(parameters_of(device).dump())};
        step(open);
    }

    std::function<FoxgloveLook()> look_;
    std::function<std::int64_t()> realtime_offset_;
    std::int64_t offset_;
    std::optional<Time> ticked_;
    FoxgloveLook now_;
    std::vector<std::string> names_;
    std::uint64_t epoch_ = 0;
    std::uint32_t next_ = 1;
};

namespace {

/// Level of a status message.
enum Level : int { warning = 1, error = 2 };

class FoxgloveSocket : public SocketHandler {
  public:
    FoxgloveSocket(FoxgloveSource::Impl& source, Socket& socket) : source_(source), socket_(socket) {
        Json info = Json::object();
        info["op"] = "serverInfo";
        info["name"] = "Knurl";
        info["capabilities"] = Json::array();        // it publishes, no more
        info["supportedEncodings"] = Json::array();  // of what a peer would publish
        info["metadata"] = Json::object();
        info["sessionId"] = source_.session;
        socket_.send_text(info.dump());
    }
    ~FoxgloveSocket() override {
        for (const auto& [id, subscription] : subscriptions_) source_.unsubscribe(subscription.channel);
    }

    void text(std::string_view message) override {
        if (message.size() > longest_request)
            return status(error, fmt::format("a request has {} bytes; {} is the most", message.size(),
                                             longest_request));
        try {
            request(Json::parse(message));
        } catch (const JsonError& bad) {
            status(error, "a request is not understood: " + words::printable(bad.what(), 200));
        }
    }

    void binary(std::span<const std::byte>) override {
        status(error, "publishing and services are not offered here");
    }

    void tick(Time now) override {
        source_.tick(now);
        advertise();
        tell_trouble();
        // What a slow peer misses, it misses: it gets the newest when it has read what was sent.
        if (!socket_.idle()) return;
        for (auto& [id, subscription] : subscriptions_) send(id, subscription);
    }

  private:
    struct Subscription {
        std::uint32_t channel = 0;
        std::uint64_t seen = 0;
        FoxgloveScene scene;
    };

    void status(Level level, const std::string& text, const char* id = nullptr) {
        Json message = Json::object();
        message["op"] = "status";
        message["level"] = static_cast<int>(level);
        message["message"] = text;
        if (id != nullptr) message["id"] = id;
        socket_.send_text(message.dump());
    }

    void advertise() {
        if (version_ == source_.version) return;
        version_ = source_.version;
        Json gone = Json::array(), come = Json::array();
        for (auto one = advertised_.begin(); one != advertised_.end();) {
            if (source_.channels.contains(*one)) {
                ++one;
                continue;
            }
            gone.push_back(*one);
            std::erase_if(subscriptions_, [&](const auto& held) { return held.second.channel == *one; });
            one = advertised_.erase(one);
        }
        for (const auto& [id, open] : source_.channels)
            if (advertised_.insert(id).second) come.push_back(advertisement(id, open));
        send_list("unadvertise", "channelIds", std::move(gone));
        send_list("advertise", "channels", std::move(come));
    }
    void send_list(const char* op, const char* name, Json list) {
        if (list.empty()) return;
        Json message = Json::object();
        message["op"] = op;
        message[name] = std::move(list);
        socket_.send_text(message.dump());
    }

    void tell_trouble() {
        const std::string& trouble = source_.look().trouble;
        if (trouble == trouble_) return;
        trouble_ = trouble;
        if (!trouble.empty()) return status(warning, trouble, "servo");
        Json message = Json::object();
        message["op"] = "removeStatus";
        message["statusIds"] = Json::array({"servo"});
        socket_.send_text(message.dump());
    }

    /// A number of 32 bits; none: it is no such number.
    static std::optional<std::uint32_t> number_of(const Json& value) {
        if (!value.is_number_integer() || value < 0 || value > 0xffffffffU) return std::nullopt;
        return static_cast<std::uint32_t>(value.get<std::uint64_t>());
    }

    void request(const Json& message) {
        if (!message.is_object()) throw JsonError("it is no object");
        const std::string op = message.at("op").get<std::string>();
        if (op == "subscribe") return subscribe(message.at("subscriptions"));
        if (op == "unsubscribe") return unsubscribe(message.at("subscriptionIds"));
        status(error, fmt::format("'{}' is not offered here", words::printable(op, 64)));
    }

    /// One status for all that was wrong of a request, so that an answer is no longer than what it answers.
    void refuse(const std::vector<std::string>& wrong) {
        constexpr std::size_t most = 8;
        if (wrong.empty()) return;
        std::string all = wrong.front();
        for (std::size_t i = 1; i < std::min(wrong.size(), most); ++i) all += "; " + wrong[i];
        if (wrong.size() > most) all += fmt::format("; and {} more", wrong.size() - most);
        status(error, all);
    }

    void subscribe(const Json& wanted) {
        if (!wanted.is_array()) throw JsonError("subscriptions are no list");
        std::vector<std::string> wrong;
        for (const Json& one : wanted) {
            const auto id = number_of(one.at("id")), channel = number_of(one.at("channelId"));
            if (!id || !channel)
                wrong.emplace_back("a subscription's id or channelId is no number of 32 bits");
            else if (!advertised_.contains(*channel) || !source_.channels.contains(*channel))
                wrong.push_back(fmt::format("there is no channel {}", *channel));
            else if (subscriptions_.contains(*id))
                wrong.push_back(fmt::format("there is a subscription {} already", *id));
            else if (subscriptions_.size() >= most_subscriptions)
                wrong.push_back(fmt::format("{} subscriptions are the most", most_subscriptions));
            else {
                subscriptions_[*id].channel = *channel;
                // Of reports it gets those that come from now on.
                if (const Open& open = source_.channels.at(*channel); open.channel == Channel::report)
                    subscriptions_[*id].seen = open.sequence;
                source_.subscribe(*channel);
            }
        }
        refuse(wrong);
    }
    void unsubscribe(const Json& ids) {
        if (!ids.is_array()) throw JsonError("subscriptionIds are no list");
        std::vector<std::string> wrong;
        for (const Json& one : ids) {
            const auto id = number_of(one);
            const auto found = id ? subscriptions_.find(*id) : subscriptions_.end();
            if (found == subscriptions_.end()) {
                wrong.push_back(id ? fmt::format("there is no subscription {}", *id)
                                   : "a subscription's id is no number of 32 bits");
                continue;
            }
            source_.unsubscribe(found->second.channel);
            subscriptions_.erase(found);
        }
        refuse(wrong);
    }

    void send(std::uint32_t id, Subscription& subscription) {
        Open& open = source_.channels.at(subscription.channel);
        if (open.channel == Channel::scene) {
            if (const auto changes = source_.changes(open, subscription.scene)) send(id, *changes);
            return;
        }
        if (!open.made_since || subscription.seen == open.sequence) return;
        const std::uint64_t seen = std::exchange(subscription.seen, open.sequence);
        if (open.channel != Channel::report) return send(id, open.newest);
        for (std::size_t i =
                 open.reports.size() - std::min<std::uint64_t>(open.reports.size(), open.sequence - seen);
             i < open.reports.size(); ++i)
            send(id, open.reports[i]);
    }
    /// u8 1, u32 subscription, u64 time, the message; little endian.
    void send(std::uint32_t id, const Stamped& message) {
        constexpr std::byte message_data{1};
        const auto time = static_cast<std::uint64_t>(message.ns);
        std::vector<std::byte> frame(1 + sizeof id + sizeof time + message.bytes.size());
        frame[0] = message_data;
        std::memcpy(frame.data() + 1, &id, sizeof id);
        std::memcpy(frame.data() + 1 + sizeof id, &time, sizeof time);
        if (!message.bytes.empty())
            std::memcpy(frame.data() + 1 + sizeof id + sizeof time, message.bytes.data(),
                        message.bytes.size());
        socket_.send_binary(std::move(frame));
    }

    FoxgloveSource::Impl& source_;
    Socket& socket_;
    std::uint64_t version_ = 0;
    std::set<std::uint32_t> advertised_;
    std::map<std::uint32_t, Subscription> subscriptions_;
    std::string trouble_;
};

}  // namespace

FoxgloveSource::FoxgloveSource(std::function<FoxgloveLook()> look,
                               std::function<std::int64_t()> realtime_offset)
    : impl_(std::make_unique<Impl>(std::move(look), std::move(realtime_offset))) {}
FoxgloveSource::~FoxgloveSource() = default;

std::unique_ptr<SocketHandler> FoxgloveSource::handler(Socket& socket) {
    return std::make_unique<FoxgloveSocket>(*impl_, socket);
}

}  // namespace knurl::gateway
