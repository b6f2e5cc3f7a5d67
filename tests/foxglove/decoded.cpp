#include "decoded.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <sys/wait.h>

#include "../temp_folder.hpp"

namespace knurl::test {

namespace {

/// Exit code and output of `program FILE`, which gets the messages.
int read_by(const std::string& program, const std::vector<Encoded>& messages, std::string& out) {
    Json cases = Json::array();
    for (const Encoded& one : messages) {
        std::string hex;
        constexpr std::string_view digits = "0123456789abcdef";
        for (const std::byte byte : one.bytes) {
            hex += digits[std::to_integer<std::size_t>(byte) >> 4];
            hex += digits[std::to_integer<std::size_t>(byte) & 15];
        }
        Json item = Json::object();
        item["name"] = one.schema.name;
        item["schema"] = one.schema.text;
        item["hex"] = hex;
        cases.push_back(std::move(item));
    }
    const TempFolder folder;
    const std::string path = folder.file("cases.json", cases.dump());
    std::FILE* pipe = ::popen((program + " " + path + " 2>&1").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot run " + program);
    std::array<char, 4096> some{};
    while (const std::size_t n = std::fread(some.data(), 1, some.size(), pipe)) out.append(some.data(), n);
    const int status = ::pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

Json decoded(const std::vector<Encoded>& messages) {
    std::string out;
    if (read_by("/usr/bin/env python3 " KNURL_ROS2MSG ".py", messages, out) != 0)
        throw std::runtime_error(out);
    return Json::parse(out);
}

std::optional<Json> decoded_by_foxglove(const std::vector<Encoded>& messages, std::string& why) {
    const char* modules = std::getenv("KNURL_MCAP_MODULES");
    if (modules == nullptr) {
        why = "Foxglove's readers are not there (KNURL_MCAP_MODULES; scripts/test installs them)";
        return std::nullopt;
    }
    ::setenv("NODE_PATH", modules, 1);
    std::string out;
    const int code = read_by("/usr/bin/env node " KNURL_ROS2MSG ".js", messages, out);
    if (code == 77 || code == 127) {
        why = out;
        return std::nullopt;
    }
    if (code != 0) throw std::runtime_error(out);
    return Json::parse(out);
}

}  // namespace knurl::test
