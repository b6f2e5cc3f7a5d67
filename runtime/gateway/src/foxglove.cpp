#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <knurl/gateway/foxglove.hpp>
#include <knurl/json/json.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/words/printable.hpp>

#include "foxglove_channels.hpp"

namespace knurl::gateway {

namespace {

using messages::Channel;
using Time = std::chrono::steady_clock::time_point;

Json advertisement(std::uint32_t id, const FoxgloveChannel& open) {
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
                if (const FoxgloveChannel& open = source_.channels.at(*channel);
                    open.channel == Channel::report)
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
        FoxgloveChannel& open = source_.channels.at(subscription.channel);
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
    void send(std::uint32_t id, const FoxgloveMessage& message) {
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
