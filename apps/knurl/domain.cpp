#include "domain.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/protocol/registry.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/words/printable.hpp>

#include "top_terminal.hpp"

extern char** environ;

namespace knurl::cli {

namespace {

/// Beside this program, as installed or in a build tree; else the PATH's.
std::string dds_program() {
    std::error_code none;
    const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
    for (const std::filesystem::path& candidate :
         {here / "knurl-dds", here.parent_path() / "knurl-dds" / "knurl-dds"})
        if (std::filesystem::is_regular_file(candidate, none)) return candidate.string();
    return "knurl-dds";
}

/// Its lines. Its standard error is ours.
std::vector<std::string> output_of(std::vector<std::string> words) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no descriptor is left");
    const shm::UniqueFd out(ends[0]);
    shm::UniqueFd in(ends[1]);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, in.get(), STDOUT_FILENO);
    pid_t child = -1;
    const int error = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    in.reset();
    if (error != 0)
        throw std::runtime_error(fmt::format("{} cannot be started ({}); is the package knurl-dds installed?",
                                             words[0], std::strerror(error)));
    std::string text;
    std::array<char, 4096> bytes;
    for (ssize_t got = 0; (got = ::read(out.get(), bytes.data(), bytes.size())) > 0;)
        text.append(bytes.data(), static_cast<std::size_t>(got));
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw std::runtime_error("knurl-dds could not look at the domain");
    std::vector<std::string> lines;
    std::istringstream in_lines(text);
    for (std::string line; std::getline(in_lines, line);) lines.push_back(line);
    return lines;
}

/// Of a servo's object; what others have written is shown on one line.
std::string word(const Json& of, const std::string& key) {
    const Json& value = of.at(key);
    return value.is_string() ? words::printable(value.get<std::string>(), 200) : value.dump(-1);
}

std::string device_line(const Json& device) {
    std::string line = fmt::format("  {} ({}, {:g} Hz): {}", word(device, "name"), word(device, "profile"),
                                   device.at("rate").get<double>(), word(device, "state"));
    if (!device.at("fault_names").is_null()) line += " (" + wrong(word(device, "fault_names")) + ")";
    if (!device.at("measured_rate").is_null())
        line += fmt::format(", {:.0f} cycles/s", device.at("measured_rate").get<double>());
    line += fmt::format(", k_max {:.4g} N/m, force {:.2f} of {:.3g} N, {} of {} cycles late",
                        device.at("k_max").get<double>(), device.at("force").get<double>(),
                        device.at("peak_force").get<double>(), word(device, "late_cycles"),
                        word(device, "cycles"));
    const auto holders = device.at("holders").get<std::uint64_t>();
    line +=
        holders == 0 ? ", nobody holds it" : fmt::format(", {} hold{} it", holders, holders == 1 ? "s" : "");
    if (device.at("commanded_by_dds").get<bool>()) line += ", may be commanded by DDS";
    return line + "\n";
}

std::string servo_text(const Json& servo, bool doubled) {
    std::string text = fmt::format("{}: on {} (pid {}, Knurl {})", word(servo, "address"),
                                   word(servo, "host"), word(servo, "pid"), word(servo, "build"));
    if (word(servo, "state") != "running") text += ", " + wrong("its servo does not run");
    text += servo.at("bridge").is_null() ? ", no bridge" : ", bridge " + word(servo, "bridge");
    if (doubled) text += ", " + wrong("another one is called so too: give one another --name");
    text += "\n";
    for (const Json& device : servo.at("devices")) text += device_line(device);
    return text;
}

}  // namespace

std::vector<Json> servos_of_domain(std::uint64_t domain) {
    std::optional<std::vector<std::string>> texts = protocol::list_servos(static_cast<std::uint32_t>(domain));
    if (!texts) texts = output_of({dds_program(), "list", "--domain", std::to_string(domain)});
    std::vector<Json> servos;
    for (const std::string& text : *texts) servos.push_back(Json::parse(text));
    return servos;
}

std::string text_of_domain(std::uint64_t domain, const std::vector<Json>& servos) {
    if (servos.empty())
        return fmt::format(
            "no servo is announced in domain {}; announce one with: knurl-dds --domain {}, on its host, and "
            "--interface for a network\n",
            domain, domain);
    std::string text;
    for (const Json& servo : servos) {
        const auto same = std::count_if(servos.begin(), servos.end(), [&](const Json& each) {
            return word(each, "name") == word(servo, "name");
        });
        text += servo_text(servo, same > 1);
    }
    return text;
}

std::string json_of_domain(std::uint64_t domain, const std::vector<Json>& servos, int indent) {
    return Json{{"domain", domain}, {"servos", Json(servos)}}.dump(indent) + "\n";
}

}  // namespace knurl::cli
