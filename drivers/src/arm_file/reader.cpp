#include "arm_file/reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::drivers {

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double longest_haptic_link = 3;  // m: haptic arms are shorter
constexpr std::string_view degrees_suffix = "_deg";
constexpr std::string_view source_suffix = "_source";
constexpr std::size_t longest_message =
    700;  // bytes; it quotes keys and values, in which any character may stand

std::string kind_of(const toml::node& node) {
    if (node.is_string()) return "a string";
    if (node.is_boolean()) return "true or false";
    if (node.is_array()) return "a list of " + std::to_string(node.as_array()->size());
    if (node.is_table()) return "a table";
    if (node.is_number()) return "a number";
    return "a date or time";
}

std::string listed(const std::vector<std::string_view>& words) {
    std::string text;
    for (const std::string_view word : words) text += (text.empty() ? "" : ", ") + std::string(word);
    return text;
}

}  // namespace

std::string in_text(double number) {
    std::ostringstream text;
    text << number;
    return text.str();
}

ArmTable::ArmTable(ArmFile& arm, const toml::table& table, std::string called,
                   std::initializer_list<std::string_view> known)
    : arm_(arm), table_(table), called_(std::move(called)) {
    const std::vector<std::string_view> keys(known);
    const auto is_known = [&](std::string_view key) {
        return std::find(keys.begin(), keys.end(), key) != keys.end();
    };
    for (const auto& [key, node] : table_) {
        const std::string_view name = key.str();
        if (is_known(name)) continue;
        if (name == "source" || name.ends_with(source_suffix)) {
            if (name != "source" && !is_known(name.substr(0, name.size() - source_suffix.size())) &&
                !is_known(std::string(name.substr(0, name.size() - source_suffix.size())) + "_deg")) {
                fail(name, std::string(name) + " in " + called_ +
                               " is the source of a figure that is not known there");
            }
            if (!node.is_string()) fail(name, name_of(name) + " must be a string, not " + kind_of(node));
            continue;
        }
        fail(name, "unknown key '" + std::string(name) + "' in " + called_ + "; it takes " + listed(keys) +
                       words::meant(name, keys));
    }
}

void ArmTable::fail_at(const toml::node& node, const std::string& what) const {
    const toml::source_position at = node.source().begin;
    throw std::runtime_error(arm_.path + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) +
                             ": " + words::printable(what, longest_message));
}

void ArmTable::fail(std::string_view key, const std::string& what) const {
    for (const auto& [name, node] : table_) {
        if (name.str() == key) fail_at(node, what);
    }
    fail_at(table_, what);
}

std::optional<std::string> ArmTable::text(std::string_view key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return {};
    const auto* found = node->as_string();
    if (found == nullptr || found->get().empty()) {
        fail(key, name_of(key) + " must be a string that is not empty, not " + kind_of(*node));
    }
    return found->get();
}

bool ArmTable::flag(std::string_view key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return false;
    const auto* found = node->as_boolean();
    if (found == nullptr) fail(key, name_of(key) + " must be true or false, not " + kind_of(*node));
    return found->get();
}

void ArmTable::note(std::string_view key, std::string value) {
    std::string_view base = key;
    if (base.ends_with(degrees_suffix)) base.remove_suffix(degrees_suffix.size());
    std::string source;
    for (const std::string& stated :
         {std::string(key) + "_source", std::string(base) + "_source", std::string("source")}) {
        if (source.empty()) source = text(stated).value_or("");
    }
    if (source.empty()) source = arm_.source;
    if (source.empty()) {
        fail(key, name_of(key) +
                      " has no source; write source = \"...\" at the top of the file, in the table, or " +
                      std::string(base) + "_source (a paper, a data sheet, \"measured\", \"invented\")");
    }
    arm_.figures.push_back({.name = name_of(key), .value = std::move(value), .source = std::move(source)});
}

double ArmTable::value(const toml::node& node, const std::string& what) const {
    double number = 0;
    if (const auto* whole = node.as_integer()) {
        number = static_cast<double>(whole->get());
    } else if (const auto* real = node.as_floating_point()) {
        number = real->get();
    } else {
        fail_at(node, what + " must be a number, not " + kind_of(node));
    }
    if (!std::isfinite(number)) fail_at(node, what + " is " + in_text(number) + "; it must be finite");
    return number;
}

double ArmTable::length_of(const toml::node& node, const std::string& what) const {
    const double metres = value(node, what);
    if (std::abs(metres) > longest_haptic_link) {
        fail_at(node, what + " is " + in_text(metres) + " m: links are in metres, at most " +
                          in_text(longest_haptic_link) + " m; did you mean " + in_text(metres / 1000) + "?");
    }
    return metres;
}

double ArmTable::angle_of(const toml::node& node, const std::string& what, std::string_view key,
                          bool degrees) const {
    const double number = value(node, what);
    const double quarters = number / (std::numbers::pi / 2);
    if (degrees) {
        // A value like 1.5708 in degrees: it was surely meant in radians.
        if (number != 0 && std::abs(quarters) < 4.5 && std::abs(quarters - std::round(quarters)) < 1e-4) {
            fail_at(node, what + " is " + in_text(number) + " degrees: that is " +
                              in_text(90 * std::round(quarters)) + " degrees in radians; did you mean " +
                              in_text(90 * std::round(quarters)) + "?");
        }
        if (std::abs(number) > 720) {
            fail_at(node, what + " is " + in_text(number) + " degrees; give -720 to 720");
        }
        return number * degree;
    }
    if (std::abs(number) > 4 * std::numbers::pi) {
        fail_at(node, what + " is " + in_text(number) + " rad: angles are in radians; did you mean " +
                          std::string(key) + "_deg, in degrees?");
    }
    return number;
}

