#include "params_text.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/scenefile/scene_file.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::gateway {

namespace {

bool is_key(std::string_view key) {
    return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '.';
    });
}

/// Numbers and arrays of numbers are the same in both; "inf" is a word there.
std::string toml_of(const std::string& key, const Json& value) {
    if (value.is_string()) {
        const auto text = value.get<std::string>();
        if (text == "inf" || text == "-inf") return text;
        return value.dump();
    }
    if (value.is_array()) {
        std::string parts;
        for (const Json& part : value) parts += (parts.empty() ? "" : ", ") + toml_of(key, part);
        return "[" + parts + "]";
    }
    if (value.is_number() || value.is_boolean()) return value.dump();
    throw std::runtime_error(fmt::format("{} = {}: give a number, a list of numbers or a name", key,
                                         value.is_null() ? "null" : "{...}"));
}

}  // namespace

Kind kind_of_name(const std::string& name) {
    const auto all = kinds();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const KindInfo& info) { return info.name == name; });
    if (found != all.end()) return static_cast<Kind>(found - all.begin());
    std::string names;
    for (const KindInfo& info : all) names += (names.empty() ? "" : ", ") + std::string(info.name);
    throw std::runtime_error(
        fmt::format("there is no representation '{}'; there are {}", words::printable(name), names));
}

std::vector<std::byte> params_of(Kind kind, const Json& params, std::span<const std::byte> before) {
    std::string text;
    if (!params.is_null() && !params.is_object())
        throw std::runtime_error("params: give an object of fields, {\"stiffness\": 800}");
    if (params.is_object()) {
        for (const auto& [key, value] : params.items()) {
            if (!is_key(key))
                throw std::runtime_error(
                    fmt::format("'{}' is no field of a {}", words::printable(key), kinds()[kind].name));
            text += key + " = " + toml_of(key, value) + "\n";
        }
    }
    return scenefile::read_stated(kind, text, before).params;
}

}  // namespace knurl::gateway
