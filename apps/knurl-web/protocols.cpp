#include "protocols.hpp"

#include <utility>

#include <fmt/format.h>

#include <knurl/gateway/inverse.hpp>
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

/// The service has a look of its own at the servo: it answers each message with the newest report, not the newest tick.
gateway::Inverse inverse_of(const Settings& settings) {
    gateway::InverseOptions options;
    options.servo = settings.servo;
    if (!settings.inverse_devices.empty()) options.claimable = settings.inverse_devices;
    options.version = KNURL_VERSION;
    options.log = [](const std::string& line) { fmt::print(stderr, "knurl-web: {}\n", line); };
    return gateway::make_inverse(std::move(options));
}

}  // namespace

struct Protocols::Impl {
    Settings settings;
    gateway::Inverse inverse = inverse_of(settings);
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
    return impl_->inverse.simulation;
}

gateway::MakeHandler Protocols::make_inverse_events_handler() {
    return impl_->inverse.events;
}

std::vector<gateway::HttpRoute> Protocols::inverse_routes() {
    const auto answer = [this](const gateway::Request& request) {
        const auto session = request.query.find("session");
        const gateway::InverseReply reply =
            impl_->inverse.http({.method = request.method,
                                 .path = request.path,
                                 .session = session == request.query.end() ? std::string() : session->second,
                                 .body = request.body,
                                 .role = request.role});
        return gateway::Response{
            .status = reply.status, .content_type = "application/json", .body = reply.body};
    };
    std::vector<gateway::HttpRoute> routes;
    for (const char* path : {"/version", "/devices", "/inverse3/*"})
        routes.push_back({.method = "GET", .path = path, .answer = answer});
    routes.push_back({.method = "POST", .path = "/inverse3/*", .most_body = 4096, .answer = answer});
    return routes;
}

}  // namespace knurl::web
