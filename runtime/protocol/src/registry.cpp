#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <poll.h>
#include <sys/socket.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/protocol/registry.hpp>
#include <knurl/shm/socket.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::protocol {

namespace {

constexpr std::string_view registry_prefix = "knurl://", greeting = "knurl-registry 1 ";
constexpr std::chrono::milliseconds patience{2000};

/// The next message, within the patience. Throws: there is none.
std::string next_message(const shm::UniqueFd& connection) {
    pollfd event{.fd = connection.get(), .events = POLLIN, .revents = 0};
    if (::poll(&event, 1, static_cast<int>(patience.count())) <= 0)
        throw std::runtime_error("it does not answer");
    std::vector<std::byte> bytes(registry_message);
    const shm::Received got = shm::receive_plain_message(connection, bytes);
    if (got.closed || got.nothing || got.truncated || got.carries_descriptors)
        throw std::runtime_error("it has hung up");
    return {reinterpret_cast<const char*>(bytes.data()), got.bytes};
}

/// A registry that has been asked for its domain.
struct Registry {
    shm::UniqueFd connection;
    std::uint32_t domain = 0;
};

/// None: nobody listens there, or nobody who knows this protocol.
std::optional<Registry> open_registry(const std::string& path) try {
    Registry made{.connection = shm::connect_to(path, patience)};
    const std::string hello = next_message(made.connection);
    if (!hello.starts_with(greeting)) return std::nullopt;
    const char* first = hello.data() + greeting.size();
    const auto [end, error] = std::from_chars(first, hello.data() + hello.size(), made.domain);
    if (error != std::errc()) return std::nullopt;
    return made;
} catch (const std::exception&) {
    return std::nullopt;
}

std::vector<Registry> registries(std::optional<std::uint32_t> domain) {
    std::vector<Registry> found;
    for (const std::string& directory : servo_directories()) {
        std::error_code ignored;
        for (const auto& file : std::filesystem::directory_iterator(directory, ignored)) {
            if (!file.path().filename().string().ends_with(registry_suffix)) continue;
            std::optional<Registry> registry = open_registry(file.path().string());
            if (registry && (!domain || registry->domain == *domain)) found.push_back(std::move(*registry));
        }
    }
    return found;
}

bool ask(const Registry& registry, const std::string& request) {
    return shm::send_message(registry.connection, std::as_bytes(std::span(request)));
}

std::string of_domain(std::optional<std::uint32_t> domain) {
    return domain ? " of domain " + std::to_string(*domain) : std::string();
}

}  // namespace

std::optional<RegistryAddress> registry_address(const std::string& said) {
    if (!said.starts_with(registry_prefix)) return std::nullopt;
    const std::string rest = said.substr(registry_prefix.size());
    const std::size_t slash = rest.find('/');
    if (slash == std::string::npos) return std::nullopt;
    RegistryAddress address{.servo = rest.substr(0, slash), .device = rest.substr(slash + 1)};
    if (!is_name(address.servo) || (!address.device.empty() && !is_name(address.device)))
        throw std::runtime_error(
            "'" + words::printable(said) +
            "': no servo of a registry is called so; write knurl://SERVO/DEVICE as `knurl ls --domain` "
            "shows it, or knurl://HOST:PORT of a bridge");
    return address;
}

std::string registry_socket(const std::string& name) {
    return runtime_directory() + "/" + name + std::string(registry_suffix);
}

std::optional<std::uint32_t> domain_said() {
    const char* said = std::getenv("ROS_DOMAIN_ID");
    if (said == nullptr || *said == '\0') return std::nullopt;
    const std::string_view text(said);
    std::uint32_t domain = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
    if (error != std::errc() || end != text.data() + text.size())
        throw std::runtime_error("ROS_DOMAIN_ID is '" + words::printable(text, 60) +
                                 "'; set it to the number of a domain");
    return domain;
}

std::string resolve_servo(const std::string& name, std::optional<std::uint32_t> domain) {
    std::string why;
    for (const Registry& registry : registries(domain)) {
        try {
            if (!ask(registry, "resolve " + name)) continue;
            const std::string answer = next_message(registry.connection);
            if (!answer.starts_with("? ")) return answer;
            why = answer.substr(2);
        } catch (const std::runtime_error& error) {
            why = std::string("the registry cannot be asked: ") + error.what();
        }
    }
    if (!why.empty()) throw std::runtime_error(why);
    throw std::runtime_error("servo '" + name + "' is looked up in a registry, and none" + of_domain(domain) +
                             " runs on this host; start one with `knurl-dds`" +
                             (domain ? " --domain " + std::to_string(*domain) : std::string()) +
                             ", or give knurl://HOST:PORT of a bridge");
}

std::optional<std::vector<std::string>> list_servos(std::uint32_t domain) {
    for (const Registry& registry : registries(domain)) {
        try {
            if (!ask(registry, "list")) continue;
            std::vector<std::string> all;
            for (std::string each = next_message(registry.connection); each != ".";
                 each = next_message(registry.connection))
                all.push_back(std::move(each));
            return all;
        } catch (const std::runtime_error&) {  // it is ending: another may answer
        }
    }
    return std::nullopt;
}

}  // namespace knurl::protocol
