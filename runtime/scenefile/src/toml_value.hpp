#pragma once
// Values of a TOML file with their places, and the errors that name these. Private to this module.

#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include <knurl/scenefile/scene_file.hpp>

namespace knurl::scenefile {

/// Throws SceneError "path:line:column: text".
[[noreturn]] void fail(const std::string& path, const toml::source_position& where, const std::string& text);

/// One key of a table; keys of inner tables are joined by dots.
struct Value {
    std::string key;
    const toml::node* node;
    toml::source_position key_at;
    toml::source_position at;
};

/// "an array", "a number": the type in the file.
std::string_view type_name(const toml::node& node);

/// The keys of a [[table]], in the order of the file.
std::vector<Value> values_of(const toml::table& table);

// Each throws if the value has another type. `what` is its name in errors: "stiffness of plane 'floor'".
double real(const std::string& path, const Value& value, const std::string& what, std::string_view unit);
Vec3 vector(const std::string& path, const Value& value, const std::string& what, std::string_view unit);
/// `count` numbers.
std::vector<double> numbers(const std::string& path, const Value& value, const std::string& what,
                            std::string_view unit, std::size_t count);
/// A matrix of n x n, row by row: n arrays of n numbers, or one array of all.
std::vector<double> square(const std::string& path, const Value& value, const std::string& what,
                           std::string_view unit, std::size_t n);
/// `least` to `most` arrays of three numbers.
std::vector<double> points(const std::string& path, const Value& value, const std::string& what,
                           std::string_view unit, std::size_t least, std::size_t most);
std::string word(const std::string& path, const Value& value, const std::string& what);
bool boolean(const std::string& path, const Value& value, const std::string& what);
std::int64_t integer(const std::string& path, const Value& value, const std::string& what,
                     std::int64_t minimum, std::int64_t maximum);

}  // namespace knurl::scenefile
