// knurl-vrpn: the devices of one servo for programs that speak VRPN 07.

#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/vrpn/server.hpp>

namespace {

namespace vrpn = knurl::vrpn;
namespace commandline = knurl::commandline;
using commandline::UsageError;

struct CommandLine {
    std::string servo = "default";
    std::string listen = "127.0.0.1:3883";
    std::vector<std::string> senders, peers, force_peers;
    std::string axes = "phantom", recovery = "last-depth";
    double rate = 1000, silent_after = 0;
    int buttons = 8;
};

std::vector<vrpn::HostRange> ranges(const std::vector<std::string>& said, const std::string& option) {
    std::vector<vrpn::HostRange> all;
    for (const std::string& each : said) try {
            all.push_back(vrpn::host_range(each));
        } catch (const std::runtime_error& error) {
            throw UsageError(option + ": " + error.what());
        }
    return all;
}

/// "Phantom0=right"; "Phantom0" is the only device.
vrpn::SenderName sender(const std::string& said) {
    const std::size_t equals = said.find('=');
    if (equals == std::string::npos) return {.name = said, .device = ""};
    return {.name = said.substr(0, equals), .device = said.substr(equals + 1)};
}

void place(const std::string& said, vrpn::ServerOptions& options) try {
    const knurl::bridge::Endpoint endpoint =
        knurl::bridge::resolve(said.find(':') == std::string::npos ? said + ":3883" : said);
    const std::string address = knurl::bridge::numeric(endpoint.address);
    options.address = address.substr(0, address.rfind(':'));
    options.port = endpoint.port();
} catch (const std::runtime_error& error) {
    throw UsageError(std::string("--listen: ") + error.what());
}

vrpn::ServerOptions options_of(const CommandLine& said) {
    vrpn::ServerOptions options;
    options.servo = said.servo.find(':') == std::string::npos ? "knurl:" + said.servo : said.servo;
    place(said.listen, options);
    if (!said.senders.empty()) options.senders.clear();
    for (const std::string& each : said.senders) options.senders.push_back(sender(each));
    options.peers = ranges(said.peers, "--peer");
    options.force_peers = ranges(said.force_peers, "--force-peer");
    // Who may command force may connect.
    options.peers.insert(options.peers.end(), options.force_peers.begin(), options.force_peers.end());
    vrpn::SessionOptions& session = options.session;
    if (said.axes == "knurl") session.mapping.axes = knurl::gateway::Axes{};
    session.mapping.update = said.recovery == "paper"        ? knurl::PlaneUpdate::paper
                             : said.recovery == "last-depth" ? knurl::PlaneUpdate::last_depth
                                                             : knurl::PlaneUpdate::fade;
    session.rate = said.rate;
    session.buttons = said.buttons;
    session.silent_after = std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(said.silent_after));
    options.log = [](const std::string& line) { fmt::print(stderr, "knurl-vrpn: {}\n", line); };
    return options;
}

int serve(const CommandLine& said) {
    try {
        knurl::protocol::servo_address(said.servo);
    } catch (const std::runtime_error& error) {
        throw UsageError(std::string("--servo ") + error.what());
    }
    const vrpn::ServerOptions options = options_of(said);
    commandline::stop_on_signals();
    commandline::go_before_others();
    vrpn::Server server(options);
    std::string names;
    for (const vrpn::SenderName& each : options.senders)
        names += fmt::format("  {}@{}:{}{}\n", each.name, options.address, server.port(),
                             each.device.empty() ? "" : ": device '" + each.device + "'");
    fmt::print("knurl-vrpn: servo '{}' for VRPN clients, {}\n{}", said.servo,
               said.force_peers.empty() ? "without force (--force-peer allows it)" : "with force", names);
    std::fflush(stdout);
    server.on_tick([&] {
        if (commandline::stop) server.stop();
    });
    server.run();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    CommandLine said;
    commandline::Command app(
        "knurl-vrpn",
        "Serves the devices of a servo to programs that speak VRPN 07: tracker, buttons and "
        "force device.\n"
        "It is an ordinary client of the servo. It serves this host only, and gives no force, "
        "unless the options say so.");
    app.servo(said.servo, "The servo's name").shows_default();
    app.option("--listen", said.listen, "Address and port of UDP and TCP")
        .type_name("HOST:PORT")
        .shows_default();
    app.option("--sender", said.senders,
               "A name under which clients find a device; may be repeated. Without it: Phantom0, for the "
               "only device")
        .type_name("NAME=DEVICE");
    app.option("--peer", said.peers,
               "A host, or a network, whose clients may connect; may be repeated. This host's always may")
        .type_name("ADDRESS[/BITS]");
    app.option("--force-peer", said.force_peers,
               "A host, or a network, whose clients may connect and command force: localhost, 192.168.1.7; "
               "may be "
               "repeated. Without it nobody does")
        .type_name("ADDRESS[/BITS]");
    app.option("--axes", said.axes,
               "Axes that clients see. phantom: x right, y up, z towards the user; knurl: x towards the "
               "user, y right, z up")
        .one_of({"phantom", "knurl"})
        .shows_default();
    app.option(
           "--recovery", said.recovery,
           "How a plane that changes reaches the hand within a client's recovery time. last-depth: it starts "
           "with the last depth, as VRPN's own; fade: its force is cross-faded; paper: it is lowered to the "
           "hand, then raised")
        .one_of({"last-depth", "fade", "paper"})
        .shows_default();
    app.option("--rate", said.rate, "Most reports a second to a client (Hz); 0: each report of the servo")
        .not_negative()
        .shows_default();
    app.option("--buttons", said.buttons, "Buttons that are reported").within(1, 32).shows_default();
    app.option("--silent-after", said.silent_after,
               "The force of a client that sends nothing for so long fades (s); 0: it lasts while the client "
               "is connected")
        .not_negative()
        .shows_default();
    app.footer(fmt::format(
        "Clients know no keys: whoever can send from a host that is named can do what that host may.\n"
        "Bounds:\n{} clients, {} of one host; {} KiB that a client leaves unread, for {} s; {} planes, {} "
        "objects, {} "
        "vertices and {} triangles of a client.",
        vrpn::ServerOptions{}.most_connections, vrpn::ServerOptions{}.most_of_host,
        vrpn::ServerOptions{}.most_waiting >> 10,
        std::chrono::duration_cast<std::chrono::seconds>(vrpn::ServerOptions{}.stalled_after).count(),
        vrpn::most_planes, vrpn::most_objects, vrpn::most_vertices, vrpn::most_triangles));
    app.action([&] { return serve(said); });
    return commandline::run(app, argc, argv);
}
