#pragma once
// What stands around a session in tests: a hand that writes down what it is told, senders that a test sets, a clock that
// stands still, and a client's own numbering of senders and types.

#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <knurl/reps/check.hpp>
#include <knurl/reps/shape.hpp>
#include <knurl/vrpn/messages.hpp>
#include <knurl/vrpn/session.hpp>

namespace vrpn_test {

using namespace knurl;
using namespace knurl::vrpn;
using namespace std::chrono_literals;

/// What a hand was told. It outlives the hand.
struct Told {
    struct Item {
        Kind kind = 0;
        std::vector<std::byte> params;
        std::shared_ptr<const gateway::PeerMesh> mesh{};
    };
    std::map<std::string, Item> items;
    std::vector<std::string> calls;
    std::vector<gateway::Said> to_say;
    gateway::PeerStatus status;
    int sent = 0;
    bool alive = false;

    template <class R>
    R get(const std::string& name) const {
        R params;
        const Item& item = items.at(name);
        if (item.kind != kind_number<R>() || item.params.size() != sizeof params)
            throw std::runtime_error(name + " is another kind");
        std::memcpy(&params, item.params.data(), sizeof params);
        return params;
    }
};

class FakeHand final : public gateway::PeerCommands {
  public:
    explicit FakeHand(Told& told) : told_(told) { told_.alive = true; }
    ~FakeHand() override { told_.alive = false; }
    std::string push(const Vec3&, const Vec3&, std::string_view) override { return "no"; }
    std::string pull(const Vec3&, std::string_view) override { return "no"; }
    std::string add(const std::string& name, Kind kind, const std::vector<std::byte>& params,
                    const AddOptions&) override {
        told_.calls.push_back("add " + name);
        told_.items[name] = {kind, params};
        return {};
    }
    std::string mesh(const std::string& name, std::shared_ptr<const gateway::PeerMesh> mesh,
                     const std::vector<std::byte>& shape) override {
        told_.calls.push_back("mesh " + name);
        told_.items[name] = {kind_number<Shape>(), shape, std::move(mesh)};
        return {};
    }
    std::string set(const std::string& name, const std::vector<std::byte>& params) override {
        told_.calls.push_back("set " + name);
        told_.items.at(name).params = params;
        return {};
    }
    std::string remove(const std::string& name) override {
        told_.calls.push_back("remove " + name);
        told_.items.erase(name);
        return {};
    }
    void clear() override { told_.items.clear(); }
    void sent() override { ++told_.sent; }
    gateway::PeerStatus status() const override { return told_.status; }
    std::vector<gateway::Said> said() override { return std::exchange(told_.to_say, {}); }

  private:
    Told& told_;
};

/// A message as the client got it.
struct Got {
    Service service = Service::reliable;
    Header header;
    std::vector<std::byte> payload;
};

class FakeAround final : public Surroundings {
  public:
    FakeAround() {
        SenderInfo& info = list.emplace_back();
        info.name = "Phantom0";
        info.device.emplace();
        info.device->name = "right";
        info.device->rate = 1000;
        info.device->max_stiffness = 2000;
        info.device->workspace_radius = 0.1;
    }
    void send(Service service, std::span<const std::byte> messages) override {
        if (service == Service::quick && messages.size() > most_datagram) ++too_long;
        Message message;
        while (!messages.empty()) {
            if (split(messages, message) != Split::whole)
                throw std::runtime_error("what is sent is not whole");
            got.push_back({service, message.header, {message.payload.begin(), message.payload.end()}});
        }
    }
    void takes_datagrams(std::uint16_t port) override { datagrams_to = port; }
    std::span<const SenderInfo> senders() const override { return list; }
    std::string hold(std::size_t) override {
        ++holds;
        return refuse_hold;
    }
    std::unique_ptr<gateway::PeerCommands> make_hand(std::size_t) override {
        return std::make_unique<FakeHand>(told);
    }
    std::int64_t wall_clock() const override { return wall; }
    void log(const std::string& line) override { lines.push_back(line); }

    /// What was sent of this type since the call before, and forgets all else.
    std::vector<Got> take(Type type) {
        std::vector<Got> found;
        for (Got& each : std::exchange(got, {}))
            if (each.header.type == static_cast<std::int32_t>(type)) found.push_back(std::move(each));
        return found;
    }

    std::vector<SenderInfo> list;
    Told told;
    std::vector<Got> got;
    std::vector<std::string> lines;
    std::string refuse_hold;
    int datagrams_to = 0, holds = 0, too_long = 0;
    std::int64_t wall = 1'700'000'000'123'456'789;
};

/// A client that has described itself with numbers of its own: the sender is 7, type t is t + 100.
struct FakeClient {
    explicit FakeClient(SessionOptions given = {}) : options(given) {
        session.begin("127.0.0.1", 4000, now);
        PayloadWriter out;
        put_name(out, "Phantom0");
        system(system_type::sender, sender, out.bytes());
        for (std::size_t i = 0; i < type_count; ++i) {
            out.clear();
            put_name(out, name_of(static_cast<Type>(i)));
            system(system_type::type, static_cast<std::int32_t>(i) + 100, out.bytes());
        }
        around.got.clear();
    }
    std::string system(std::int32_t type, std::int32_t id, std::span<const std::byte> payload) {
        return session.receive({.header = {.sender = id, .type = type}, .payload = payload},
                               Service::reliable, now);
    }
    std::string say(Type type, const PayloadWriter& out = {}, Service service = Service::reliable) {
        const Header header{.seconds = static_cast<std::int32_t>(stamp / 1'000'000),
                            .microseconds = static_cast<std::int32_t>(stamp % 1'000'000),
                            .sender = sender,
                            .type = static_cast<std::int32_t>(type) + 100,
                            .sequence = sequence++};
        ++stamp;
        const std::string why = session.receive({header, out.bytes()}, service, now);
        session.received(now);
        return why;
    }
    /// a, b, c, d, kspring, kdamp, dynamic, static friction.
    std::string plane(const std::array<float, 8>& values, std::int32_t index = 0, std::int32_t recovery = 10,
                      Service service = Service::quick) {
        PayloadWriter out;
        for (const float value : values) out.put(value);
        out.put(index).put(recovery);
        return say(Type::plane, out, service);
    }
    std::string floats(Type type, const std::vector<float>& values, std::optional<std::int32_t> object = {}) {
        PayloadWriter out;
        if (object) out.put(*object);
        for (const float value : values) out.put(value);
        return say(type, out);
    }
    std::string numbers(Type type, const std::vector<std::int32_t>& values) {
        PayloadWriter out;
        for (const std::int32_t value : values) out.put(value);
        return say(type, out);
    }
    /// The text that came, and nothing if none came.
    std::string text() {
        const auto all = around.take(Type::text);
        if (all.empty()) return {};
        return reinterpret_cast<const char*>(all.front().payload.data() + 8);
    }

    static constexpr std::int32_t sender = 7;
    SessionOptions options;
    FakeAround around;
    Session::Time now{1h};
    std::int64_t stamp = 1'000'000;  // us
    std::uint32_t sequence = 0;
    std::unique_ptr<Session> owned = std::make_unique<Session>(options, around);
    Session& session = *owned;
};

}  // namespace vrpn_test
