#include "toml_value.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <knurl/words/printable.hpp>

namespace knurl::scenefile {

namespace {

constexpr std::size_t longest_message = 700;  // bytes

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

/// As a word, so that the sentence reads well.
std::string in_words(std::size_t count) {
    constexpr std::string_view words[] = {"no", "one", "two", "three", "four", "five", "six"};
    return count < std::size(words) ? std::string(words[count]) : std::to_string(count);
}

/// Appends the numbers of an array with `count` elements; else returns what it found instead.
std::string append_numbers(const toml::node& node, std::size_t count, std::vector<double>& out) {
    const auto* array = node.as_array();
    if (array == nullptr) return std::string(type_name(node));
    if (array->size() != count) return fmt::format("an array of {}", array->size());
    for (const toml::node& each : *array) {
        double number = 0;
        if (!number_of(each, number)) return fmt::format("an array with {}", type_name(each));
        out.push_back(number);
    }
    return {};
}

bool has_arrays(const toml::node& node) {
    const auto* array = node.as_array();
    return array != nullptr && !array->empty() && (*array)[0].is_array();
}

}  // namespace

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

void fail(const std::string& path, const toml::source_position& where, const std::string& text) {
    // It quotes keys and values of the file, in which escapes may stand for any character.
    throw SceneError(
        fmt::format("{}:{}:{}: {}", path, where.line, where.column, words::printable(text, longest_message)));
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

std::vector<double> numbers(const std::string& path, const Value& value, const std::string& what,
                            std::string_view unit, std::size_t count) {
    std::vector<double> out;
    const std::string found = append_numbers(*value.node, count, out);
    if (found.empty()) return out;
    const std::string_view example = count == 4 ? "[1, 0, 0, 0]" : "[0, 0, 1]";
    fail(path, value.at,
         fmt::format("{} must be {} numbers{}, not {}; write {} = {}", what, in_words(count), in_unit(unit),
                     found, value.key, example));
}

Vec3 vector(const std::string& path, const Value& value, const std::string& what, std::string_view unit) {
    const auto parts = numbers(path, value, what, unit, 3);
    return {parts[0], parts[1], parts[2]};
}

std::vector<double> square(const std::string& path, const Value& value, const std::string& what,
                           std::string_view unit, std::size_t n) {
    std::vector<double> out;
    const auto* array = value.node->as_array();
    if (!has_arrays(*value.node)) {
        const std::string found = append_numbers(*value.node, n * n, out);
        if (found.empty()) return out;
        fail(path, value.at,
             fmt::format("{} must be {} rows of {} numbers{}, not {}; write {} = [[...], ...]", what,
                         in_words(n), in_words(n), in_unit(unit), found, value.key));
    }
    if (array->size() != n)
        fail(path, value.at, fmt::format("{} has {} rows; it must have {}", what, array->size(), n));
    for (std::size_t row = 0; row < n; ++row) {
        const std::string found = append_numbers((*array)[row], n, out);
        if (found.empty()) continue;
        fail(path, (*array)[row].source().begin,
             fmt::format("row {} of {} must be {} numbers{}, not {}", row + 1, what, in_words(n),
                         in_unit(unit), found));
    }
    return out;
}

std::vector<double> points(const std::string& path, const Value& value, const std::string& what,
                           std::string_view unit, std::size_t least, std::size_t most) {
    const auto* array = value.node->as_array();
    if (array == nullptr) {
        fail(path, value.at,
             fmt::format("{} must be a list of points{}, not {}; write {} = [[0, 0, 0], [1, 0, 0], ...]",
                         what, in_unit(unit), type_name(*value.node), value.key));
    }
    std::vector<double> out;
    for (std::size_t i = 0; i < array->size(); ++i) {
        const std::string found = append_numbers((*array)[i], 3, out);
        if (found.empty()) continue;
        fail(path, (*array)[i].source().begin,
             fmt::format("point {} of {} must be three numbers{}, not {}; write [0, 0, 1]", i + 1, what,
                         in_unit(unit), found));
    }
    if (array->size() < least || array->size() > most) {
        fail(path, value.at,
             fmt::format("{} has {} points; give from {} to {}", what, array->size(), least, most));
    }
    return out;
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
