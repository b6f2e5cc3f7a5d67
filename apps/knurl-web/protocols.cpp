#include "protocols.hpp"

#include <utility>

#include <knurl/json/json.hpp>

namespace knurl::web {

namespace {

/// Stands in for a protocol that is not there yet: says who is there, and no more.
class NothingYet final : public gateway::SocketHandler {
  public:
    NothingYet(gateway::Socket& socket, const Settings& settings) {
        constexpr const char* roles[] = {"observe", "render", "control"};
        Json hello = Json::object();
        hello["op"] = "hello";
        hello["version"] = 1;
        hello["role"] = roles[static_cast<int>(socket.role())];
        hello["kinds"] = Json::array();
        hello["simulated"] = false;
        hello["recordings"] = settings.recordings;
        socket.send_text(hello.dump());
        Json servo = Json::object();
        servo["op"] = "servo";
        servo["connected"] = false;
        servo["name"] = settings.servo;
        servo["pid"] = 0;
        servo["trouble"] = "this build does not look at servos yet";
        servo["devices"] = Json::array();
        socket.send_text(servo.dump());
    }
    void text(std::string_view) override {}
    void binary(std::span<const std::byte>) override {}
    void tick(std::chrono::steady_clock::time_point) override {}
};

}  // namespace

struct Protocols::Impl {
    Settings settings;
    // Here: the LiveView that all handlers share.
};

Protocols::Protocols(Settings settings) : impl_(std::make_unique<Impl>(Impl{std::move(settings)})) {}
Protocols::~Protocols() = default;

void Protocols::tick(std::chrono::steady_clock::time_point) {}

std::string Protocols::remark() const {
    return {};
}

gateway::MakeHandler Protocols::make_live_handler() {
    return [this](gateway::Socket& socket, const std::string&) {
        return std::make_unique<NothingYet>(socket, impl_->settings);
    };
}

std::vector<gateway::HttpRoute> Protocols::page_routes() {
    return {};
}

gateway::MakeHandler Protocols::make_foxglove_handler() {
    return [](gateway::Socket&, const std::string&) { return nullptr; };
}

gateway::MakeHandler Protocols::make_inverse_handler() {
    return [](gateway::Socket&, const std::string&) { return nullptr; };
}

gateway::MakeHandler Protocols::make_inverse_events_handler() {
    return [](gateway::Socket&, const std::string&) { return nullptr; };
}

std::vector<gateway::HttpRoute> Protocols::inverse_routes() {
    return {};
}

}  // namespace knurl::web
