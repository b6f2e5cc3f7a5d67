#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/shm/socket.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::protocol {

namespace {

constexpr std::string_view local_prefix = "knurl:", remote_prefix = "knurl://", suffix = ".sock";

}  // namespace

ServoAddress servo_address(const std::string& said) {
    if (said.starts_with(remote_prefix))
        throw std::runtime_error(
            said +
            " is a servo of another host; here one of this host is needed, as `knurl ls` "
            "shows it");
    const bool is_path = said.find('/') != std::string::npos;
    std::string name = said;
    if (is_path) {
        name = std::filesystem::path(said).filename().string();
        name = name.ends_with(suffix) ? name.substr(0, name.size() - suffix.size()) : std::string();
    } else if (said.starts_with(local_prefix)) {
        name = said.substr(local_prefix.size());
    }
    if (!is_name(name)) {
        throw std::runtime_error(
            "'" + words::printable(said) +
            "': no servo has such a name; give NAME, knurl:NAME or the path of its socket, as `knurl ls` "
            "shows it: NAME is 1 to " +
            std::to_string(name_bytes - 1) + " of the characters a-z A-Z 0-9 _ . - without a dot in front");
    }
    return {.name = name, .socket = is_path ? said : servo_socket(name)};
}

std::vector<std::string> running_servos() {
    std::vector<std::string> names;
    for (const std::string& directory : servo_directories()) {
        std::error_code ignored;
        for (const auto& file : std::filesystem::directory_iterator(directory, ignored)) {
            if (file.path().extension() != suffix) continue;
            try {
                shm::connect_to(file.path().string());
                names.push_back(file.path().stem().string());
            } catch (const std::exception&) {  // a dead servo's, or another program's
            }
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string instead_of_servo(const std::string& name) {
    const std::vector<std::string> running = running_servos();
    if (const std::string_view meant = words::nearest(name, running); !meant.empty())
        return "did you mean knurl:" + std::string(meant) + ", which runs?";
    if (running.empty()) return "start one with `knurld --name " + name + " --device sim:premium15`";
    std::string all;
    for (const std::string& each : running) all += (all.empty() ? "knurl:" : ", knurl:") + each;
    return (running.size() == 1 ? "there is only " : "there are ") + all;
}

std::string instead_of_device(const std::string& wanted, const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "it has: " : ", ") + name;
    return words::did_you_mean(wanted, names, all);
}

}  // namespace knurl::protocol
