#include "params_text.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <knurl/scenefile/scene_file.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::gateway {

namespace {

constexpr std::size_t longest_quote = 60;  // bytes of a client's text in our messages

void write_text(std::string& out, std::string_view text) {
    out += '"';
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) {
            out += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
        } else {
            out += c;
        }
    }
    out += '"';
}

/// JSON has no infinity.
bool is_infinity(const Json& value) {
    return value.is_string() && (value == "inf" || value == "-inf");
}

void write_value(std::string& out, const std::string& key, const Json& value) {
    if (value.is_boolean()) {
        out += value.get<bool>() ? "true" : "false";
    } else if (value.is_number_float()) {
        const std::string number = fmt::format("{}", value.get<double>());
        out += number;
        if (number.find_first_of(".einf") == std::string::npos) out += ".0";
    } else if (value.is_number()) {
        if (value > Json(std::numeric_limits<std::int64_t>::max()))
            throw std::runtime_error(
                fmt::format("{} is larger than any integer may be", words::printable(key, longest_quote)));
        out += std::to_string(value.get<std::int64_t>());
    } else if (is_infinity(value) && key != "id") {
        out += value.get<std::string>();
    } else if (value.is_string()) {
        write_text(out, value.get<std::string>());
    } else if (value.is_array()) {
        out += '[';
        for (const Json& element : value) {
            write_value(out, key, element);
            out += ',';
        }
        out += ']';
    } else if (value.is_object()) {
        out += '{';
        bool first = true;
        for (const auto& [inner, member] : value.items()) {
            if (!std::exchange(first, false)) out += ',';
            write_text(out, inner);
            out += '=';
            write_value(out, inner, member);
        }
        out += '}';
    } else {
        throw std::runtime_error(
            fmt::format("{} is null; leave it out", words::printable(key, longest_quote)));
    }
}

}  // namespace

Kind kind_of_name(const std::string& name) {
    std::vector<std::string_view> names;
    for (const KindInfo& info : kinds()) names.push_back(info.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<Kind>(found - names.begin());
    std::string all;
    for (const auto each : names) all += (all.empty() ? "there are " : ", ") + std::string(each);
    throw std::runtime_error(fmt::format("there is no representation '{}'; {}",
                                         words::printable(name, longest_quote),
                                         words::did_you_mean(name, names, all)));
}

std::string toml_of(const Json& table) {
    std::string out;
    for (const auto& [key, value] : table.items()) {
        write_text(out, key);
        out += '=';
        write_value(out, key, value);
        out += '\n';
    }
    return out;
}

std::vector<std::byte> params_of(Kind kind, const Json& params, std::span<const std::byte> before) {
    if (!params.is_null() && !params.is_object())
        throw std::runtime_error("params: give an object of fields, {\"stiffness\": 800}");
    return scenefile::read_stated(kind, params.is_object() ? toml_of(params) : std::string(), before).params;
}

}  // namespace knurl::gateway