std::optional<double> ArmTable::number(std::string_view key, const Range& range) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return {};
    const double number = value(*node, name_of(key));
    if (number < range.least || number > range.greatest || (number == range.least && !range.zero_too)) {
        fail(key, name_of(key) + " is " + in_text(number) + " " + std::string(range.unit) + "; give " +
                      (range.zero_too ? "" : "more than ") + in_text(range.least) +
                      (range.zero_too ? " to " : ", at most ") + in_text(range.greatest) + " " +
                      std::string(range.unit));
    }
    note(key, in_text(number) + " " + std::string(range.unit));
    return number;
}

std::optional<double> ArmTable::length(std::string_view key) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return {};
    const double metres = length_of(*node, name_of(key));
    note(key, in_text(metres) + " m");
    return metres;
}

const toml::node* ArmTable::angle_node(std::string_view key, bool& degrees) const {
    const std::string in_degrees = std::string(key) + std::string(degrees_suffix);
    const toml::node* plain = table_.get(key);
    const toml::node* turned = table_.get(in_degrees);
    if (plain != nullptr && turned != nullptr) {
        fail(in_degrees, called_ + " has both " + std::string(key) + " and " + in_degrees + "; keep one");
    }
    degrees = turned != nullptr;
    return degrees ? turned : plain;
}

std::optional<double> ArmTable::angle(std::string_view key) {
    bool degrees = false;
    const toml::node* node = angle_node(key, degrees);
    if (node == nullptr) return {};
    const std::string full = std::string(key) + (degrees ? "_deg" : "");
    const double radians = angle_of(*node, name_of(full), key, degrees);
    note(full, in_text(degrees ? radians / degree : radians) + (degrees ? " degrees" : " rad"));
    return radians;
}

const toml::array& ArmTable::list(const toml::node& node, const std::string& what, std::size_t count,
                                  std::string_view unit) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != count) {
        fail_at(node, what + " must be a list of " + std::to_string(count) + " numbers" +
                          (unit.empty() ? "" : " in " + std::string(unit)) + ", not " + kind_of(node));
    }
    return *array;
}

std::optional<std::vector<double>> ArmTable::angles(std::string_view key, std::size_t count,
                                                    const std::vector<bool>& sliding) {
    bool degrees = false;
    const toml::node* node = angle_node(key, degrees);
    if (node == nullptr) return {};
    const std::string full = std::string(key) + (degrees ? "_deg" : "");
    const toml::array& array = list(*node, name_of(full), count, degrees ? "degrees" : "rad");
    std::vector<double> all;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string what = "number " + std::to_string(i + 1) + " of " + name_of(full);
        const bool slides = i < sliding.size() && sliding[i];
        if (slides && degrees) {
            fail_at(array[i],
                    what + " is of an axis that slides: write " + std::string(key) + ", in rad and m");
        }
        all.push_back(slides ? length_of(array[i], what) : angle_of(array[i], what, key, degrees));
    }
    note(full, std::to_string(count) + (degrees ? " in degrees" : " in rad (m)"));
    return all;
}

std::optional<Between> ArmTable::between(std::string_view key, bool sliding) {
    if (const toml::node* node = table_.get(key); node != nullptr && node->is_string()) {
        if (text(key) != "unknown") {
            fail(key, name_of(key) + " is a string; write two numbers, or \"unknown\" if nobody knows them");
        }
        return Between{};
    }
    const auto both = angles(key, 2, {sliding, sliding});
    if (!both) return {};
    const Between found{.least = (*both)[0], .greatest = (*both)[1]};
    if (!(found.least < found.greatest)) {
        bool degrees = false;
        const toml::node* node = angle_node(key, degrees);
        const double unit = degrees ? degree : 1;
        fail_at(*node, name_of(std::string(key) + (degrees ? "_deg" : "")) +
                           " are the wrong way round: " + in_text(found.least / unit) + " is not less than " +
                           in_text(found.greatest / unit));
    }
    return found;
}

std::optional<std::vector<double>> ArmTable::numbers(std::string_view key, std::size_t count,
                                                     const Range& range) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return {};
    std::vector<double> all;
    for (const toml::node& each : list(*node, name_of(key), count, range.unit)) {
        const bool metres = range.unit == "m";
        const std::string what = "number " + std::to_string(all.size() + 1) + " of " + name_of(key);
        all.push_back(metres ? length_of(each, what) : value(each, what));
        if (all.back() < range.least || all.back() > range.greatest) {
            fail_at(each, what + " is " + in_text(all.back()) + "; give " + in_text(range.least) + " to " +
                              in_text(range.greatest) + " " + std::string(range.unit));
        }
    }
    note(key,
         std::to_string(count) + " numbers" + (range.unit.empty() ? "" : " in " + std::string(range.unit)));
    return all;
}

}  // namespace knurl::drivers
