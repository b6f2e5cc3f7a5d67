// knurl-dds: one servo in a DDS domain: topics of ROS 2, and the registry of servos.

#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include <knurl/bridge/host_and_port.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/dds/config.hpp>
#include <knurl/dds/registry.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/protocol/registry.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/words/printable.hpp>

namespace {

using namespace knurl;
using commandline::UsageError;

struct CommandLine {
    std::string config, servo, name, interface, bridge, name_space;
    std::vector<std::string> peers, commands;
    std::optional<std::uint64_t> domain;
    bool registry_only = false, json = false;
    double seconds = 2.5;
    unsigned lose = 0;
};

void log(const std::string& line) {
    fmt::print(stderr, "knurl-dds: {}\n", line);
}

std::string host_name() {
    std::array<char, 256> name{};
    ::gethostname(name.data(), name.size() - 1);
    return words::printable(name.data(), 60);
}

/// Of this run: a servo that comes back is another one for everybody else.
std::string new_id() {
    std::random_device random;
    std::string id;
    for (int i = 0; i < 4; ++i) id += fmt::format("{:08x}", random());
    return id;
}

/// The file, and then what the command line says.
dds::Config config_of(const CommandLine& said) {
    dds::Config config;
    config.domain.id = dds::domain_of_environment();
    try {
        if (!said.config.empty()) dds::read_config(said.config, config);
    } catch (const std::runtime_error& error) {
        throw UsageError(error.what());
    }
    if (said.domain) config.domain.id = static_cast<std::uint32_t>(*said.domain);
    if (!said.servo.empty()) config.robot.servo = said.servo;
    if (!said.name.empty()) config.name = said.name;
    if (!said.interface.empty()) config.domain.interface = said.interface;
    if (!said.bridge.empty()) config.bridge = said.bridge;
    if (!said.name_space.empty()) config.robot.name_space = said.name_space;
    for (const std::string& peer : said.peers) config.domain.peers.push_back(peer);
    for (const std::string& device : said.commands) {
        dds::CommandRule rule;
        rule.device = device;
        config.robot.commands.push_back(rule);
    }
    config.domain.lose = said.lose;
    config.domain.log = log;
    return config;
}

void require_sense(const dds::Config& config) {
    try {
        protocol::servo_address(config.robot.servo);
        if (!config.bridge.empty()) bridge::check_host_and_port(config.bridge);
    } catch (const std::runtime_error& error) {
        throw UsageError(error.what());
    }
    if (!config.name.empty() && !protocol::is_name(config.name))
        throw UsageError(
            fmt::format("--name {}: use letters, digits, _ . and -", words::printable(config.name, 60)));
}

/// Until the process is told to stop.
void pause(std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    while (!commandline::stop && std::chrono::steady_clock::now() < until)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

std::string where(const dds::Config& config) {
    return config.domain.interface.empty() ? std::string("this host alone") : config.domain.interface;
}

int serve(const CommandLine& said) {
    dds::Config config = config_of(said);
    require_sense(config);
    commandline::stop_on_signals();
    commandline::go_before_others();
    dds::Domain domain(config.domain);
    dds::Registry registry(domain);
    const std::string servo = protocol::servo_address(config.robot.servo).name;
    dds::ServoEntry entry{
        .id = new_id(),
        .name = config.name.empty() ? dds::default_name(servo, host_name()) : config.name,
        .servo = config.robot.servo.find('/') != std::string::npos ? config.robot.servo : servo,
        .host = host_name(),
        .pid = static_cast<std::uint32_t>(::getpid()),
        .build = KNURL_VERSION,
        .bridge = config.bridge};
    const std::string door_name =
        fmt::format("{}-{}", config.domain.id, said.registry_only ? "registry" : entry.name);
    std::filesystem::create_directories(protocol::runtime_directory());
    const dds::RegistryDoor door(registry, protocol::registry_socket(door_name), config.domain.id,
                                 entry.name);
    std::optional<dds::RobotSide> robot;
    if (!said.registry_only) robot.emplace(domain, config.robot);
    fmt::print("knurl-dds: {} in domain {}, {}\n",
               said.registry_only ? "a registry" : fmt::format("servo '{}' is '{}'", servo, entry.name),
               config.domain.id, where(config));
    for (const dds::CommandRule& rule : config.robot.commands)
        fmt::print("  '{}' may be commanded by {}\n", rule.device,
                   rule.from.empty()
                       ? std::string("all in the domain")
                       : fmt::format("processes that say they are on {}", fmt::join(rule.from, ", ")));
    std::fflush(stdout);
    while (!commandline::stop) {
        if (robot) {
            robot->describe(entry);
            registry.announce(entry);
        }
        for (const std::string& line : registry.name_clashes()) domain.say(line);
        pause(dds::Registry::period);
    }
    return 0;
}

int list(const CommandLine& said) {
    const dds::Config config = config_of(said);
    std::optional<std::vector<std::string>> servos = protocol::list_servos(config.domain.id);
    if (!servos) {
        // Nobody here knows the domain yet: joins it for as long as everybody needs to say that they are there.
        commandline::stop_on_signals();
        dds::Domain domain(config.domain);
        const dds::Registry registry(domain);
        pause(std::chrono::milliseconds(static_cast<long>(said.seconds * 1e3)));
        servos.emplace();
        for (const dds::ServoEntry& servo : registry.servos()) servos->push_back(dds::json_of(servo));
    }
    for (const std::string& servo : *servos) fmt::print("{}\n", servo);
    return 0;
}

void domain_options(commandline::Command& command, CommandLine& said) {
    command.option("--config", said.config, "TOML file; what stands here as well counts more")
        .type_name("FILE");
    command.option("--domain", said.domain, "Number of the DDS domain; without it ROS_DOMAIN_ID, or 0")
        .within(0, 232);
    command
        .option("--interface", said.interface,
                "Address or name of the network interface; without it this host alone is reached")
        .type_name("ADDRESS");
    command
        .option("--peer", said.peers,
                "A host that is asked directly, where multicast does not reach it; may be repeated")
        .type_name("ADDRESS");
}

}  // namespace

int main(int argc, char** argv) {
    CommandLine said, listed;
    commandline::Command app(
        "knurl-dds",
        "Shows a servo to robots (ROS 2, by CRTK's names) and announces it to other hosts, in a DDS domain.\n"
        "It is an ordinary client of the servo. It reaches this host only, unless --interface names a "
        "network.");
    domain_options(app, said);
    app.servo(said.servo, "The servo's name (default)");
    app.option("--name", said.name,
               "Its name in the domain; without it the servo's own, or of 'default' the host's");
    app.option("--bridge", said.bridge, "Where others reach its knurl-bridge").type_name("HOST:PORT");
    app.option("--namespace", said.name_space, "Before the names of all topics");
    app.option(
           "--command", said.commands,
           "A device that peers may command; may be repeated. Without it they only read. The file says more")
        .type_name("DEVICE");
    app.option("--lose", said.lose, "For tests: of a thousand packets, this many are not sent")
        .within(0, 900);
    app.flag("--registry", said.registry_only,
             "Without a servo: only looks servos up for the programs of this host");
    app.footer(
        fmt::format("DDS without DDS-Security asks nobody who he is: on an open network everybody who "
                    "reaches the domain reads all\n"
                    "topics, and can move a device that may be commanded. Bounds: {} servos, {} peers that "
                    "command a device.",
                    dds::Registry::most_servos, dds::CommandDesk::most_peers));
    app.action([&] { return serve(said); });
    auto& verb = app.verb("list", "The servos of a domain, a line of JSON each");
    domain_options(verb, listed);
    verb.flag("--json", listed.json, "It prints nothing else");
    verb.option("--seconds", listed.seconds, "How long to listen where no knurl-dds of that domain runs here")
        .within(0.1, 60)
        .shows_default();
    verb.action([&] { return list(listed); });
    return commandline::run(app, argc, argv);
}
