// knurl-web: one servo in a browser, in Foxglove, and for programs that speak the Inverse Service's protocol.

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/gateway/server.hpp>
#include <knurl/protocol/servo_address.hpp>

#include "bundle.hpp"
#include "protocols.hpp"

namespace {

namespace gateway = knurl::gateway;
namespace commandline = knurl::commandline;
using commandline::UsageError;

constexpr std::size_t longest_mesh = std::size_t{64} << 20;

struct CommandLine {
    knurl::web::Settings settings;
    std::vector<std::string> listen;
    std::string inverse = "127.0.0.1:10001";
    std::uint16_t inverse_events = 10020;
    bool no_inverse = false, open = false;
    std::string foxglove_role = "observe";
    std::vector<std::string> origins, hosts;
    std::string certificate, private_key, keys;
};

std::atomic<bool> wants_token{false}, reads_keys{false};

gateway::Role role_said(const std::string& word) {
    return word == "control"  ? gateway::Role::control
           : word == "render" ? gateway::Role::render
                              : gateway::Role::observe;
}

struct Place {
    std::string address;  // digits
    std::uint16_t port = 0;
    bool this_host = true;
};

Place place(const std::string& said, const std::string& option) try {
    const knurl::bridge::Endpoint endpoint = knurl::bridge::resolve(said);
    std::string address = knurl::bridge::numeric(endpoint.address);
    address.resize(address.rfind(':'));
    if (address.starts_with('[')) address = address.substr(1, address.size() - 2);
    return {.address = address, .port = endpoint.port(), .this_host = endpoint.loopback()};
} catch (const std::runtime_error& error) {
    throw UsageError(option + ": " + error.what());
}

std::string url(const char* scheme, const Place& at, std::uint16_t port) {
    return fmt::format(
        at.address.find(':') == std::string::npos ? fmt::runtime("{}://{}:{}") : fmt::runtime("{}://[{}]:{}"),
        scheme, at.address, port);
}

/// A page of another origin can send to localhost, so only those that are named may use what needs no session.
gateway::Site page_site(const CommandLine& said, knurl::web::Protocols& protocols) {
    gateway::Site site{.login = true, .hosts = said.hosts, .option = "--listen"};
    gateway::Access page;
    if (said.open) page.without_key = gateway::Role::observe;
    for (const gateway::StaticFile& file : knurl::web::page_files())
        site.http.push_back(gateway::route_of(file, page));
    for (gateway::HttpRoute& route : protocols.page_routes()) {
        route.access.without_key = page.without_key;
        site.http.push_back(std::move(route));
    }
    site.sockets.push_back({.path = "/live",
                            .subprotocols = {"knurl.live.v1"},
                            .access = page,
                            .most_message = std::size_t{1} << 20,
                            .make = protocols.make_live_handler()});
    const gateway::Access foxglove{.without_key = role_said(said.foxglove_role), .origins = said.origins};
    for (const char* path : {"/foxglove", "/"})
        site.sockets.push_back({.path = path,
                                .subprotocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"},
                                .access = foxglove,
                                .most_message = std::size_t{1} << 20,
                                .make = protocols.make_foxglove_handler()});
    return site;
}

/// Clients of the Inverse Service show no key: on this host they may do all, with the devices that are named.
gateway::Site inverse_site(const CommandLine& said, knurl::web::Protocols& protocols, bool events) {
    gateway::Site site{.hosts = said.hosts,
                       .option = events ? "--inverse-events, or --no-inverse" : "--inverse, or --no-inverse"};
    const gateway::Access access{.without_key = gateway::Role::control, .origins = said.origins};
    if (!events)
        for (gateway::HttpRoute& route : protocols.inverse_routes()) {
            route.access = access;
            site.http.push_back(std::move(route));
        }
    site.sockets.push_back(
        {.path = "/",
         .access = access,
         .most_message = std::size_t{256} << 10,
         .most_sockets = 64,
         .make = events ? protocols.make_inverse_events_handler() : protocols.make_inverse_handler()});
    return site;
}

/// Where it listens.
struct Addresses {
    std::optional<std::string> page;  // where a token is good
    std::string text;                 // lines about the others
};

void listen_for_pages(gateway::Server& server, const CommandLine& said, knurl::web::Protocols& protocols,
                      Addresses& addresses) {
    for (const std::string& each : said.listen) {
        const Place at = place(each, "--listen");
        const std::uint16_t port = server.listen(at.address, at.port, page_site(said, protocols));
        const std::string base = url(at.this_host ? "http" : "https", at, port);
        if (at.this_host && !addresses.page) addresses.page = base;
        if (!at.this_host) addresses.text += fmt::format("  from other hosts: {}/?key=KEY\n", base);
        addresses.text +=
            fmt::format("  Foxglove: {}/foxglove ({})\n", url(at.this_host ? "ws" : "wss", at, port),
                        at.this_host ? said.foxglove_role : "with a key");
    }
}

void listen_for_inverse(gateway::Server& server, const CommandLine& said, knurl::web::Protocols& protocols,
                        Addresses& addresses, bool must) try {
    const Place at = place(said.inverse, "--inverse");
    // If the other port is taken, the one that takes commands is not opened.
    const std::uint16_t events =
        server.listen(at.address, said.inverse_events, inverse_site(said, protocols, true));
    const std::uint16_t port = server.listen(at.address, at.port, inverse_site(said, protocols, false));
    addresses.text += fmt::format("  Inverse Service: {}, events at port {}\n",
                                  url(at.this_host ? "ws" : "wss", at, port), events);
} catch (const std::runtime_error& error) {
    if (must) throw;
    // Haply's own service may have these ports, or another knurl-web: the page is useful without.
    addresses.text += fmt::format("  no Inverse Service: {}\n", error.what());
}

void read_keys_again(gateway::Server& server, const std::string& file) {
    try {
        server.read_keys_again();
        fmt::print("knurl-web: {}: read again\n", file);
    } catch (const std::exception& error) {
        fmt::print("knurl-web: {}; the keys stay as they were\n", error.what());
    }
    std::fflush(stdout);
}

int serve(CommandLine said, bool inverse_given) {
    try {
        knurl::protocol::servo_address(said.settings.servo);
    } catch (const std::runtime_error& error) {
        throw UsageError(std::string("--servo ") + error.what());
    }
    if (said.listen.empty()) said.listen = {"127.0.0.1:8080"};
    commandline::stop_on_signals();
    std::signal(SIGUSR1, [](int) { wants_token = true; });
    // Without a file of keys it is what it always is: the terminal was closed.
    if (!said.keys.empty()) std::signal(SIGHUP, [](int) { reads_keys = true; });

    gateway::ServerOptions options;
    options.certificate = said.certificate;
    options.private_key = said.private_key;
    options.keys = said.keys;
    options.log = [](const std::string& line) { fmt::print(stderr, "knurl-web: {}\n", line); };
    // Before the server: its sockets use them to the end.
    knurl::web::Protocols protocols(said.settings);
    gateway::Server server(std::move(options));

    Addresses addresses;
    listen_for_pages(server, said, protocols, addresses);
    if (!said.no_inverse) listen_for_inverse(server, said, protocols, addresses, inverse_given);

    const auto login = [&] {
        return addresses.page ? fmt::format("{}/?token={}", *addresses.page, server.new_token())
                              : std::string("(on no address of this host)");
    };
    fmt::print("knurl-web: servo '{}' is at {}\n{}  another token: kill -USR1 {}\n{}", said.settings.servo,
               login(), addresses.text, ::getpid(), protocols.remark());
    std::fflush(stdout);
    server.on_tick([&](std::chrono::steady_clock::time_point now) {
        if (commandline::stop) return server.stop();
        if (wants_token.exchange(false)) {
            fmt::print("knurl-web: {}\n", login());
            std::fflush(stdout);
        }
        if (reads_keys.exchange(false)) read_keys_again(server, said.keys);
        protocols.tick(now);
    });
    server.run();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    CommandLine said;
    commandline::Command app("knurl-web",
                             "Shows a servo in a browser, and serves it to Foxglove and to programs that "
                             "speak Haply's Inverse Service.\n"
                             "It is an ordinary client of the servo. It serves this host only, unless it has "
                             "a certificate and keys.");
    app.servo(said.settings.servo, "The servo's name").shows_default();
    app.option("--listen", said.listen, "HOST:PORT of page and Foxglove (127.0.0.1:8080); may be repeated")
        .type_name("HOST:PORT");
    app.flag("--open", said.open, "Who has no token may look: every user of this host sees what is felt");
    app.option("--host", said.hosts,
               "A further name of this host in addresses: lab.example, or localhost:9000 of a tunnel");
    app.option("--allow-origin", said.origins,
               "A page that may use Foxglove's and the Inverse Service's sockets, as "
               "https://app.foxglove.dev")
        .type_name("ORIGIN");
    app.option("--foxglove-role", said.foxglove_role, "What Foxglove on this host may do")
        .one_of({"observe", "render", "control"})
        .shows_default();
    auto& inverse = app.option("--inverse", said.inverse, "HOST:PORT of the Inverse Service")
                        .type_name("HOST:PORT")
                        .shows_default();
    auto& events = app.option("--inverse-events", said.inverse_events, "Its port of events")
                       .type_name("PORT")
                       .shows_default();
    app.option("--inverse-device", said.settings.inverse_devices,
               "A device that its clients may move; may be repeated. Without it, the simulated ones")
        .type_name("NAME");
    app.flag("--no-inverse", said.no_inverse, "Without the Inverse Service");
    app.option("--tls-certificate", said.certificate,
               "Certificate chain (PEM), for addresses of other hosts");
    app.option("--tls-key", said.private_key, "Its private key (PEM, mode 0600)");
    app.option("--keys", said.keys,
               "Who may connect from other hosts: keys as of `knurl-bridge keygen` (mode 0600); read again "
               "on SIGHUP");
    app.option("--recordings", said.settings.recordings,
               "Folder for recordings that the page makes; none: it makes none")
        .type_name("DIR");
    app.footer(fmt::format(
        "The address that it prints has a token, which is good for one login; SIGUSR1 makes it print "
        "another. "
        "Bounds:\n{} connections, {} of one address; {} MiB for a mesh; {} MiB that a socket leaves unread.",
        gateway::ServerOptions{}.most_connections, gateway::ServerOptions{}.most_of_address,
        longest_mesh >> 20, gateway::ServerOptions{}.most_waiting >> 20));
    app.action([&] { return serve(said, inverse.given() || events.given()); });
    return commandline::run(app, argc, argv);
}
