#include "toml_value.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace knurl::scenefile {

namespace {

std::string_view type_name(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::string:
            return "a string";
        case toml::node_type::integer:
            return "an integer";
        case toml::node_type::floating_point:
            return "a number";
        case toml::node_type::boolean:
            return "a boolean";
        case toml::node_type::array:
            return "an array";
        case toml::node_type::table:
            return "a table";
        default:
            return "a date or time";
    }
}

std::string in_unit(std::string_view unit) {
    return unit.empty() || unit == "1" ? "" : fmt::format(" in {}", unit);
}

void flatten(const toml::table& table, const std::string& prefix, std::vector<Value>& out) {
    for (const auto& [key, node] : table) {
        const std::string name = prefix + std::string(key.str());
        if (const auto* inner = node.as_table()) {
            flatten(*inner, name + ".", out);
        } else {
            out.push_back({name, &node, key.source().begin, node.source().begin});
        }
    }
}

bool number_of(const toml::node& node, double& out) {
    if (const auto* i = node.as_integer()) {
        out = static_cast<double>(i->get());
    } else if (const auto* f = node.as_floating_point()) {
        out = f->get();
    } else {
        return false;
    }
    return true;
}

}  // namespace

void fail(const std::string& path, const toml::source_position& where, const std::string& text) {
    throw SceneError(fmt::format("{}:{}:{}: {}", path, where.line, where.column, text));
}

std::vector<Value> values_of(const toml::table& table) {
    std::vector<Value> values;
    flatten(table, "", values);
    std::sort(values.begin(), values.end(), [](const Value& a, const Value& b) {
        return std::tie(a.key_at.line, a.key_at.column) < std::tie(b.key_at.line, b.key_at.column);
    });
    return values;
}

double real(const std::string& path, const Value& value, const std::string& what, std::string_view unit) {
    double number = 0;
    if (!number_of(*value.node, number)) {
        fail(path, value.at,
             fmt::format("{} must be a number{}, not {}; write {} = 1.0", what, in_unit(unit),
                         type_name(*value.node), value.key));
    }
    return number;
}

Vec3 vector(const std::string& path, const Value& value, const std::string& what, std::string_view unit) {
    const auto* array = value.node->as_array();
    std::string found =
        array == nullptr ? std::string(type_name(*value.node)) : fmt::format("an array of {}", array->size());
    if (array != nullptr && array->size() == 3) {
        double parts[3] = {};
        bool whole = true;
        for (std::size_t i = 0; i < 3; ++i) {
            if (whole && !number_of((*array)[i], parts[i])) {
                whole = false;
                found = fmt::format("an array with {}", type_name((*array)[i]));
            }
        }
        if (whole) return {parts[0], parts[1], parts[2]};
    }
    fail(path, value.at,
         fmt::format("{} must be three numbers{}, not {}; write {} = [0, 0, 1]", what, in_unit(unit), found,
                     value.key));
}

std::string word(const std::string& path, const Value& value, const std::string& what) {
    const auto* text = value.node->as_string();
    if (text == nullptr)
        fail(path, value.at, fmt::format("{} must be a string, not {}", what, type_name(*value.node)));
    return text->get();
}

bool boolean(const std::string& path, const Value& value, const std::string& what) {
    const auto* flag = value.node->as_boolean();
    if (flag == nullptr) {
        fail(path, value.at, fmt::format("{} must be true or false, not {}", what, type_name(*value.node)));
    }
    return flag->get();
}

std::int64_t integer(const std::string& path, const Value& value, const std::string& what,
                     std::int64_t minimum, std::int64_t maximum) {
    const auto* number = value.node->as_integer();
    if (number == nullptr) {
        fail(path, value.at, fmt::format("{} must be an integer, not {}", what, type_name(*value.node)));
    }
    if (number->get() < minimum || number->get() > maximum) {
        fail(path, value.at,
             fmt::format("{} is {}; it must be {} to {}", what, number->get(), minimum, maximum));
    }
    return number->get();
}

}  // namespace knurl::scenefile
