#include "protocols.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/gateway/foxglove.hpp>
#include <knurl/gateway/inverse.hpp>
#include <knurl/gateway/live_page.hpp>
#include <knurl/gateway/live_view.hpp>
#include <knurl/json/json.hpp>

namespace knurl::web {

namespace {

gateway::Response json(const Json& body, unsigned status = 200) {
    return {.status = status, .content_type = "application/json", .body = body.dump()};
}

/// A number of the path or of a query; none: it is no number.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::string of(const std::map<std::string, std::string>& query, const std::string& name) {
    const auto found = query.find(name);
    return found == query.end() ? std::string() : found->second;
}

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
    explicit Impl(Settings stated)
        : settings(std::move(stated)),
          view(settings.servo),
          page(view, {.servo = settings.servo,
                      .recordings = settings.recordings,
                      .knurl_program = commandline::program_beside("knurl"),
                      .log = [](const std::string& line) { fmt::print(stderr, "knurl-web: {}\n", line); }}),
          foxglove([this] { return gateway::foxglove_look(view); }) {}

    gateway::Response mesh(const gateway::Request& request);
    gateway::Response asset(const gateway::Request& request) const;

    Settings settings;
    gateway::LiveView view;
    gateway::LivePage page;
    gateway::Inverse inverse = inverse_of(settings);
    gateway::FoxgloveSource foxglove;
};

gateway::Response Protocols::Impl::mesh(const gateway::Request& request) {
    try {
        const auto device = number_in<std::size_t>(of(request.query, "device"));
        if (!device) throw std::runtime_error("mesh: say which device, as ?device=0&name=bunny.stl");
        page.take_mesh(request.session, *device, of(request.query, "name"), of(request.query, "unit"),
                       request.body);
        return json({{"ok", true}});
    } catch (const std::exception& error) {
        return json({{"ok", false}, {"error", error.what()}}, 400);
    }
}

/// GET /asset/DEVICE/CLAIM/ASSET
gateway::Response Protocols::Impl::asset(const gateway::Request& request) const {
    std::string_view rest = std::string_view(request.path).substr(std::string_view("/asset/").size());
    std::array<std::optional<std::uint64_t>, 3> numbers;
    for (auto& number : numbers) {
        const std::size_t end = std::min(rest.find('/'), rest.size());
        number = number_in<std::uint64_t>(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    const bool numbered = numbers[0] && numbers[1] && numbers[2] && *numbers[2] <= 64;
    auto bytes = numbered ? page.asset(*numbers[0], *numbers[1], static_cast<std::uint32_t>(*numbers[2]))
                          : std::nullopt;
    if (!bytes)
        return {.status = 404,
                .body = "no such asset, or it is not known yet; the path is /asset/DEVICE/CLAIM/ASSET\n"};
    return {.content_type = "application/octet-stream", .body = std::move(*bytes)};
}

Protocols::Protocols(Settings settings) : impl_(std::make_unique<Impl>(std::move(settings))) {}
Protocols::~Protocols() = default;

void Protocols::tick(std::chrono::steady_clock::time_point now) {
    impl_->view.tick(now);
    impl_->page.tick(now);
}

std::string Protocols::remark() const {
    impl_->view.tick(std::chrono::steady_clock::now());
    if (impl_->view.connected()) return {};
    return fmt::format("  no servo yet: {}\n", impl_->view.trouble());
}

gateway::MakeHandler Protocols::make_live_handler() {
    return [this](gateway::Socket& socket, const std::string&) { return impl_->page.open(socket); };
}

std::vector<gateway::HttpRoute> Protocols::page_routes() {
    constexpr std::size_t longest_mesh = std::size_t{64} << 20;
    return {{.method = "POST",
             .path = "/mesh",
             .access = {.needs = gateway::Role::render},
             .most_body = longest_mesh,
             .answer = [this](const gateway::Request& request) { return impl_->mesh(request); }},
            {.method = "GET", .path = "/asset/*", .answer = [this](const gateway::Request& request) {
                 return impl_->asset(request);
             }}};
}

gateway::MakeHandler Protocols::make_foxglove_handler() {
    return [this](gateway::Socket& socket, const std::string&) { return impl_->foxglove.handler(socket); };
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
